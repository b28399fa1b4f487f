#include "studies/oracles/validate.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "studies/case/json_text.h"
#include "studies/commands/command.h"

namespace gladstone::inline commands {
namespace {

nlohmann::json to_json(std::vector<OracleResult> const& results, std::size_t missed) {
  nlohmann::json rows = nlohmann::json::array();
  for (OracleResult const& result : results) {
    rows.push_back(
        {{"name", result.oracle.name},
         {"source", result.oracle.source},
         {"measured", std::isfinite(result.measured) ? nlohmann::json(result.measured) : nlohmann::json(nullptr)},
         {"exact", result.oracle.exact},
         {"tolerance", result.oracle.tolerance},
         {"tolerance_kind", result.oracle.kind == ToleranceKind::relative ? "relative" : "absolute"},
         {"passed", result.passed()}});
  }
  return {{"oracles", rows}, {"missed", missed}};
}

std::string to_text(std::vector<OracleResult> const& results, std::size_t missed, std::string const& device) {
  std::size_t width = 0;
  for (OracleResult const& result : results) width = std::max(width, std::strlen(result.oracle.name));
  std::string text = fmt::format("{:<{}}  {:>20}  {:>20}  {:>8}  {:>12}  {:<6}  {}\n", "oracle", width, "measured",
                                 "exact", "error", "allowed", "", "source");
  for (OracleResult const& result : results) {
    text += fmt::format("{:<{}}  {:>20.14g}  {:>20.14g}  {:>8.1e}  {:>8.1e} {:<3}  {:<6}  {}\n", result.oracle.name,
                        width, result.measured, result.oracle.exact, result.error(), result.oracle.tolerance,
                        result.oracle.kind == ToleranceKind::relative ? "rel" : "abs",
                        result.passed() ? "ok" : "MISSED", result.oracle.source);
  }
  return text + fmt::format("\n{} of {} oracles met, rendered on {}", results.size() - missed, results.size(), device);
}

}  // namespace

CommandBody attach_validate(CLI::App&, GlobalOptions const& options) {
  return [&options] {
    auto const renderer = options.open_device().renderer;
    std::vector<OracleResult> const results = run_oracles(*renderer);
    auto const missed = static_cast<std::size_t>(
        std::count_if(results.begin(), results.end(), [](OracleResult const& result) { return !result.passed(); }));
    print_result(options, json_text(to_json(results, missed)), to_text(results, missed, renderer->device()));
    return missed == 0 ? ok : check_missed;
  };
}

}  // namespace gladstone::inline commands
