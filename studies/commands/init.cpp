#include "studies/commands/init.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "render/base/error.h"
#include "render/files/output_file.h"
#include "studies/case/json_text.h"
#include "studies/commands/arguments.h"
#include "studies/commands/command.h"
#include "studies/commands/embedded_text.h"
#include "studies/commands/setup_keys.h"

namespace gladstone::inline commands {
namespace {

/// A kind of file that `gladstone init` writes.
struct Template {
  char const* kind;
  std::string_view const* text;  ///< short template
  char const* required;          ///< keys of the complete list that are not commented out; null: those of `text`
};

constexpr std::array templates{
    Template{"bos", &embedded::template_bos, "schema = 1\nexperiment = \"bos\"\n"},
    Template{"piv", &embedded::template_piv, "schema = 1\nexperiment = \"piv\"\n"},
    Template{"stereo", &embedded::template_stereo, nullptr},
    Template{"calibration", &embedded::template_calibration, "schema = 1\nexperiment = \"calibration\"\n"},
    Template{"study", &embedded::template_study,
             "base = \"bos.toml\"\n\n[axes]\n"
             "\"lens.f_number\" = [5.6, 11, 22]  # a list; a value with a label is { label = \"open\", value = 5.6 }\n"
             "\"geometry.z_d_mm\" = { linear = [150, 450, 3] }  # first, last, number of values\n"
             "\"target.dot_diameter_px\" = { log = [2.0, 4.0, 3] }  # the same, spaced by factors\n"},
    Template{"design", &embedded::template_design, "schema = 1\nexperiment = \"bos\"\n"},
};

/// @throws DataError for an unknown kind
Template const& find_template(std::string const& kind) {
  auto const found =
      std::find_if(templates.begin(), templates.end(), [&](Template const& one) { return kind == one.kind; });
  if (found == templates.end()) {
    throw DataError(
        ErrorCode::arguments, "init",
        fmt::format("\"{}\" is not a kind of file; choose one of {}", kind, fmt::join(template_kinds(), ", ")));
  }
  return *found;
}

/// Returns a line of the complete list: the commented key with its default, unit, values and meaning. Keys without a
/// default in TOML have "..." in place of the value.
/// @param name  name of the key below the heading of its table
std::string commented_key(SetupKey const& key, std::string const& name) {
  std::string text = fmt::format("# {} = {}  #", name, key.default_value.empty() ? "..." : key.default_value);
  if (!key.unit.empty()) text += " [" + key.unit + ']';
  text += ' ' + key.meaning;
  if (!key.values.empty()) text += "; values: " + key.values;
  if (!key.default_words.empty())
    text += key.is_required() ? "; " + key.default_words : "; default: " + key.default_words;
  return text + '\n';
}

/// Table of a TOML text without comment lines.
struct GivenTable {
  std::string heading;             ///< "[lens]", "[[camera]]"; empty: top level
  std::vector<std::string> lines;  ///< lines of the table's keys, with comments

  bool has(std::string const& key) const {
    return std::any_of(lines.begin(), lines.end(), [&](auto const& line) { return line.starts_with(key + " ="); });
  }
};

std::vector<GivenTable> split_tables(std::string_view text) {
  std::vector<GivenTable> tables{{"", {}}};
  std::istringstream lines{std::string(text)};
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with('['))
      tables.push_back({line.substr(0, line.rfind(']', line.find('#')) + 1), {}});
    else if (!line.empty() && !line.starts_with('#'))
      tables.back().lines.push_back(line);
  }
  return tables;
}

/// Returns the tables [[camera]] with the keys that are given, and below the keys of the first camera all other keys,
/// commented out.
std::string list_cameras(std::vector<GivenTable> const& given, std::vector<SetupKeyTable> const& tables) {
  std::string text;
  for (GivenTable const& camera : given) {
    if (camera.heading != "[[camera]]") continue;
    bool const first = text.empty();
    text += '\n' + camera.heading + '\n';
    for (std::string const& line : camera.lines) text += line + '\n';
    if (!first) text += "# and any of the keys listed with the first camera\n";
    for (SetupKeyTable const& table : tables) {
      if (!first || !table.heading.starts_with("[camera")) continue;
      for (SetupKey const& key : table.keys) {
        std::string const path = key.path.substr(std::string_view("camera.").size());
        if (!camera.has(path)) text += commented_key(key, path);
      }
    }
  }
  return text;
}

/// Returns the keys of a table: those that are given, and all others commented out.
std::string list_table(SetupKeyTable const& table, GivenTable const& given) {
  bool const any_given = !given.lines.empty() && table.condition.empty();
  std::string text;
  if (!table.heading.empty()) {
    text += fmt::format("\n{}{}{}\n", any_given ? "" : "# ", table.heading,
                        table.condition.empty() ? "" : "  # with " + table.condition);
  }
  for (std::size_t i = 0; any_given && i < given.lines.size(); ++i) text += given.lines[i] + '\n';
  for (SetupKey const& key : table.keys)
    if (!any_given || !given.has(key.name())) text += commented_key(key, key.name());
  return text;
}

/// Returns a file with every key of a kind, commented out except for those that the file requires.
std::string complete_list(Template const& one) {
  std::string text = fmt::format(
      "# Every key of the kind \"{}\" with its default. To change a key, remove the \"# \" before it and before the "
      "name of\n# its table.\n",
      one.kind);
  std::vector<GivenTable> const given = split_tables(one.required ? one.required : *one.text);
  std::vector<SetupKeyTable> tables = setup_key_tables();
  for (SetupKeyTable& table : tables) {
    std::erase_if(table.keys, [&](SetupKey const& key) {
      return std::find(key.kinds.begin(), key.kinds.end(), one.kind) == key.kinds.end();
    });
  }
  std::erase_if(tables, [](SetupKeyTable const& table) { return table.keys.empty(); });
  std::set<std::string> listed{"[[camera]]"};
  std::string const cameras = list_cameras(given, tables);
  for (SetupKeyTable const& table : tables) {
    bool const of_camera = table.heading.starts_with("[camera");
    if (of_camera && !cameras.empty()) {
      if (table.heading == "[camera]") text += cameras;
      continue;
    }
    auto const found = std::find_if(given.begin(), given.end(), [&](GivenTable const& table_given) {
      return table_given.heading == table.heading;
    });
    text += list_table(table, found == given.end() ? GivenTable{} : *found);
    listed.insert(table.heading);
  }
  for (GivenTable const& table : given) {  // tables whose keys are the user's choice, such as the axes of a study
    if (listed.contains(table.heading)) continue;
    text += '\n' + table.heading + '\n';
    for (std::string const& line : table.lines) text += line + '\n';
  }
  return text;
}

/// Replaces the name of the file in the commands of a template's comment.
std::string with_file_name(std::string text, std::string const& kind, std::string const& file) {
  std::string const name = kind + ".toml";
  for (std::size_t at = text.find(name); at != std::string::npos; at = text.find(name, at + file.size())) {
    text.replace(at, name.size(), file);
  }
  return text;
}

/// Returns the first command of a template's comment that remains to be done; empty if it has none. A command that
/// writes another template is done if the file exists.
std::string next_command(std::string const& text) {
  std::string const other_template = "gladstone init ";
  for (auto start = text.find("\n#   gladstone "); start != std::string::npos;
       start = text.find("\n#   gladstone ", start + 1)) {
    auto const begin = text.find("gladstone ", start);
    std::string const command = text.substr(begin, text.find('\n', begin) - begin);
    std::error_code error;
    if (!command.starts_with(other_template) || !std::filesystem::exists(command.substr(command.rfind(' ') + 1), error))
      return command;
  }
  return "";
}

void write_new_file(std::string const& path, std::string const& text) {
  namespace fs = std::filesystem;
  if (std::error_code error; fs::exists(fs::symlink_status(path, error))) {
    throw OutputError(path, "exists already and would be overwritten; choose another name, or delete it first");
  }
  OutputFile::write_text(path, text);
}

}  // namespace

std::vector<std::string> template_kinds() {
  std::vector<std::string> kinds;
  for (Template const& one : templates) kinds.emplace_back(one.kind);
  return kinds;
}

std::string template_text(std::string const& kind, TemplateKeys keys) {
  Template const& one = find_template(kind);
  return keys == TemplateKeys::all ? complete_list(one) : std::string(*one.text);
}

std::string write_template(std::string const& path, std::string const& kind, TemplateKeys keys) {
  std::string text = template_text(kind, keys);
  if (keys == TemplateKeys::important) text = with_file_name(std::move(text), kind, path);
  write_new_file(path, text);
  return text;
}

CommandBody attach_init(CLI::App& app, GlobalOptions const& options) {
  struct Arguments {
    std::string kind, output;
    bool all = false;
  };
  auto arguments = std::make_shared<Arguments>();
  app.add_option("kind", arguments->kind, "bos, piv, stereo, calibration, study or design")
      ->required()
      ->check(one_of(template_kinds()));
  app.add_option("-o,--output", arguments->output, "File to create (TOML); default: the standard output");
  app.add_flag("--all", arguments->all,
               "Write every key with its default, commented out, instead of the most important keys");
  return [arguments, &options] {
    TemplateKeys const keys = arguments->all ? TemplateKeys::all : TemplateKeys::important;
    std::string const &kind = arguments->kind, &file = arguments->output;
    if (file.empty()) {
      std::string const text = template_text(kind, keys);
      print_result(options, json_text(nlohmann::ordered_json{{"kind", kind}, {"text", text}}), text);
      return ok;
    }
    std::string const text = write_template(file, kind, keys);
    std::string const next = arguments->all ? "" : next_command(text);
    print_result(options, json_text(nlohmann::ordered_json{{"kind", kind}, {"file", file}, {"next", next}}),
                 file + (next.empty() ? "" : "\nnext: " + next));
    return ok;
  };
}

}  // namespace gladstone::inline commands
