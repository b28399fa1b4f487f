#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace gladstone::inline cases {

/// Rating of a value against the usual recommendation.
enum class Margin {
  none,      ///< no recommendation
  green,     ///< met with a margin
  marginal,  ///< met or missed by little
  violated,
};

/// Returns the word of a rating in JSON: "green", "marginal", "violated" or an empty text.
char const* margin_word(Margin margin);

/// Returns the word of a rating in texts: "ok", "marginal", "violated" or an empty text.
char const* rating_text(Margin margin);

/// One quantity that a command prints, writes as JSON and as CSV.
struct ResultRow {
  std::string id = {};      ///< number of its formula in docs/design.md, F1 to F27; empty: none
  std::string key;          ///< name of the quantity for programs, with the unit as suffix; "a.b": member b of the
                            ///< object a, "a.0": its first element if a is an array
  std::string symbol = {};  ///< symbol of the quantity in formulas; empty: none
  std::string label;
  double value;           ///< in `unit`; NaN: unknown, or not applicable
  std::string unit = {};  ///< empty: a pure number
  std::string formula = {};
  std::string source = {};  ///< publication or file of the formula
  Margin margin = Margin::none;
  std::string note = {};  ///< criterion of the margin, or a remark
  bool whole = false;     ///< true: a count, an integer in JSON
};

/// Returns a row without symbol, formula, source and margin.
ResultRow plain_row(std::string key, std::string label, double value, std::string unit = "", std::string note = "");

/// Returns a row with a count.
ResultRow count_row(std::string key, std::string label, std::size_t count);

/// Returns a value with its unit, "infinite" or "unknown".
std::string value_text(ResultRow const& row);

/// Returns label and symbol: "sensitivity, S".
std::string label_text(ResultRow const& row);

/// Returns the width of a column of labels, at least 49 characters.
std::size_t label_width(std::vector<ResultRow> const& rows);

/// Appends rows whose keys are members of an object, such as a camera.
/// @param object  empty: the keys remain
void append_rows(std::vector<ResultRow>& rows, std::vector<ResultRow> more, std::string const& object);

/// Formats one line per row: label, symbol, value, margin and note.
std::string rows_text(std::vector<ResultRow> const& rows);

/// Returns the values by their keys; null: unknown or infinite.
nlohmann::ordered_json rows_json(std::vector<ResultRow> const& rows);

/// Formats a table with the columns key, symbol, label, value, unit and source (RFC 4180); nan: unknown.
std::string rows_csv(std::vector<ResultRow> const& rows);

/// Results with the same rows, such as those of a component of a vector.
struct ResultGroup {
  std::string name;
  std::vector<ResultRow> rows;
};

/// Formats a table with a line per group and a column per row.
/// @param heading  of the names of the groups
/// @param digits   number of significant digits
std::string groups_text(std::string const& heading, std::vector<ResultGroup> const& groups, int digits = 4);

}  // namespace gladstone::inline cases
