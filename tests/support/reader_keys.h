#pragma once

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "render/base/error.h"
#include "render/scene/read_setup.h"
#include "render/scene/setup.h"
#include "render/setup/setup_state.h"
#include "studies/case/correlation_setup.h"
#include "studies/case/light_exposure.h"
#include "studies/design/question.h"

/// Determines what the readers of a setup accept, by running them: the keys that they request, their defaults, and from
/// their error messages the allowed values.
namespace gladstone::test {

/// Runs the readers of a setup, except for the tables of a design problem; problems are collected in the document.
inline void run_readers(SetupTable root) {
  try {
    read_setup(root);
  } catch (DataError const&) {  // a field file that does not exist
  }
  read_correlation_settings(root.table("correlate"));
  read_light(root);
}

/// Keys that the readers request from a setup.
struct RequestedKeys {
  std::map<std::string, std::string> values;  ///< TOML text of the value of each key, by dotted path; empty: none
  std::set<std::string> looked_for;  ///< paths whose presence alone is requested, such as that of a gas's formula
  std::vector<std::string> missing;  ///< paths of required keys that the setup lacks

  bool requires_key(std::string const& path) const {
    return std::find(missing.begin(), missing.end(), path) != missing.end();
  }
};

/// Appends the keys of a record; arrays of tables count as tables.
inline void append_keys(SetupRecord const& record, std::string const& table, RequestedKeys& found) {
  for (SetupRecord::Entry const& entry : record.entries) {
    std::string const path = table.empty() ? entry.key : table + '.' + entry.key;
    found.values.emplace(path, entry.value);
    if (!entry.read && entry.tables.empty()) found.looked_for.insert(path);
    for (SetupRecord const& below : entry.tables) append_keys(below, path, found);
  }
}

inline RequestedKeys requested_keys(std::string const& setup) {
  SetupDocument::State state;
  state.name = "setup";
  state.folder = "/";
  state.root = parse_toml(setup, state.name);
  state.record.present = true;
  run_readers(SetupTable(&state, {}));
  RequestedKeys found;
  append_keys(state.record, "", found);
  for (SetupProblem const& problem : state.problems) {
    if (problem.code != ErrorCode::missing_key) continue;
    std::string path = problem.key;  // with indices: "camera[0].name"
    for (auto open = path.find('['); open != std::string::npos; open = path.find('[')) {
      path.erase(open, path.find(']', open) - open + 1);
    }
    found.missing.push_back(path);
  }
  return found;
}

/// Returns the error message of the readers for a key with this value; empty if they accept the value.
inline std::string objection(std::string const& setup, std::string const& path, std::string const& value) {
  SetupDocument document = SetupDocument::from_text(setup, "setup", "/");
  document.override_key(path + '=' + value);
  run_readers(document.root());
  if (document.find({"requirements"})) read_design_question(document);
  try {
    document.finish();
  } catch (SetupError const& error) {
    std::string const at = "--set " + path + '=';
    for (SetupProblem const& problem : error.problems()) {
      auto const text = problem.message.find(": ");
      if (problem.where.starts_with(at) && text != std::string::npos) return problem.message.substr(text + 2);
    }
  }
  return {};
}

/// Returns the text between two texts, or from the first one to the end; empty if the first one does not occur.
inline std::string between_texts(std::string const& text, std::string const& first, std::string const& last) {
  auto const start = text.find(first);
  if (start == std::string::npos) return {};
  return text.substr(start + first.size(), text.find(last, start + first.size()) - start - first.size());
}

/// Returns the limits in a message: "must be greater than 0 and at most 1e+04" -> "> 0, ≤ 10000"; empty if there are
/// none.
inline std::string limits_in(std::string message) {
  message = between_texts(message, "must be ", ";");
  std::string limits;
  for (auto const& [words, sign] : {std::pair("greater than ", "> "), {"at least ", "≥ "}, {"at most ", "≤ "}}) {
    std::string number = between_texts(message, words, " ");
    if (number.empty()) continue;
    if (auto const sign_at = number.find("e+"); sign_at != std::string::npos) {  // 1e+09 -> 1e9
      number.erase(sign_at + 1, number[sign_at + 2] == '0' ? 2 : 1);
    }
    limits += (limits.empty() ? "" : ", ") + (sign + number);
  }
  return limits;
}

/// Returns the quoted words of a message, in backticks, without a suggestion.
inline std::string words_in(std::string message) {
  message = message.substr(0, message.find("; did you mean"));
  std::string words;
  for (std::size_t at = message.find('"'); at != std::string::npos; at = message.find('"', at + 1)) {
    std::size_t const end = message.find('"', at + 1);
    words += (words.empty() ? "`" : ", `") + message.substr(at, end - at + 1) + '`';
    at = end;
  }
  return words;
}

/// Returns the limits of a key, from the messages about a value below and one above them; the noun if there are none.
inline std::string limits_or(std::string const& noun, std::string const& setup, std::string const& path,
                             std::string const& low, std::string const& high) {
  std::string limits = limits_in(objection(setup, path, high));
  if (limits.empty()) limits = limits_in(objection(setup, path, low));
  return limits.empty() ? noun : noun == "number" ? limits : noun + ' ' + limits;
}

/// Returns the allowed values of a key as docs/reference/setup.md states them: limits of numbers, words, or the kind of
/// value. Empty if the readers do not accept the key in this setup.
inline std::string allowed_values(std::string const& setup, std::string const& path) {
  std::string const for_text = objection(setup, path, "\"no such word\""), for_number = objection(setup, path, "1e300");
  if (for_number.starts_with("must be a text")) return "text";
  if (for_text.starts_with("must be true or false")) return "`true`, `false`";
  if (for_text.starts_with("must be an array of strings")) return "texts";
  if (for_text.starts_with("must be an array of ")) {
    std::string const form = between_texts(for_text, "must be an array of ", " (it is");
    std::string limits;
    for (std::string const value : {"1e300", "-1e300", "9000000000000000000", "-9000000000000000000"}) {
      std::string array = value;
      for (int count = 1; count < std::max(1, std::atoi(form.c_str())); ++count) array += ", " + value;
      if (limits.empty()) limits = limits_in(objection(setup, path, '[' + array + ']'));
    }
    return form + (limits.empty() ? "" : ", each " + limits);
  }
  if (for_text.starts_with("must be a table or an array of tables")) return "tables";
  if (for_text.starts_with("must be a whole number"))
    return limits_or("whole number", setup, path, "-9000000000000000000", "9000000000000000000");
  if (for_text.starts_with("must be a number")) {
    std::string const limits = limits_or("number", setup, path, "-1e300", "1e300"), words = words_in(for_text);
    return limits + (words.empty() ? "" : ", or " + words);
  }
  if (for_text.starts_with("must be \"")) return words_in(for_text);
  return {};
}

}  // namespace gladstone::test
