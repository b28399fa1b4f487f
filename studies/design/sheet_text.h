#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "studies/design/sheet.h"

namespace gladstone {

/// The sheet as a table to read: number, quantity, value, margin, formula, source, note.
std::string sheet_text(DesignSheet const& sheet);

/// Every row's value by its key, fields of view as [width, height], and the whole rows in "rows"; null: not known.
nlohmann::ordered_json sheet_json(DesignSheet const& sheet);

}  // namespace gladstone
