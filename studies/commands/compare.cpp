#include "studies/compare.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>

#include "render/base/output_file.h"
#include "studies/commands/command.h"
#include "studies/error_report.h"
#include "studies/figures/gnuplot.h"

namespace gladstone {

CommandBody attach_compare(CLI::App& app, GlobalOptions const& options) {
  struct Arguments {
    std::string folder, truth_at = "mid", conventions;
    CompareOptions compare;
    bool no_figures = false;
  };
  auto arguments = std::make_shared<Arguments>();
  app.add_option("case", arguments->folder, "Case folder")->required();
  app.add_option("--vectors", arguments->compare.vectors,
                 "Vectors of ours, OpenPIV or PIVlab; default CASE/vectors.h5");
  app.add_option("--truth-at", arguments->truth_at,
                 "Where a dot counts: mid (symmetric codes) or reference (one-sided codes)")
      ->check(CLI::IsMember({"mid", "reference"}));
  app.add_option("--conventions", arguments->conventions,
                 "Axes and sign of foreign vectors instead of detecting them: y-up,v-up,swapped,offset=-0.5");
  app.add_flag("--no-figures", arguments->no_figures, "Numbers only");
  return [arguments, &options] {
    Device const device = options.open_device();
    CompareOptions compare = arguments->compare;
    if (arguments->truth_at == "reference") compare.truth_at = TruthAt::reference;
    if (!arguments->conventions.empty()) compare.conventions = arguments->conventions;
    Comparison const comparison = compare_case(arguments->folder, device, compare);
    std::string const json = errors_json(comparison);
    OutputFile::write_text(in_case(arguments->folder, case_file::errors), json);
    if (!comparison.report.empty()) spdlog::info("{}", comparison.report);
    if (!arguments->no_figures) {
      try {
        for (auto const& path : draw_comparison(arguments->folder, comparison)) spdlog::info("drew {}", path);
      } catch (GnuplotMissing const& missing) {
        spdlog::warn("{}", missing.what());
      }
    }
    print_result(options, json, error_report(comparison));
    return ok;
  };
}

}  // namespace gladstone
