#include "studies/design/sheet_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>
#include <vector>

#include "studies/case/json_text.h"

namespace gladstone::inline design {
namespace {

using Json = nlohmann::ordered_json;

bool is_missed(ResultRow const& row) { return row.margin == Margin::violated || row.margin == Margin::marginal; }

}  // namespace

std::string missed_rows_text(DesignSheet const& sheet) {
  DesignSheet missed;
  std::copy_if(sheet.rows.begin(), sheet.rows.end(), std::back_inserter(missed.rows), is_missed);
  return sheet_text(missed);
}

std::string sheet_text(DesignSheet const& sheet) {
  std::vector<ResultRow> rows = sheet.rows;
  // First the rows that miss the usual recommendation, the worst first.
  auto const urgency = [](ResultRow const& row) {
    return row.margin == Margin::violated ? 0 : row.margin == Margin::marginal ? 1 : 2;
  };
  std::stable_sort(rows.begin(), rows.end(),
                   [&](ResultRow const& a, ResultRow const& b) { return urgency(a) < urgency(b); });
  std::size_t const width = label_width(rows);
  std::string text;
  for (ResultRow const& row : rows) {
    text += fmt::format("  {:<4}{:<{}} {:<28}{}\n", row.id, label_text(row), width, value_text(row),
                        rating_text(row.margin));
    text += fmt::format("      = {}   [{}]{}{}\n", row.formula, row.source, row.note.empty() ? "" : "; ", row.note);
  }
  return text;
}

Json sheet_values(std::vector<ResultRow> const& rows) {
  Json json = rows_json(rows);
  if (json.contains("field_of_view_height_mm")) {
    json["field_of_view_mm"] = {json["field_of_view_mm"], json["field_of_view_height_mm"]};
    json.erase("field_of_view_height_mm");
  }
  return json;
}

Json sheet_json(DesignSheet const& sheet) {
  Json json = sheet_values(sheet.rows), rows = Json::array();
  for (ResultRow const& row : sheet.rows) {
    rows.push_back({{"id", row.id},
                    {"key", row.key},
                    {"symbol", row.symbol},
                    {"name", row.label},
                    {"value", number_or_null(row.value)},
                    {"unit", row.unit},
                    {"formula", row.formula},
                    {"source", row.source},
                    {"margin", margin_word(row.margin)},
                    {"note", row.note}});
  }
  json["rows"] = rows;
  return json;
}

}  // namespace gladstone::inline design
