#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace gladstone::inline cases {

/// Formats a JSON value with indentation. Bytes that are not UTF-8, which file names may contain, become U+FFFD.
std::string json_text(nlohmann::json const& json);
std::string json_text(nlohmann::ordered_json const& json);

/// Returns the number, or null if it is NaN or infinite.
nlohmann::json number_or_null(double value);

}  // namespace gladstone::inline cases
