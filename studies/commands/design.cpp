#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "studies/case/json_text.h"
#include "studies/case/warning_log.h"
#include "studies/commands/arguments.h"
#include "studies/commands/command.h"
#include "studies/figures/design_figures.h"

namespace gladstone::inline commands {
namespace {

struct FigureOptions {
  std::string folder;  ///< empty: no figures
  std::string format = "png";
};

}  // namespace

CommandBody attach_design(CLI::App& app, GlobalOptions const& options) {
  auto request = std::make_shared<DesignRequest>();
  auto csv = std::make_shared<bool>(false);
  app.add_option("setup", request->setup, "Setup file (TOML), with [requirements] or without")->required();
  app.add_option("--set", request->overrides, "Override a key: --set lens.f_number=16")
      ->take_all()
      ->expected(1)
      ->trigger_on_parse(false);
  auto figures = std::make_shared<FigureOptions>();
  app.add_option("--figures", figures->folder, "Folder for figures of the layout, the design map and the Pareto front");
  app.add_option("--figure-format", figures->format, "png, svg or pdf")->check(one_of({"png", "svg", "pdf"}));
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
  app.add_option("--seed", request->verification.seed, "Seed of the dots and the noise in the simulations")
      ->check(whole_number(0, std::int64_t{1} << 62))
      ->capture_default_str();
  app.add_flag("--csv", *csv, "Print the design sheet as CSV: key, symbol, label, value, unit and source");
  return [request, figures, csv, &options] {
    request->open_device = [&options] { return options.open_device(); };
    DesignReport const report = answer_design(*request);
    log_warnings(report.warnings);
    nlohmann::ordered_json json;
    if (!figures->folder.empty()) json["figures"] = draw_design(report, figures->folder, figures->format);
    json.update(design_json(report));
    print_result(options, json_text(json), *csv ? rows_csv(report.sheet.rows) : report.text);
    return report.feasible ? ok : infeasible;
  };
}

}  // namespace gladstone::inline commands
