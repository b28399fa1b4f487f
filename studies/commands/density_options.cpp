#include "studies/commands/density_options.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <span>
#include <string_view>
#include <system_error>
#include <utility>

#include "analysis/density/density_methods.h"
#include "render/base/error.h"
#include "studies/commands/arguments.h"

namespace gladstone::inline commands {
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

/// Lists methods with their meaning: "wls (weighted least squares) or poisson (no weights)".
template <class Method>
std::string describe_methods(std::span<Method const> methods) {
  std::string text;
  for (Method const& method : methods)
    text += fmt::format("{}{} ({})", text.empty() ? "" : " or ", method.name, method.meaning);
  return text;
}

}  // namespace

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

void DensityArguments::add_to(CLI::App& app, std::string const& group) {
  auto const add = [&](CLI::Option* option) {
    if (!group.empty()) option->group(group);
    added_.push_back(option);
  };
  add(app.add_option(
             "--reference", reference_,
             "Region of known density: left, right, top or bottom side of the vectors (left:3 for three "
             "columns), or a box X0,Y0,X1,Y1 in mm from the optical axis, x right, y up; may be repeated. Required "
             "unless --axisymmetric")
          ->allow_extra_args(false));
  add(app.add_option("--reference-density", parsed_.reference_density,
                     "Density in the reference region, with --axisymmetric beyond the largest radius [kg/m^3], default "
                     "medium.ambient_density_kg_m3"));
  add(app.add_option("--reference-sigma", parsed_.reference_sigma,
                     "Standard uncertainty of the reference density [kg/m^3]")
          ->check(non_negative_number()));
  add(app.add_option(
      "--scale-uncertainty", parsed_.scale_uncertainty,
      "Combined relative standard uncertainty of magnification, Z_D, Gladstone-Dale constant, pixel pitch "
      "and thickness, e.g. 0.01"));
  add(app.add_option("--method", parsed_.method, "Integration: " + describe_methods(density::integration_methods()))
          ->check(one_of(density::method_names(density::integration_methods()))));
  add(app.add_option("--overlap", parsed_.overlap,
                     "Overlap of the interrogation windows, 0 to below 1, which correlates the errors of the vectors; "
                     "default: from the last window of [correlate]"));
  add(app.add_option(
      "--deconvolve", parsed_.deconvolution_gain,
      "Compensate the averaging over the aperture, with this maximum amplification of any wave, e.g. 3"));
  add(app.add_flag("--axisymmetric", axisymmetric_, "Abel inversion of an axisymmetric flow"));
  add(app.add_option("--axis", axis_,
                     "Axis of symmetry: vertical or horizontal (its position is determined), x=MM or y=MM; default "
                     "vertical"));
  add(app.add_option("--abel", parsed_.abel, "Abel inversion: " + describe_methods(density::abel_methods()))
          ->check(one_of(density::method_names(density::abel_methods()))));
  add(app.add_option("--lambda", parsed_.lambda,
                     "Parameter of a regularised Abel inversion, default by cross-validation"));
  add(app.add_option("--samples", parsed_.samples,
                     "Number of random samples for the uncertainty of more than 4000 nodes, or with --deconvolve")
          ->check(whole_number(10, 100'000)));
}

ReconstructOptions DensityArguments::options() const {
  ReconstructOptions options = parsed_;
  for (std::string const& text : reference_) options.reference.push_back(parse_reference(text));
  if (axisymmetric_) options.axis = parse_axis(axis_);
  if (!axisymmetric_ && !axis_.empty())
    throw DataError(ErrorCode::arguments, "--axis", "has no effect without --axisymmetric; add that option");
  if (options.lambda && !density::abel_method(options.abel).regularized)
    throw DataError(ErrorCode::arguments, "--lambda",
                    fmt::format("has no effect with --abel {}, which is not regularised; remove it, or use another one",
                                options.abel));
  return options;
}

std::vector<std::string> DensityArguments::words() const {
  std::vector<std::string> words;
  for (CLI::Option const* option : added_) {
    bool const is_flag = option->get_expected_max() == 0;
    if (is_flag && option->count() > 0) words.push_back(option->get_name());
    if (is_flag) continue;
    for (std::string const& value : option->results()) words.insert(words.end(), {option->get_name(), value});
  }
  return words;
}

}  // namespace gladstone::inline commands
