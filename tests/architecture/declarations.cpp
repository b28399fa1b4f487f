#include "tests/architecture/declarations.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <regex>
#include <set>

#include "tests/architecture/product_sources.h"

namespace gladstone::architecture {
namespace {

/// Returns a source without comments and preprocessor lines, and with empty literals.
std::string blank_literals(std::string const& source) {
  std::string const code = without_comments(source);
  std::string text;
  for (std::size_t i = 0; i < code.size(); ++i) {
    std::size_t const end = end_of_literal(code, i);
    if (end > i) {
      i = end - 1;
      text += "\"\"";
    } else if (code[i] == '#' && (text.empty() || text.back() == '\n')) {
      while (i < code.size() && (code[i] != '\n' || code[i - 1] == '\\')) ++i;
      text += '\n';
    } else {
      text += code[i];
    }
  }
  return text;
}

/// Returns name and number of parameters of a function that a statement declares, or a block begins with; nullopt for
/// other statements and excluded functions.
std::optional<std::string> function_of(std::string const& statement) {
  static std::set<std::string> const excluded{"template", "struct", "class",  "enum",   "union",  "using",
                                              "typedef",  "static", "friend", "extern", "inline", "constexpr"};
  auto const first = std::find_if(statement.begin(), statement.end(), is_word);
  if (excluded.count(std::string(first, std::find_if_not(first, statement.end(), is_word))) > 0) return std::nullopt;
  int nested = 0;
  std::size_t open = 0;
  for (; open < statement.size() && (nested > 0 || statement[open] != '('); ++open)
    nested += statement[open] == '<' ? 1 : statement[open] == '>' ? -1 : 0;
  std::size_t begin = open;
  while (begin > 0 && (is_word(statement[begin - 1]) || statement[begin - 1] == ':')) --begin;
  std::string const before = statement.substr(0, begin), name = statement.substr(begin, open - begin);
  bool const has_type = std::any_of(before.begin(), before.end(), is_word);
  if (open >= statement.size() || name.empty() || !has_type || name.find(':') != std::string::npos ||
      before.find('=') != std::string::npos || before.find("operator") != std::string::npos)
    return std::nullopt;
  int depth = 0;
  std::size_t commas = 0, end = open;
  for (; end < statement.size(); ++end) {
    char const c = statement[end];
    depth += c == '(' || c == '<' || c == '{' ? 1 : c == ')' || c == '>' || c == '}' ? -1 : 0;
    if (depth == 0) break;
    commas += c == ',' && depth == 1 ? 1 : 0;
  }
  std::string const parameters = statement.substr(open + 1, end - open - 1);
  bool const none = std::none_of(parameters.begin(), parameters.end(), is_word);
  return name + '/' + std::to_string(none ? 0 : commas + 1);
}

/// Returns the name of the namespace that a block begins with, empty if it is unnamed; nullopt for other blocks.
std::optional<std::string> namespace_of(std::string const& statement) {
  static std::regex const opening("\\s*(?:inline\\s+)?namespace\\b([\\w:\\s]*)"), inline_word("\\binline\\b|\\s+");
  std::smatch match;
  if (statement.find("namespace") == std::string::npos || !std::regex_match(statement, match, opening))
    return std::nullopt;
  return std::regex_replace(match.str(1), inline_word, "");
}

std::string without_ending(std::string const& path) { return std::filesystem::path(path).replace_extension().string(); }

}  // namespace

std::vector<FunctionSite> functions_of(std::string const& source) {
  std::string const text = blank_literals(source);
  std::vector<FunctionSite> sites;
  std::vector<std::string> scope;  // names of the open namespaces
  std::string statement;
  int blocks = 0, parentheses = 0;  // open blocks that are not namespaces, and parentheses outside of these
  auto const add = [&](bool defined) {
    std::optional<std::string> const function = function_of(statement);
    if (!function) return false;
    std::string qualified;
    for (std::string const& name : scope) qualified += name + "::";
    if (std::find(scope.begin(), scope.end(), "") == scope.end()) sites.push_back({qualified + *function, defined});
    return true;
  };
  bool in_function = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    char const c = text[i];
    if (blocks > 0) {
      blocks += c == '{' ? 1 : c == '}' ? -1 : 0;
      if (blocks > 0) continue;
      // A block that is not followed by one of these characters ends its statement.
      std::size_t const next = text.find_first_not_of(" \n", i + 1);
      bool const continues = !in_function && next != std::string::npos && std::string(",{;).(").find(text[next]) < 6;
      statement = continues ? statement + "{}" : "";
    } else if (c == '{') {
      std::optional<std::string> const name = namespace_of(statement);
      if (name) scope.push_back(*name);
      in_function = !name && parentheses == 0 && add(true);
      if (name) statement.clear();
      blocks = name ? 0 : 1;
    } else if (c == '}') {
      if (!scope.empty()) scope.pop_back();
      statement.clear();
    } else if (c == ';' && parentheses == 0) {
      add(false);
      statement.clear();
    } else {
      parentheses += c == '(' ? 1 : c == ')' ? -1 : 0;
      statement += c;
    }
  }
  return sites;
}

std::vector<std::string> strayed_declarations(std::map<std::string, std::string> const& sources) {
  std::map<std::string, std::set<std::string>> declaring, defining;  // paths by function
  for (auto const& [path, text] : sources)
    for (FunctionSite const& site : functions_of(text))
      (site.defined ? defining : declaring)[site.function].insert(path);
  std::vector<std::string> strayed;
  for (auto const& [function, headers] : declaring) {
    std::set<std::string> const& files = defining[function];
    for (std::string const& header : headers) {
      bool const own = std::any_of(files.begin(), files.end(), [&, &header = header](std::string const& file) {
        return without_ending(file) == without_ending(header);
      });
      if (!files.empty() && !own) strayed.push_back(header + ": " + function + " is defined in " + *files.begin());
    }
  }
  return strayed;
}

std::map<std::string, char const*> const& registry_headers() {
  static char const *const methods = "methods of one kind, one file each", *const kernels = "kernels of a room",
                           *const formats = "readers or writers of one kind, one file for each format";
  static std::map<std::string, char const*> const headers{
      {"analysis/correlation/correlation_methods.h", methods},
      {"analysis/correlation/optical_flow/dense_flow.h", methods},
      {"analysis/correlation/subpixel_fit.h", methods},
      {"analysis/preparation/frame_changes.h", methods},
      {"analysis/uncertainty/uncertainty.h", methods},
      {"analysis/vectors/vector_readers/vector_readers.h", formats},
      {"analysis/vectors/vector_writers/vector_writers.h", formats},
      {"cuda/correlation/correlation_kernels.h", kernels},
      {"cuda/focused_dots/dot_cones.h", kernels},
      {"cuda/ideal_images/tile_lists.h", kernels},
      {"cuda/rays/trace_particles.h", kernels},
      {"python/src/call.h", "parts of the module, one file for each topic"},
      {"render/files/fields/readers/vtk.h", formats},
      {"render/optics/prescription_readers/readers.h", formats},
      {"studies/commands/command.h", "commands, one file each"},
      {"studies/figures/study_drawings.h", "figures of a study, one file each"},
      {"studies/oracles/oracles.h", "oracles, one file for each kind"},
      {"studies/report/report.h", "reports of a study, a case and a measurement, one file each"},
      {"studies/report/report_page.h", formats},
  };
  return headers;
}

}  // namespace gladstone::architecture
