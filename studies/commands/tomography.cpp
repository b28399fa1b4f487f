#include "studies/compare/tomography.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "render/base/error.h"
#include "render/base/units.h"
#include "render/files/output_file.h"
#include "studies/case/backend.h"
#include "studies/case/case_files.h"
#include "studies/case/json_text.h"
#include "studies/commands/arguments.h"
#include "studies/commands/command.h"
#include "studies/commands/density_options.h"
#include "studies/commands/volume_options.h"
#include "studies/compare/density_table.h"
#include "studies/compare/tomography_file.h"
#include "studies/compare/tomography_plan.h"
#include "studies/drawing/draw_figure.h"
#include "studies/figures/draw_or_warn.h"
#include "studies/figures/tomography_figure.h"

namespace gladstone::inline commands {
namespace {

namespace fs = std::filesystem;

/// Arguments of the command as they were given.
struct TomographyArguments {
  TomographyOptions tomography;
  std::string output, conventions, support;
  std::vector<std::string> reference;
  std::vector<double> angles_deg, bounds_mm;
  std::optional<double> spacing_mm;
  std::optional<int> views;
  double arc_deg = 180.0;
  bool no_figures = false, csv = false;
};

void add_input_options(CLI::App& app, TomographyArguments& given) {
  app.add_option(
         "views", given.tomography.views,
         "Case folder of each view, 3 to 16; with --vectors the setup (TOML) of each view; with --views one setup")
      ->required();
  app.add_option("-o,--output", given.output,
                 "File for the density, .h5, .nc, .vti, .mat or .csv; the figure has the same name with .png. With "
                 "--views: folder")
      ->required();
  app.add_option("--vectors", given.tomography.vectors, "Vectors of each view, default CASE/vectors.h5")->expected(-1);
  app.add_flag("--ray-truth", given.tomography.ray_truth, "Use the true displacement of the dots of rendered cases");
  app.add_option("--conventions", given.conventions, "Conventions of the vectors, see gladstone compare --help");
  app.add_option("--angles", given.angles_deg,
                 "Angle of the volume about Y in each view [deg], separated by commas; default of view i: i times "
                 "--arc, divided by the number of views")
      ->delimiter(',');
  app.add_option("--arc", given.arc_deg, "Range of the default angles [deg]")->capture_default_str();
  app.add_option("--reference", given.reference,
                 "Region of the views whose lines of sight meet the reference density only: left, right, top or bottom "
                 "side of the vectors (left:3 for three columns), or a box X0,Y0,X1,Y1 in mm from the optical axis, x "
                 "right, y up; may be repeated")
      ->allow_extra_args(false);
  app.add_option("--reference-density", given.tomography.reference_density,
                 "Density in this region and outside of the volume [kg/m^3], default medium.ambient_density_kg_m3");
  app.add_option(
         "--views", given.views,
         "Write this number of setups that view the field of one setup from different directions; no reconstruction")
      ->check(whole_number(3, 16));
}

void add_volume_options(CLI::App& app, TomographyArguments& given) {
  app.add_option("--bounds", given.bounds_mm,
                 "Corners X0,Y0,Z0,X1,Y1,Z1 of the volume [mm], default: the part that all views see")
      ->delimiter(',')
      ->expected(6);
  app.add_option("--spacing", given.spacing_mm, "Distance between the nodes [mm], default: that of the vectors")
      ->check(positive_number());
  app.add_option("--support", given.support,
                 "Part of the volume outside of which the density is the reference density: sphere:MM about its origin "
                 "or cylinder:MM about its Y axis, with the radius");
  app.add_option("--least-density", given.tomography.least_density, "Lower bound of the density [kg/m^3]")
      ->capture_default_str();
  app.add_option("--largest-density", given.tomography.largest_density,
                 "Upper bound of the density [kg/m^3], default: none");
  tomography::SartSettings& sart = given.tomography.sart;
  app.add_option("--iterations", sart.iterations,
                 "Largest number of sweeps over all views, fewer if the volume no longer changes (--tolerance)")
      ->capture_default_str()
      ->check(whole_number(1, 10'000));
  app.add_option("--tolerance", sart.tolerance,
                 "End after a sweep that changes the volume by less than this fraction of its norm")
      ->capture_default_str()
      ->check(non_negative_number());
  app.add_option("--relaxation", sart.relaxation, "Fraction of the correction that is applied after each view, 0 to 2")
      ->capture_default_str();
  app.add_option(
         "--tv-weight", sart.tv_weight,
         "Strength of the total variation, relative to the largest density difference; 0: none; default: the rms "
         "change of a node by the views in each sweep")
      ->check(non_negative_number());
  app.add_flag("--no-figures", given.no_figures, "Draw no figure");
  app.add_flag("--csv", given.csv, csv_help);
}

TomographyOptions convert_arguments(TomographyArguments const& given) {
  TomographyOptions options = given.tomography;
  if (!given.conventions.empty()) options.conventions = given.conventions;
  for (double const angle : given.angles_deg) options.angles.push_back(angle * unit::degree);
  options.arc = given.arc_deg * unit::degree;
  for (std::string const& text : given.reference) options.reference.push_back(parse_reference(text));
  if (given.bounds_mm.size() == 6) {
    std::vector<double> const& mm = given.bounds_mm;
    options.bounds = {unit::mm * Vec3d{mm[0], mm[1], mm[2]}, unit::mm * Vec3d{mm[3], mm[4], mm[5]}};
  }
  if (given.spacing_mm) options.spacing = *given.spacing_mm * unit::mm;
  if (!given.support.empty()) options.support = parse_support(given.support);
  return options;
}

/// Draws the figure, or warns if gnuplot is not installed.
void draw_tomography(std::string const& path, Tomography const& result) {
  if (draw_or_warn([&] { draw_figure(make_tomography_figure(result), path); })) spdlog::info("drew {}", path);
}

/// Writes the setups of --views.
int plan_views(TomographyArguments const& given, GlobalOptions const& options) {
  if (given.tomography.views.size() != 1)
    throw DataError(ErrorCode::arguments, "--views",
                    fmt::format("expected one setup, got {}", given.tomography.views.size()));
  std::error_code error;
  fs::create_directories(given.output, error);
  if (error) throw OutputError(given.output, "cannot be created: " + error.message());
  TomographyPlan const plan{given.tomography.views.front(), *given.views, given.arc_deg * unit::degree};
  std::vector<std::string> const setups = write_tomography_setups(plan, given.output);
  print_result(options, json_text(nlohmann::ordered_json{{"setups", setups}}),
               fmt::format("{}: setups of {} views, {:.4g} degrees apart; render and correlate each of them",
                           given.output, setups.size(), given.arc_deg / static_cast<double>(setups.size())));
  return ok;
}

std::vector<std::string> list_tomography_inputs(TomographyOptions const& options) {
  std::vector<std::string> inputs = options.vectors;
  for (std::string const& place : options.views) {
    inputs.push_back(place);
    for (std::string const& file : rendered_files(place)) inputs.push_back(file);
    inputs.push_back((fs::path(place) / case_file::vectors).string());
  }
  return inputs;
}

}  // namespace

CommandBody attach_tomography(CLI::App& app, GlobalOptions const& options) {
  auto arguments = std::make_shared<TomographyArguments>();
  add_input_options(app, *arguments);
  add_volume_options(app, *arguments);
  return [arguments, &options] {
    if (arguments->views) return plan_views(*arguments, options);
    TomographyOptions const tomography = convert_arguments(*arguments);
    std::string const& output = arguments->output;
    require_density_ending(output);
    std::string const figure = fs::path(output).replace_extension(".png").string();
    refuse_inputs_as_outputs({output, figure}, list_tomography_inputs(tomography));
    auto const make_volume = open_volume_device(options.device);
    OutputFile const tried(output, "gladstone tomography");
    Tomography const result = reconstruct_views(tomography, make_volume);
    write_tomography(output, result);
    if (!arguments->no_figures) draw_tomography(figure, result);
    nlohmann::ordered_json json = summarize_tomography(result);
    json["file"] = output;
    print_result(options, json_text(json),
                 arguments->csv ? rows_csv(tomography_rows(result)) : tomography_report(result));
    return static_cast<int>(ok);
  };
}

}  // namespace gladstone::inline commands
