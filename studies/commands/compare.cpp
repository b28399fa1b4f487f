#include "studies/compare.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>

#include "render/base/output_file.h"
#include "render/base/partial.h"
#include "studies/commands/arguments.h"
#include "studies/commands/command.h"
#include "studies/error_report.h"
#include "studies/figures/gnuplot.h"

namespace gladstone {

namespace {

namespace fs = std::filesystem;

/// Writes errors.json and the figures: all of them or, where one cannot be made, none.
/// @return what was drawn
std::vector<fs::path> write_results(std::string const& place, Comparison const& comparison, std::string const& json,
                                    bool figures) {
  remove_leftovers(place, stem_beside("comparison"));
  Partial const staging(place, stem_beside("comparison"), Partial::Kind::folder);
  fs::path const made = fs::path(staging.path()) / "figures";
  fs::create_directory(made);
  try {
    if (figures) name_final_place(made.string(), place, [&] { draw_comparison(made.string(), comparison); });
  } catch (GnuplotMissing const& missing) {
    spdlog::warn("{}", missing.what());
  }
  std::vector<fs::path> written;
  for (auto const& entry : fs::directory_iterator(made)) written.push_back(place / entry.path().filename());
  std::sort(written.begin(), written.end());
  OutputFile errors((fs::path(place) / case_file::errors).string());
  errors.write(json.data(), json.size());
  comparison.sources.check();
  for (auto const& path : written) fs::rename(made / path.filename(), path);
  errors.commit();
  return written;
}

/// What write_results() may write over.
std::vector<std::string> results_of_comparison(std::string const& folder) {
  std::vector<std::string> paths = derived_files(folder);
  std::erase_if(paths, [](std::string const& path) {
    std::string const name = fs::path(path).filename().string();
    return name == case_file::vectors || name == case_file::vectors_text;
  });
  return paths;
}

}  // namespace

CommandBody attach_compare(CLI::App& app, GlobalOptions const& options) {
  struct Arguments {
    std::string folder, truth_at = "mid", conventions;
    CompareOptions compare;
    bool no_figures = false;
  };
  auto arguments = std::make_shared<Arguments>();
  app.add_option("case", arguments->folder, "Case folder")->required();
  app.add_option("--vectors", arguments->compare.vectors,
                 "Vectors of ours, OpenPIV, PIVlab or any x,y,u,v in px, default CASE/vectors.h5; those outside the "
                 "image or longer than it are left out");
  app.add_option("--truth-at", arguments->truth_at,
                 "Where a dot counts: mid (symmetric codes) or reference (one-sided codes)")
      ->check(one_of({"mid", "reference"}));
  app.add_option(
      "--conventions", arguments->conventions,
      "Axes and sign of foreign vectors instead of detecting them, and refusing what fits none: y-down or y-up "
      "or y-up-image, v-down or v-up, swapped, offset=-0.5");
  app.add_flag("--no-figures", arguments->no_figures, "Numbers only");
  return [arguments, &options] {
    Device const device = options.open_device();
    CompareOptions compare = arguments->compare;
    if (arguments->truth_at == "reference") compare.truth_at = TruthAt::reference;
    if (!arguments->conventions.empty()) compare.conventions = arguments->conventions;
    std::string const& folder = arguments->folder;
    std::vector<std::string> inputs = rendered_files(folder);
    inputs.push_back(compare.vectors.empty() ? in_case(folder, case_file::vectors) : compare.vectors);
    refuse_inputs_as_outputs(results_of_comparison(folder), inputs);
    OutputFile const tried(in_case(folder, case_file::errors));
    Comparison const comparison = compare_case(folder, device, compare);
    std::string const json = errors_json(comparison);
    auto const figures = write_results(folder, comparison, json, !arguments->no_figures);
    if (!comparison.report.empty()) spdlog::info("{}", comparison.report);
    for (auto const& path : figures) spdlog::info("drew {}", path.string());
    print_result(options, json, error_report(comparison));
    return ok;
  };
}

}  // namespace gladstone
