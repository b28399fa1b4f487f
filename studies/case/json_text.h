#pragma once

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

namespace gladstone {

/// Formats a JSON value with indentation. Bytes that are not UTF-8, which file names may contain, become U+FFFD.
template <class Json>
std::string json_text(Json const& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace);
}

/// Returns the number, or null if it is NaN or infinite.
inline nlohmann::json number_or_null(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr);
}

}  // namespace gladstone
