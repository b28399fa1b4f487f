#include "studies/design/design.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "studies/case/json_text.h"
#include "studies/commands/arguments.h"
#include "studies/commands/command.h"

namespace gladstone {

CommandBody attach_design(CLI::App& app, GlobalOptions const& options) {
  auto request = std::make_shared<DesignRequest>();
  app.add_option("setup", request->setup, "Setup file (TOML), with [requirements] or without")->required();
  app.add_option("--set", request->overrides, "Override a key: --set lens.f_number=16")
      ->take_all()
      ->expected(1)
      ->trigger_on_parse(false);
  app.add_option("--figures", request->figures, "Folder for figures of the layout, the design map and the front");
  app.add_option("--figure-format", request->figure_format, "png, svg or pdf")->check(one_of({"png", "svg", "pdf"}));
  app.add_option("--apply", request->apply, "File (TOML) for the recommended setup, ready to render");
  app.add_option(
         "--verify", request->verification.benches,
         "Number of best combinations to verify by rendering and correlation (some minutes); 0: use the formulas only")
      ->check(whole_number(0, 100))
      ->capture_default_str();
  app.add_option("--repeats", request->verification.repeats,
                 "Number of simulations of each combination, with different dots and noise")
      ->check(whole_number(2, 1000))
      ->capture_default_str();
  app.add_option("--seed", request->verification.seed, "Seed of these dots and of the noise")
      ->check(whole_number(0, std::int64_t{1} << 62))
      ->capture_default_str();
  return [request, &options] {
    request->open_device = [&options] { return options.open_device(); };
    DesignReport const report = design(*request);
    for (std::string const& warning : report.warnings) spdlog::warn("{}", warning);
    print_result(options, json_text(report.json), report.text);
    return report.feasible ? ok : infeasible;
  };
}

}  // namespace gladstone
