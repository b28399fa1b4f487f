#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "studies/design/sheet.h"

namespace gladstone::inline design {

/// Formats the sheet as a table: number, quantity, value, margin, formula, source, note. Violated rows come first, then
/// marginal ones, then the others in the order of their numbers.
std::string sheet_text(DesignSheet const& sheet);

/// Formats the rows that miss the usual recommendation, in the form of sheet_text(); empty if every row meets it.
std::string missed_rows_text(DesignSheet const& sheet);

/// Returns the values of rows by their keys, fields of view as [width, height]; null: unknown.
nlohmann::ordered_json sheet_values(std::vector<ResultRow> const& rows);

/// Returns every value by its key, fields of view as [width, height], and all rows in "rows"; null: unknown.
nlohmann::ordered_json sheet_json(DesignSheet const& sheet);

}  // namespace gladstone::inline design
