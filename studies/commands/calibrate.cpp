#include "studies/compare/calibrate.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "render/files/output_folder.h"
#include "render/scene/read_setup_document.h"
#include "studies/case/cameras.h"
#include "studies/case/case_files.h"
#include "studies/case/json_text.h"
#include "studies/case/warning_log.h"
#include "studies/commands/command.h"
#include "studies/compare/calibration_results.h"
#include "studies/drawing/draw_figure.h"
#include "studies/figures/draw_or_warn.h"

namespace gladstone::inline commands {
namespace {

namespace fs = std::filesystem;

/// Returns name and folder of each camera of a case; a case with a single unnamed camera has the name "" and its own
/// folder.
std::vector<std::pair<std::string, std::string>> camera_folders(std::string const& folder) {
  require_case(folder);
  std::vector<std::pair<std::string, std::string>> folders;
  SetupDocument const setup = read_setup_document((fs::path(folder) / case_file::setup).string());
  for (std::string const& name : camera_names(setup)) folders.emplace_back(name, (fs::path(folder) / name).string());
  if (folders.empty()) folders.emplace_back("", folder);
  return folders;
}

/// @param shown  folder of the files in messages
void write_results(std::string const& folder, Calibration const& calibration, bool figures, std::string const& shown) {
  write_calibration_file((fs::path(folder) / case_file::calibration).string(), calibration);
  if (!figures) return;
  std::string const figure = (fs::path(folder) / case_file::calibration_figure).string();
  if (draw_or_warn([&] { draw_calibration(figure, calibration); }))
    spdlog::info("drew {}", (fs::path(shown) / case_file::calibration_figure).string());
}

}  // namespace

CommandBody attach_calibrate(CLI::App& app, GlobalOptions const& options) {
  struct Arguments {
    std::string folder, output;
    std::vector<std::string> pictures;
    bool no_figures = false;
  };
  auto arguments = std::make_shared<Arguments>();
  app.add_option("case", arguments->folder,
                 "Case folder of a calibration, of one camera or several; with --images a setup (TOML) whose "
                 "[calibration] describes the target, and whose camera and lens are approximate")
      ->required();
  auto* const images = app.add_option("--images", arguments->pictures,
                                      "Your own images, one for each plane of calibration.planes_mm in that order");
  auto* const output = app.add_option("-o,--output", arguments->output, "Output folder, with --images");
  images->expected(-1)->needs(output);
  output->needs(images);
  app.add_flag("--no-figures", arguments->no_figures, "Draw no figures");
  return [arguments, &options] {
    if (!arguments->pictures.empty()) {
      std::string const& place = arguments->output;
      std::vector<std::string> inputs = arguments->pictures;
      inputs.push_back(arguments->folder);
      refuse_inputs_as_outputs({(fs::path(place) / case_file::calibration).string(),
                                (fs::path(place) / case_file::calibration_figure).string()},
                               inputs);
      OutputFolder folder(place, {case_file::calibration, {case_file::calibration_figure}});
      Calibration const calibration = calibrate_images(arguments->folder, arguments->pictures);
      log_warnings(calibration.warnings);
      folder.fill(
          [&](std::string const& staged) { write_results(staged, calibration, !arguments->no_figures, place); });
      folder.commit();
      print_result(options, json_text(calibration_json(calibration)), calibration_table(calibration));
      return ok;
    }
    auto const folders = camera_folders(arguments->folder);
    std::vector<Calibration> calibrations;
    for (auto const& [name, folder] : folders) calibrations.push_back(calibrate_case(folder));
    for (Calibration const& calibration : calibrations) log_warnings(calibration.warnings);
    nlohmann::ordered_json cameras;
    std::string text;
    for (std::size_t i = 0; i < folders.size(); ++i) {
      auto const& [name, folder] = folders[i];
      write_results(folder, calibrations[i], !arguments->no_figures, folder);
      cameras[name] = calibration_json(calibrations[i]);
      if (!name.empty()) text += fmt::format("{}camera {}\n", i > 0 ? "\n\n" : "", name);
      text += calibration_table(calibrations[i]);
    }
    bool const several = !folders.front().first.empty();
    print_result(options, json_text(several ? nlohmann::ordered_json{{"cameras", cameras}} : cameras[""]), text);
    return ok;
  };
}

}  // namespace gladstone::inline commands
