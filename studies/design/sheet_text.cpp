#include "studies/design/sheet_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <vector>

namespace gladstone {
namespace {

using Json = nlohmann::ordered_json;

Json or_null(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

std::string value_text(SheetRow const& row) {
  if (!std::isfinite(row.value)) return "unknown";
  return fmt::format("{:.7g}{}{}", row.value, row.unit.empty() ? "" : " ", row.unit);
}

bool is_missed(SheetRow const& row) { return row.margin == Margin::violated || row.margin == Margin::marginal; }

}  // namespace

std::string missed_rows_text(DesignSheet const& sheet) {
  DesignSheet missed;
  std::copy_if(sheet.rows.begin(), sheet.rows.end(), std::back_inserter(missed.rows), is_missed);
  return sheet_text(missed);
}

std::string sheet_text(DesignSheet const& sheet) {
  std::vector<SheetRow> rows = sheet.rows;
  // First the rows that miss the usual recommendation, the worst first.
  auto const urgency = [](SheetRow const& row) {
    return row.margin == Margin::violated ? 0 : row.margin == Margin::marginal ? 1 : 2;
  };
  std::stable_sort(rows.begin(), rows.end(),
                   [&](SheetRow const& a, SheetRow const& b) { return urgency(a) < urgency(b); });
  std::string text;
  for (SheetRow const& row : rows) {
    text += fmt::format("  {:<4}{:<50}{:<28}{}\n", row.id, row.name, value_text(row), margin_word(row.margin));
    text += fmt::format("      = {}   [{}]{}{}\n", row.formula, row.source, row.note.empty() ? "" : "; ", row.note);
  }
  return text;
}

Json sheet_json(DesignSheet const& sheet) {
  Json json = Json::object(), rows = Json::array();
  for (SheetRow const& row : sheet.rows) {
    json[row.key] = or_null(row.value);
    rows.push_back({{"id", row.id},
                    {"key", row.key},
                    {"name", row.name},
                    {"value", or_null(row.value)},
                    {"unit", row.unit},
                    {"formula", row.formula},
                    {"source", row.source},
                    {"margin", margin_word(row.margin)},
                    {"note", row.note}});
  }
  json["field_of_view_mm"] = {json["field_of_view_mm"], json["field_of_view_height_mm"]};
  json.erase("field_of_view_height_mm");
  json["rows"] = rows;
  return json;
}

}  // namespace gladstone
