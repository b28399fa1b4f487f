#pragma once

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

namespace gladstone {

/// A JSON value as text, indented to be read. Bytes that are no UTF-8, which names of files may have and JSON may not,
/// are shown as U+FFFD.
template <class Json>
std::string json_text(Json const& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace);
}

/// A number; null where it is not known or has no end.
inline nlohmann::json known_or_null(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr);
}

}  // namespace gladstone
