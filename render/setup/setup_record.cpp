#include "render/setup/setup_record.h"

#include "render/setup/setup_node.h"
#include "render/setup/toml_text.h"

namespace gladstone::inline setup {
namespace {

bool has_values(SetupRecord const& record) {
  if (record.present) return true;
  for (auto const& entry : record.entries) {
    if (!entry.value.empty()) return true;
    for (auto const& table : entry.tables) {
      if (has_values(table)) return true;
    }
  }
  return false;
}

void write_table(SetupRecord const& record, std::string const& path, std::string& text) {
  for (auto const& entry : record.entries) {
    if (entry.tables.empty() && !entry.value.empty()) text += toml_key(entry.key) + " = " + entry.value + '\n';
  }
  for (auto const& entry : record.entries) {
    std::string const name = (path.empty() ? "" : path + '.') + toml_key(entry.key);
    for (auto const& table : entry.tables) {
      if (!entry.array && !has_values(table)) continue;
      if (!text.empty()) text += '\n';
      text += entry.array ? "[[" + name + "]]\n" : '[' + name + "]\n";
      write_table(table, name, text);
    }
  }
}

}  // namespace

SetupRecord::Entry& SetupRecord::entry(std::string const& key) {
  for (auto& known : entries) {
    if (known.key == key) return known;
  }
  Entry& added = entries.emplace_back();
  added.key = key;
  return added;
}

SetupRecord::Entry const* SetupRecord::find(std::string const& key) const {
  for (auto const& known : entries) {
    if (known.key == key) return &known;
  }
  return nullptr;
}

std::vector<std::string> SetupRecord::keys() const {
  std::vector<std::string> names;
  for (auto const& known : entries) names.push_back(known.key);
  return names;
}

std::string SetupRecord::table_with(std::string const& key) const {
  if (find(key)) return "";
  for (auto const& known : entries) {
    for (auto const& table : known.tables) {
      std::string const path = table.table_with(key);
      if (path != "?") return path.empty() ? known.key : known.key + '.' + path;
    }
  }
  return "?";
}

std::string resolved_toml(SetupRecord const& root) {
  std::string text;
  write_table(root, "", text);
  return text;
}

}  // namespace gladstone::inline setup
