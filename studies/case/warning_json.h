#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "render/base/warning.h"

namespace gladstone::inline cases {

// JSON files and --json list warnings twice: as texts in `warnings`, and as objects in `warning_records`.

template <class Json>
void to_json(Json& json, Warning const& warning) {
  json = Json{{"code", warning_code_name(warning.code)}, {"place", warning.place}, {"text", warning.text}};
}

template <class Json>
void from_json(Json const& json, Warning& warning) {
  warning = {find_warning_code(json.at("code").template get<std::string>()),
             json.at("place").template get<std::string>(), json.at("text").template get<std::string>()};
}

/// Returns the warnings of a JSON object. Files of earlier versions contain texts only.
template <class Json>
Warnings read_warnings(Json const& json) {
  if (auto const records = json.find("warning_records"); records != json.end())
    return records->template get<Warnings>();
  Warnings warnings;
  if (auto const texts = json.find("warnings"); texts != json.end())
    for (Json const& text : *texts) warnings.push_back({WarningCode::other, "", text.template get<std::string>()});
  return warnings;
}

}  // namespace gladstone::inline cases
