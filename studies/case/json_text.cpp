#include "studies/case/json_text.h"

#include <cmath>
#include <nlohmann/json.hpp>

namespace gladstone::inline cases {

std::string json_text(nlohmann::json const& json) {
  return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string json_text(nlohmann::ordered_json const& json) {
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

nlohmann::json number_or_null(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr);
}

}  // namespace gladstone::inline cases
