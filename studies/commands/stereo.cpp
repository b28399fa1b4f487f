#include "studies/compare/stereo.h"

#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "render/base/error.h"
#include "render/base/units.h"
#include "render/files/output_file.h"
#include "studies/case/case_files.h"
#include "studies/case/json_text.h"
#include "studies/commands/arguments.h"
#include "studies/commands/command.h"
#include "studies/compare/stereo_file.h"
#include "studies/drawing/draw_figure.h"
#include "studies/figures/draw_or_warn.h"
#include "studies/figures/stereo_figure.h"

namespace gladstone::inline commands {
namespace {

/// Returns the files that a stereoscopic measurement may read.
std::vector<std::string> list_stereo_inputs(StereoOptions const& options) {
  std::vector<std::string> inputs = options.calibrations;
  inputs.insert(inputs.end(), options.images.begin(), options.images.end());
  for (std::string const& place : options.inputs) {
    inputs.push_back(place);
    for (std::string const& file : rendered_files(place)) inputs.push_back(file);
    inputs.push_back((std::filesystem::path(place) / case_file::vectors).string());
  }
  return inputs;
}

/// Draws the figure, or warns if gnuplot is not installed.
void draw_stereo(std::string const& path, StereoMeasurement const& measurement) {
  if (draw_or_warn([&] { draw_figure(make_stereo_figure(measurement), path); })) spdlog::info("drew {}", path);
}

}  // namespace

CommandBody attach_stereo(CLI::App& app, GlobalOptions const& options) {
  struct Arguments {
    StereoOptions stereo;
    std::string output, conventions, dewarp = "vectors";
    double sheet_z_mm = 0.0;
    std::optional<double> spacing_mm;
    std::vector<double> slope;
    bool no_figures = false, csv = false;
  };
  auto arguments = std::make_shared<Arguments>();
  StereoOptions& given = arguments->stereo;
  app.add_option("first", given.inputs[0],
                 "Case folder of the first camera, with vectors.h5, or a file of vectors of gladstone or another "
                 "program; without second the folder of a case with two cameras")
      ->required();
  app.add_option("second", given.inputs[1], "Case folder or file of vectors of the second camera");
  app.add_option("-o,--output", arguments->output,
                 "File for the three components, .h5; the figure has the same name with .png")
      ->required();
  app.add_option("--calibration", given.calibrations,
                 "calibration.h5 of the first and of the second camera, from gladstone calibrate; default for cases: "
                 "the exact cameras of their setups")
      ->expected(2);
  app.add_option("--conventions", arguments->conventions,
                 "Conventions of the vectors of another program, see gladstone compare --help");
  app.add_option("--sheet-z", arguments->sheet_z_mm,
                 "Z of the middle of the laser sheet at X = Y = 0 in the calibration's world frame [mm], default 0");
  app.add_option("--sheet-slope", arguments->slope, "Slopes dZ/dX and dZ/dY of the laser sheet [1], default 0 0")
      ->expected(2);
  app.add_flag(
      "--align", given.align,
      "Determine the laser sheet from the disparity between the images of both cameras (Wieneke 2005), starting "
      "from --sheet-z and --sheet-slope");
  app.add_option("--images", given.images,
                 "Images for the disparity, of the first and of the second camera in turn, two for each time; default: "
                 "the frames of the cases")
      ->expected(-1);
  app.add_option(
         "--dewarp", arguments->dewarp,
         "vectors: combine vectors of the original images; images: dewarp the frames of the cases onto the sheet "
         "and correlate those")
      ->check(one_of({"vectors", "images"}));
  app.add_option("--spacing", arguments->spacing_mm,
                 "Distance between the nodes of the result [mm], default: mean distance of the vectors")
      ->check(positive_number());
  app.add_option("--window", given.window_px,
                 "Size of the interrogation windows, which correlates the errors of neighbouring vectors [px]; 0: "
                 "independent errors; default: the last window of [correlate]")
      ->check(non_negative_number());
  app.add_option("--residual-limit", given.residual_limit,
                 "Largest residual of the four equations, in standard uncertainties: vectors with a larger one are "
                 "rejected, default 4; 0: accept all")
      ->check(non_negative_number());
  app.add_flag("--no-figures", arguments->no_figures, "Draw no figure");
  app.add_flag("--csv", arguments->csv, csv_help);
  return [arguments, &options] {
    Backend const device = options.open_device();
    StereoOptions stereo = arguments->stereo;
    stereo.dewarp_images = arguments->dewarp == "images";
    if (!arguments->conventions.empty()) stereo.conventions = arguments->conventions;
    stereo.plane.height = arguments->sheet_z_mm * unit::mm;
    if (arguments->slope.size() == 2) stereo.plane.slope = {arguments->slope[0], arguments->slope[1]};
    stereo.spacing = arguments->spacing_mm.value_or(0.0) * unit::mm;
    std::string const& output = arguments->output;
    if (!output.ends_with(".h5")) throw OutputError(output, "does not end in .h5; choose such a name");
    std::string const figure = std::filesystem::path(output).replace_extension(".png").string();
    stereo.inputs = find_stereo_inputs(stereo.inputs);
    refuse_inputs_as_outputs({output, figure}, list_stereo_inputs(stereo));
    OutputFile const tried(output, "gladstone stereo");
    StereoMeasurement const measurement = measure_stereo(stereo, device);
    write_stereo(output, measurement);
    if (!arguments->no_figures) draw_stereo(figure, measurement);
    nlohmann::ordered_json json = summarize_stereo(measurement);
    json["file"] = output;
    print_result(options, json_text(json),
                 arguments->csv ? rows_csv(stereo_rows(measurement)) : stereo_report(measurement));
    return ok;
  };
}

}  // namespace gladstone::inline commands
