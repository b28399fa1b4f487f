#include "studies/compare/reconstruct.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "render/base/error.h"
#include "render/files/output_file.h"
#include "studies/case/case_files.h"
#include "studies/case/json_text.h"
#include "studies/commands/arguments.h"
#include "studies/commands/command.h"
#include "studies/compare/density_file.h"
#include "studies/figures/density_figure.h"
#include "studies/figures/gnuplot.h"

namespace gladstone {
namespace {

[[noreturn]] void refuse_value(char const* option, std::string const& expected, std::string const& given) {
  throw SetupError({SetupProblem{option, fmt::format("expected {}, got \"{}\"", expected, given)}});
}

/// Parses finite numbers separated by commas; empty for other text.
std::vector<double> parse_numbers(std::string const& text) {
  std::vector<double> numbers;
  for (std::size_t from = 0; from <= text.size();) {
    std::size_t const end = std::min(text.find(',', from), text.size());
    double number = 0.0;
    auto const [rest, error] = std::from_chars(text.data() + from, text.data() + end, number);
    if (error != std::errc() || rest != text.data() + end || !std::isfinite(number)) return {};
    numbers.push_back(number);
    from = end + 1;
  }
  return numbers;
}

/// Parses "left", "top:3" or "X0,Y0,X1,Y1" in mm. @throws SetupError
ReferenceRegion parse_reference(std::string const& text) {
  using density::GridSide;
  constexpr char const* expected =
      "a side of the image (left, right, top or bottom; left:3 for three columns) or a box X0,Y0,X1,Y1 in mm";
  constexpr std::array<std::pair<std::string_view, GridSide>, 4> sides{
      {{"left", GridSide::left}, {"right", GridSide::right}, {"bottom", GridSide::bottom}, {"top", GridSide::top}}};
  std::size_t const colon = text.find(':');
  for (auto const& [name, side] : sides) {
    if (text.substr(0, colon) != name) continue;
    if (colon == std::string::npos) return {side};
    std::vector<double> const depth = parse_numbers(text.substr(colon + 1));
    if (depth.size() != 1 || !(depth[0] >= 1.0 && depth[0] <= 1e6) || depth[0] != std::floor(depth[0]))
      refuse_value("--reference", expected, text);
    return {side, static_cast<int>(depth[0])};
  }
  std::vector<double> const box = parse_numbers(text);
  if (box.size() != 4) refuse_value("--reference", expected, text);
  return {std::nullopt,
          1,
          {1e-3 * std::min(box[0], box[2]), 1e-3 * std::min(box[1], box[3])},
          {1e-3 * std::max(box[0], box[2]), 1e-3 * std::max(box[1], box[3])}};
}

/// Parses "vertical", "horizontal", "x=1.5" or "y=-2" in mm. @throws SetupError
AxisOption parse_axis(std::string const& text) {
  using density::AxisDirection;
  if (text.empty() || text == "vertical") return {};
  if (text == "horizontal") return {AxisDirection::horizontal, std::nullopt};
  if (text.starts_with("x=") || text.starts_with("y=")) {
    std::vector<double> const position = parse_numbers(text.substr(2));
    if (position.size() == 1)
      return {text[0] == 'x' ? AxisDirection::vertical : AxisDirection::horizontal, 1e-3 * position[0]};
  }
  refuse_value("--axis", "vertical, horizontal, x=MM (vertical axis there) or y=MM (horizontal axis there)", text);
}

/// Draws the figure, or warns if gnuplot is not installed.
void draw_density(std::string const& path, Reconstruction const& reconstruction) {
  try {
    write_density_figure(path, reconstruction);
    spdlog::info("drew {}", path);
  } catch (GnuplotMissing const& missing) {
    spdlog::warn("{}", missing.what());
  }
}

}  // namespace

CommandBody attach_reconstruct(CLI::App& app, GlobalOptions const& options) {
  struct Arguments {
    std::string place, output, conventions, method = "wls", axis, abel = "direct";
    std::vector<std::string> reference;
    ReconstructOptions reconstruct;
    bool axisymmetric = false, no_figures = false;
  };
  auto arguments = std::make_shared<Arguments>();
  ReconstructOptions& reconstruct = arguments->reconstruct;
  app.add_option("case", arguments->place,
                 "Case folder, or with --vectors the setup (TOML) of measured images, whose camera, lens, geometry and "
                 "medium convert displacement to density")
      ->required();
  app.add_option("-o,--output", arguments->output, "File for the density, .h5; the figure has the same name with .png")
      ->required();
  app.add_option("--vectors", reconstruct.vectors, "Vectors of gladstone or another program, default CASE/vectors.h5");
  app.add_option("--conventions", arguments->conventions, "Conventions of that file, see gladstone compare --help");
  app.add_option("--reference", arguments->reference,
                 "Region of known density: left, right, top or bottom side of the vectors (left:3 for three "
                 "columns), or a box X0,Y0,X1,Y1 in mm from the optical axis, x right, y up; may be repeated. Required "
                 "unless --axisymmetric")
      ->allow_extra_args(false);
  app.add_option("--reference-density", reconstruct.reference_density,
                 "Density in the reference region, with --axisymmetric beyond the largest radius [kg/m^3], default "
                 "medium.ambient_density_kg_m3");
  app.add_option("--reference-sigma", reconstruct.reference_sigma,
                 "Standard uncertainty of the reference density [kg/m^3]")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--scale-uncertainty", reconstruct.scale_uncertainty,
                 "Combined relative standard uncertainty of magnification, Z_D, Gladstone-Dale constant, pixel pitch "
                 "and thickness, e.g. 0.01");
  app.add_option("--method", arguments->method, "Integration: wls (weighted least squares) or poisson (no weights)")
      ->check(one_of({"wls", "poisson"}));
  app.add_option("--overlap", reconstruct.overlap,
                 "Overlap of the interrogation windows, 0 to below 1, which correlates the errors of the vectors; "
                 "default: from the last window of [correlate]");
  app.add_option("--deconvolve", reconstruct.deconvolution_gain,
                 "Compensate the averaging over the aperture, amplifying no wave more than this, e.g. 3");
  app.add_flag("--axisymmetric", arguments->axisymmetric, "Abel inversion of an axisymmetric flow");
  app.add_option("--axis", arguments->axis,
                 "Axis of symmetry: vertical or horizontal (its position is determined), x=MM or y=MM; default "
                 "vertical");
  app.add_option("--abel", arguments->abel, "Abel inversion: direct, or tikhonov (regularised)")
      ->check(one_of({"direct", "tikhonov"}));
  app.add_option("--lambda", reconstruct.lambda,
                 "Regularisation parameter of --abel tikhonov, default by cross-validation");
  app.add_option("--samples", reconstruct.samples,
                 "Number of random samples for the uncertainty of more than 4000 nodes, or with --deconvolve")
      ->check(whole_number(10, 100'000));
  app.add_flag("--budget", reconstruct.budget,
               "Split the error of a rendered case into its causes, from the comparison of the vectors with truth and "
               "theory, which is computed unless gladstone compare has stored it");
  app.add_flag("--no-figures", arguments->no_figures, "Draw no figure");
  return [arguments, &options] {
    Backend const device = options.open_device();
    ReconstructOptions reconstruct = arguments->reconstruct;
    for (std::string const& text : arguments->reference) reconstruct.reference.push_back(parse_reference(text));
    if (!arguments->conventions.empty()) reconstruct.conventions = arguments->conventions;
    if (arguments->method == "poisson") reconstruct.method = density::IntegrationMethod::poisson;
    if (arguments->abel == "tikhonov") reconstruct.abel = density::AbelMethod::tikhonov;
    if (arguments->axisymmetric) reconstruct.axis = parse_axis(arguments->axis);
    if (!arguments->axisymmetric && !arguments->axis.empty())
      throw SetupError({SetupProblem{"--axis", "has no effect without --axisymmetric; add that option"}});
    if (reconstruct.lambda && reconstruct.abel != density::AbelMethod::tikhonov)
      throw SetupError({SetupProblem{"--lambda", "has no effect without --abel tikhonov; add that option"}});
    std::string const& output = arguments->output;
    if (!output.ends_with(".h5")) throw OutputError(output, "does not end in .h5; choose such a name");
    std::string const figure = std::filesystem::path(output).replace_extension(".png").string();
    std::vector<std::string> inputs = rendered_files(arguments->place);
    inputs.push_back(arguments->place);
    inputs.push_back(reconstruct.vectors.empty()
                         ? (std::filesystem::path(arguments->place) / case_file::vectors).string()
                         : reconstruct.vectors);
    refuse_inputs_as_outputs({output, figure}, inputs);
    OutputFile const tried(output, "gladstone density");
    Reconstruction const result = reconstruct_case(arguments->place, reconstruct, device);
    write_density(output, result);
    if (!arguments->no_figures) draw_density(figure, result);
    nlohmann::ordered_json json = summarize_reconstruction(result);
    json["file"] = output;
    print_result(options, json_text(json), reconstruction_report(result));
    return ok;
  };
}

}  // namespace gladstone
