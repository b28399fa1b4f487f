#include "studies/commands/setup_keys.h"

#include <algorithm>

#include "render/base/text.h"
#include "studies/commands/embedded_text.h"

namespace gladstone::inline commands {
namespace {

/// Removes the backticks and replaces the links of a text in Markdown by their words.
std::string plain_text(std::string_view markdown) {
  std::string text;
  for (std::size_t i = 0; i < markdown.size(); ++i) {
    if (markdown.substr(i).starts_with("](")) {
      std::size_t const open = text.rfind('[');
      if (open != std::string::npos) text.erase(open, 1);
      i = markdown.find(')', i);
      if (i == std::string_view::npos) break;
    } else if (markdown[i] != '`') {
      text += markdown[i];
    }
  }
  return text;
}

/// Returns the cells of a row: "| a | b |".
std::vector<std::string> split_cells(std::string_view row) {
  std::vector<std::string> cells;
  for (std::size_t start = 1; start < row.size();) {
    std::size_t const end = std::min(row.find('|', start), row.size());
    cells.push_back(trimmed(row.substr(start, end - start)));
    start = end + 1;
  }
  return cells;
}

/// Returns the names in backticks.
std::vector<std::string> quoted_names(std::string_view text) {
  std::vector<std::string> names;
  for (std::size_t open = text.find('`'); open != std::string_view::npos; open = text.find('`', open + 1)) {
    std::size_t const end = std::min(text.find('`', open + 1), text.size());
    names.emplace_back(text.substr(open + 1, end - open - 1));
    open = end;
  }
  return names;
}

/// Reads a heading: "`[lens]`, `model = "prescription"`".
SetupKeyTable parse_heading(std::string_view heading) {
  SetupKeyTable table;
  std::vector<std::string> const names = quoted_names(heading);
  if (names.empty()) return table;
  table.heading = names.front();
  if (auto const comma = heading.find("`, "); comma != std::string_view::npos)
    table.condition = plain_text(heading.substr(comma + 3));
  return table;
}

/// Reads a row of a table; its path begins with the name of the table.
SetupKey parse_key(std::vector<std::string> const& cells, SetupKeyTable const& table) {
  SetupKey key;
  std::string name = table.heading;
  std::erase_if(name, [](char c) { return c == '[' || c == ']'; });
  key.path = (name.empty() ? "" : name + '.') + plain_text(cells[0]);
  key.unit = cells[1];
  bool const fixed = cells[2].size() > 2 && cells[2].front() == '`' && cells[2].find('`', 1) == cells[2].size() - 1;
  (fixed ? key.default_value : key.default_words) = plain_text(cells[2]);
  key.values = plain_text(cells[3]);
  key.meaning = plain_text(cells[4]);
  key.kinds = table.kinds;
  if (key.meaning.ends_with("BOS only"))
    std::erase_if(key.kinds, [](std::string const& kind) { return kind != "bos" && kind != "design"; });
  return key;
}

}  // namespace

std::vector<SetupKeyTable> parse_key_tables(std::string_view page) {
  constexpr std::size_t columns = 5;
  std::vector<SetupKeyTable> tables;
  SetupKeyTable table;
  for (std::size_t start = 0; start < page.size();) {
    std::size_t const end = std::min(page.find('\n', start), page.size());
    std::string_view const line = page.substr(start, end - start);
    start = end + 1;
    if (line.starts_with("## ")) {
      table = parse_heading(line.substr(3));
    } else if (line.starts_with("Kinds: ")) {
      table.kinds = quoted_names(line);
      tables.push_back(table);
    } else if (line.starts_with("| `") && !tables.empty()) {
      std::vector<std::string> const cells = split_cells(line);
      if (cells.size() >= columns) tables.back().keys.push_back(parse_key(cells, tables.back()));
    }
  }
  return tables;
}

std::vector<SetupKeyTable> const& setup_key_tables() {
  static std::vector<SetupKeyTable> const tables = parse_key_tables(embedded::setup_keys);
  return tables;
}

}  // namespace gladstone::inline commands
