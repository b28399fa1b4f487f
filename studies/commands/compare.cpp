#include "studies/compare/compare.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "analysis/vectors/three_components.h"
#include "render/base/error.h"
#include "render/files/output_file.h"
#include "render/files/output_folder.h"
#include "render/files/partial.h"
#include "studies/case/json_text.h"
#include "studies/commands/arguments.h"
#include "studies/commands/command.h"
#include "studies/compare/comparison_results.h"
#include "studies/compare/stereo_scores.h"
#include "studies/compare/stored_comparison.h"
#include "studies/drawing/draw_figure.h"
#include "studies/figures/comparison_figures.h"
#include "studies/figures/draw_or_warn.h"

namespace gladstone::inline commands {

namespace {

namespace fs = std::filesystem;

/// Draws the figures into a temporary folder; without gnuplot, only warns.
/// @param place  final folder, for messages
void draw_if_possible(fs::path const& folder, std::string const& place, Comparison const& comparison) {
  draw_or_warn(
      [&] { report_final_path(folder.string(), place, [&] { draw_comparison(folder.string(), comparison); }); });
}

std::vector<fs::path> figures_in(fs::path const& folder) {
  std::vector<fs::path> figures;
  for (auto const& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == ".png") figures.push_back(entry.path().filename());
  }
  std::sort(figures.begin(), figures.end());
  return figures;
}

/// Files written for a comparison.
struct Written {
  std::vector<fs::path> figures;
  std::string json;  ///< content of errors.json
};

/// Writes comparison.h5 and the figures into a temporary folder, and formats errors.json, which is also stored in
/// comparison.h5.
/// @param place  final folder, for messages
Written write_parts(fs::path const& folder, std::string const& place, Comparison const& comparison, bool figures) {
  if (figures) draw_if_possible(folder, place, comparison);
  Written written{figures_in(folder), errors_json(comparison)};
  report_final_path(folder.string(), place,
                    [&] { write_chain((folder / case_file::comparison).string(), comparison, written.json); });
  return written;
}

/// Writes errors.json, comparison.h5 and the figures into the case folder. If creating any of them fails, none is
/// written.
Written write_beside(std::string const& place, Comparison const& comparison, bool figures) {
  remove_abandoned_outputs(place, sibling_stem("comparison"));
  Partial const staging(place, sibling_stem("comparison"), Partial::Kind::folder);
  fs::path const made = fs::path(staging.path()) / "figures";
  fs::create_directory(made);
  Written written = write_parts(made, place, comparison, figures);
  OutputFile errors((fs::path(place) / case_file::errors).string());
  errors.write(written.json.data(), written.json.size());
  comparison.sources.check();
  for (auto const& name : written.figures) fs::rename(made / name, place / name);
  fs::rename(made / case_file::comparison, fs::path(place) / case_file::comparison);
  errors.commit();
  return written;
}

/// Writes errors.json, comparison.h5 and the figures into a separate folder.
Written write_folder(OutputFolder& output, std::string const& place, Comparison const& comparison, bool figures) {
  Written written = write_parts(output.temporary_path(), place, comparison, figures);
  output.fill([&](std::string const& folder) {
    OutputFile::write_text((fs::path(folder) / case_file::errors).string(), written.json);
  });
  comparison.sources.check();
  output.commit();
  return written;
}

/// Returns the files that a folder of results can contain in addition to errors.json.
std::vector<std::string> other_results() {
  std::vector<std::string> names(case_file::derived.begin(), case_file::derived.end());
  std::erase_if(names, [](std::string const& name) {
    return fs::path(name).extension() != ".png" && name != case_file::comparison;
  });
  return names;
}

/// Returns the files that write_beside() may overwrite.
std::vector<std::string> results_of_comparison(std::string const& folder) {
  std::vector<std::string> paths = derived_files(folder);
  std::erase_if(paths, [](std::string const& path) {
    std::string const name = fs::path(path).filename().string();
    return name == case_file::vectors || name == case_file::vectors_text;
  });
  return paths;
}

bool is_existing_file(std::string const& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

/// Throws if options are given that do not apply to three components.
void refuse_options_of_cases(CompareOptions const& compare, std::string const& output) {
  std::vector<SetupProblem> problems;
  auto const refuse = [&](char const* option) {
    problems.push_back({option, "has no effect on a file of three components; remove it", "", ErrorCode::arguments});
  };
  if (!compare.vectors.empty()) refuse("--vectors");
  if (!output.empty()) refuse("--output");
  if (compare.conventions) refuse("--conventions");
  if (!problems.empty()) throw SetupError(std::move(problems));
}

}  // namespace

CommandBody attach_compare(CLI::App& app, GlobalOptions const& options) {
  struct Arguments {
    std::string folder, truth_at = "mid", conventions, output;
    CompareOptions compare;
    bool no_figures = false;
  };
  auto arguments = std::make_shared<Arguments>();
  app.add_option("case", arguments->folder,
                 "Case folder; or a file of gladstone stereo, whose three components are compared with its truth")
      ->required();
  app.add_option("--vectors", arguments->compare.vectors,
                 "Vectors of gladstone, OpenPIV, PIVlab, DaVis, Insight, Dantec, JPIV or any x,y,u,v, default "
                 "CASE/vectors.h5; vectors outside the image or longer than it are excluded");
  app.add_option("-o,--output", arguments->output, "Folder for errors.json and the figures, default CASE");
  app.add_option("--truth-at", arguments->truth_at,
                 "Position to which the displacement of a dot belongs: mid (midway between both frames, symmetric "
                 "codes) or reference (one-sided codes)")
      ->check(one_of({"mid", "reference"}));
  app.add_option("--conventions", arguments->conventions,
                 "Conventions of the file, instead of those of its format: y-down or y-up or y-up-image, v-down or "
                 "v-up, frames-exchanged, axes-exchanged or places-exchanged or components-exchanged, offset=-0.5; for "
                 "files in other units the size of a pixel in them, px=0.0614,px/frame=6.14");
  app.add_flag("--no-figures", arguments->no_figures, "Draw no figures");
  return [arguments, &options] {
    Backend const device = options.open_device();
    CompareOptions compare = arguments->compare;
    if (arguments->truth_at == "reference") compare.truth_at = TruthAt::reference;
    if (!arguments->conventions.empty()) compare.conventions = arguments->conventions;
    std::string const& folder = arguments->folder;
    if (is_existing_file(folder) && is_three_component_file(folder)) {
      refuse_options_of_cases(compare, arguments->output);
      StereoScores const scores = score_stereo_file(folder);
      print_result(options, json_text(summarize_scores(scores)), scores_report(scores));
      return ok;
    }
    std::vector<std::string> inputs = rendered_files(folder);
    inputs.push_back(compare.vectors.empty() ? in_case(folder, case_file::vectors) : compare.vectors);
    std::error_code missing;
    bool const apart = !arguments->output.empty() && !fs::equivalent(arguments->output, folder, missing);
    std::string const& place = apart ? arguments->output : folder;
    refuse_inputs_as_outputs(results_of_comparison(place), inputs);
    std::optional<OutputFolder> output;
    std::optional<OutputFile> tried;  // checks that the folder can be written, before the comparison
    if (apart) {
      output.emplace(place, FolderContent{case_file::errors, other_results()});
    } else {
      tried.emplace(in_case(folder, case_file::errors));
    }
    Comparison const comparison = compare_case(folder, device, compare);
    bool const draw = !arguments->no_figures;
    Written const written =
        apart ? write_folder(*output, place, comparison, draw) : write_beside(place, comparison, draw);
    for (auto const& name : written.figures) spdlog::info("drew {}", (place / name).string());
    print_result(options, written.json, error_report(comparison));
    bool const mistaken = comparison.detected && comparison.detected->mistake.found();
    return mistaken || !comparison.complete ? check_missed : ok;
  };
}

}  // namespace gladstone::inline commands
