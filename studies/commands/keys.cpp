#include "studies/commands/keys.h"

#include <fmt/format.h>
#include <fnmatch.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <nlohmann/json.hpp>

#include "render/base/nearest_name.h"
#include "studies/case/json_text.h"
#include "studies/commands/command.h"

namespace gladstone::inline commands {
namespace {

/// Returns true if a path contains the pattern, or matches it as a whole if it contains wildcards (*, ?, [...]).
bool matches(std::string const& path, std::string const& pattern) {
  if (pattern.find_first_of("*?[") == std::string::npos) return path.find(pattern) != std::string::npos;
  return ::fnmatch(pattern.c_str(), path.c_str(), 0) == 0;
}

/// Returns the paths of up to three keys that are similar to a misspelt path or last part of a path.
std::vector<std::string> similar_keys(std::string const& pattern) {
  constexpr std::size_t most = 3;
  std::vector<std::string> paths, names;
  for (SetupKeyTable const& table : setup_key_tables()) {
    for (SetupKey const& key : table.keys) {
      paths.push_back(key.path);
      names.push_back(key.name());
    }
  }
  std::vector<std::string> similar = nearest_names(pattern, paths, most);
  if (!similar.empty()) return similar;
  for (std::string const& name : nearest_names(pattern, names, most)) {
    for (std::size_t i = 0; i < paths.size() && similar.size() < most; ++i) {
      bool const listed = std::find(similar.begin(), similar.end(), paths[i]) != similar.end();
      if (names[i] == name && !listed) similar.push_back(paths[i]);
    }
  }
  return similar;
}

/// Returns a text, or null if it is empty.
nlohmann::ordered_json text_or_null(std::string const& text) {
  return text.empty() ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(text);
}

nlohmann::ordered_json to_json(SetupKey const& key, SetupKeyTable const& table) {
  return {{"key", key.path},
          {"condition", table.condition},
          {"unit", key.unit},
          {"default", text_or_null(key.default_value)},
          {"default_words", key.default_words},
          {"required", key.is_required()},
          {"values", key.values},
          {"meaning", key.meaning},
          {"kinds", key.kinds}};
}

/// Returns two lines: the key with unit, default and values, and its meaning.
std::string to_text(SetupKey const& key, SetupKeyTable const& table) {
  std::string text = key.path;
  if (!key.unit.empty()) text += " [" + key.unit + ']';
  if (!key.default_value.empty()) {
    text += " = " + key.default_value;
  } else if (key.is_required()) {
    text += ", " + key.default_words;
  } else {
    text += ", default: " + key.default_words;
  }
  if (!key.values.empty()) text += "  (" + key.values + ')';
  text += "\n    ";
  if (!table.condition.empty()) text += "with " + table.condition + ": ";
  return text + key.meaning + '\n';
}

}  // namespace

FoundKeys find_keys(std::string const& pattern) {
  FoundKeys found;
  for (SetupKeyTable const& table : setup_key_tables()) {
    for (SetupKey const& key : table.keys) {
      if (matches(key.path, pattern)) found.keys.push_back({&table, &key});
    }
  }
  if (found.keys.empty()) found.similar = similar_keys(pattern);
  return found;
}

nlohmann::ordered_json keys_json(FoundKeys const& found) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (FoundKeys::Key const& one : found.keys) json.push_back(to_json(*one.key, *one.table));
  return json;
}

CommandBody attach_keys(CLI::App& app, GlobalOptions const& options) {
  auto pattern = std::make_shared<std::string>();
  app.add_option("pattern", *pattern,
                 "Part of a key's path (f_number, medium.field), or a whole path with wildcards: 'camera.*_um'");
  return [pattern, &options] {
    FoundKeys const found = find_keys(*pattern);
    nlohmann::ordered_json result{{"keys", keys_json(found)}};
    if (!found.keys.empty()) {
      std::string text;
      for (FoundKeys::Key const& one : found.keys) text += to_text(*one.key, *one.table);
      print_result(options, json_text(result), text);
      return ok;
    }
    std::vector<std::string> const& similar = found.similar;
    result["similar"] = similar;
    if (options.json) print_result(options, json_text(result), "");
    print_error(
        fmt::format("gladstone: no key matches \"{}\"; {}", *pattern,
                    similar.empty() ? "gladstone keys lists all keys" : "did you mean " + quoted_list(similar) + '?'));
    return check_missed;
  };
}

}  // namespace gladstone::inline commands
