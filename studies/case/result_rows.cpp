#include "studies/case/result_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <utility>

#include "studies/case/json_text.h"

namespace gladstone::inline cases {
namespace {

/// Quotes a field of CSV if it contains a comma, a quote or a line break.
std::string csv_field(std::string const& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (char const c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

}  // namespace

char const* margin_word(Margin margin) {
  constexpr char const* words[] = {"", "green", "marginal", "violated"};
  return words[static_cast<int>(margin)];
}

ResultRow plain_row(std::string key, std::string label, double value, std::string unit, std::string note) {
  return {.key = std::move(key),
          .label = std::move(label),
          .value = value,
          .unit = std::move(unit),
          .note = std::move(note)};
}

ResultRow count_row(std::string key, std::string label, std::size_t count) {
  return {.key = std::move(key), .label = std::move(label), .value = static_cast<double>(count), .whole = true};
}

char const* rating_text(Margin margin) { return margin == Margin::green ? "ok" : margin_word(margin); }

std::string label_text(ResultRow const& row) { return row.symbol.empty() ? row.label : row.label + ", " + row.symbol; }

std::size_t label_width(std::vector<ResultRow> const& rows) {
  std::size_t width = 49;
  for (ResultRow const& row : rows) width = std::max(width, label_text(row).size());
  return width;
}

std::string value_text(ResultRow const& row) {
  if (!std::isfinite(row.value)) return std::isnan(row.value) ? "unknown" : "infinite";
  return fmt::format("{:.{}g}{}{}", row.value, row.whole ? 15 : 6, row.unit.empty() ? "" : " ", row.unit);
}

void append_rows(std::vector<ResultRow>& rows, std::vector<ResultRow> more, std::string const& object) {
  for (ResultRow& row : more) {
    if (!object.empty()) row.key = object + '.' + row.key;
    rows.push_back(std::move(row));
  }
}

std::string rows_text(std::vector<ResultRow> const& rows) {
  std::size_t const width = label_width(rows);
  std::string text;
  for (ResultRow const& row : rows) {
    text += fmt::format("  {:<{}} {}", label_text(row), width, value_text(row));
    if (row.margin != Margin::none) text += fmt::format("  [{}]", rating_text(row.margin));
    text += (row.note.empty() ? "" : "  (" + row.note + ')') + '\n';
  }
  return text;
}

nlohmann::ordered_json rows_json(std::vector<ResultRow> const& rows) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  for (ResultRow const& row : rows) {
    std::string path = '/' + row.key;
    std::replace(path.begin(), path.end(), '.', '/');
    nlohmann::ordered_json& value = json[nlohmann::ordered_json::json_pointer(path)];
    if (row.whole) {
      value = static_cast<std::int64_t>(row.value);
    } else {
      value = number_or_null(row.value);
    }
  }
  return json;
}

std::string rows_csv(std::vector<ResultRow> const& rows) {
  std::string text = "key,symbol,label,value,unit,source\n";
  for (ResultRow const& row : rows) {
    text += fmt::format("{},{},{},{:.17g},{},{}\n", row.key, csv_field(row.symbol), csv_field(row.label), row.value,
                        csv_field(row.unit), csv_field(row.source));
  }
  return text;
}

std::string groups_text(std::string const& heading, std::vector<ResultGroup> const& groups, int digits) {
  std::size_t width = 16;
  for (ResultGroup const& group : groups) width = std::max(width, group.name.size());
  std::string header = fmt::format("  {:<{}}", heading, width), text;
  for (ResultGroup const& group : groups) {
    text += fmt::format("  {:<{}}", group.name, width);
    for (ResultRow const& row : group.rows) {
      std::string const column = row.label + (row.unit.empty() ? "" : " [" + row.unit + ']');
      if (&group == &groups.front()) header += fmt::format("  {:>12}", column);
      text += fmt::format("  {:>{}.{}g}", row.value, std::max<std::size_t>(12, column.size()), digits);
    }
    text += '\n';
  }
  return header + '\n' + text;
}

}  // namespace gladstone::inline cases
