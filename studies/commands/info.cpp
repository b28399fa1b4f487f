#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "render/base/error.h"
#include "render/base/vec.h"
#include "render/files/fields/field_file.h"
#include "render/files/image_file.h"
#include "studies/case/image_statistics.h"
#include "studies/case/json_text.h"
#include "studies/commands/arguments.h"
#include "studies/commands/command.h"
#include "studies/commands/field_place.h"
#include "studies/commands/field_statistics.h"
#include "studies/commands/info_lens.h"
#include "studies/commands/info_mie.h"
#include "studies/commands/info_particles.h"

namespace gladstone {
namespace {

nlohmann::json json_of(Vec3d const& values) {
  return {known_or_null(values.x), known_or_null(values.y), known_or_null(values.z)};
}

/// Describes the steepest differences, "steepest difference between neighbours 0.02, 0.05, unknown per unit length
/// along x, y, z".
std::string steepest_text(Vec3d const& steepest, FieldPlace const& place) {
  std::string text;
  bool any = false;
  for (int axis = 0; axis < 3; ++axis) {
    any = any || std::isfinite(place.spacing[axis]);
    text += axis > 0 ? ", " : "";
    text += std::isfinite(steepest[axis]) ? fmt::format("{:.4g}", steepest[axis]) : "unknown";
  }
  return "steepest difference between neighbours " + text + (any ? " per unit length" : "") + " along x, y, z";
}

int describe_field(std::string const& path, std::string const& dataset, std::string const& axes,
                   std::string const& setup, GlobalOptions const& options) {
  auto const source = open_field(path, dataset, 1, axes);
  RegularGrid const& grid = source->grid();
  FieldStatistics const seen = field_statistics(*source);
  FieldPlace const place = field_place(*source, path, dataset, axes, setup);
  Vec3d steepest = seen.steepest;  // per unit length, which is unknown along an axis of undefined spacing
  for (int axis = 0; axis < 3; ++axis) {
    if (std::isnan(place.spacing[axis]) && std::isnan(place.extent_mm[axis])) steepest[axis] = place.spacing[axis];
  }
  FieldReading const& reading = source->reading();
  std::vector<std::string> const notes = source->notes();
  for (std::string const& note : notes) spdlog::warn("{}: {}", path, note);
  if (!place.warning.empty()) spdlog::warn("{}: {}", path, place.warning);
  nlohmann::json const json{
      {"dataset", source->name()},
      {"nodes", {grid.nodes[0], grid.nodes[1], grid.nodes[2]}},
      {"spacing", json_of(place.spacing)},
      {"minimum", seen.minimum},
      {"maximum", seen.maximum},
      {"steepest_gradient", json_of(steepest)},
      {"axes",
       {{"order", reading.axes}, {"by", reading.by}, {"shape", reading.shape}, {"turned_round", reading.turned_round}}},
      {"notes", notes},
      {"units", place.units},
      {"extent_mm", json_of(place.extent_mm)},
      {"coverage", place.coverage}};
  print_result(options, json_text(json),
               fmt::format("{}: {} x {} x {} nodes, {}, values {:.6g} to {:.6g}, {}; {}; {}", source->name(),
                           grid.nodes[0], grid.nodes[1], grid.nodes[2], place.spacing_text, seen.minimum, seen.maximum,
                           steepest_text(steepest, place), reading.text(), place.text));
  return ok;
}

int describe_image(std::string const& path, GlobalOptions const& options) {
  ImageMetadata metadata;
  Image<double> const image = read_image(path, &metadata);
  std::size_t const not_finite = count_not_finite(image);
  if (not_finite == image.size()) {
    throw DataError(path, fmt::format("all of its {} pixels are nan or infinite; export it again", not_finite));
  }
  if (not_finite > 0) {
    spdlog::warn("{}: {} of {} pixels are nan or infinite, and are excluded", path, not_finite, image.size());
  }
  double least = HUGE_VAL, most = -HUGE_VAL;
  for (double const value : image) {
    if (!std::isfinite(value)) continue;
    least = std::min(least, value);
    most = std::max(most, value);
  }
  ImageStatistics const seen = image_statistics(image);
  auto const known = [](double value) {
    return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr);
  };
  nlohmann::json const json{{"columns", image.columns()},
                            {"rows", image.rows()},
                            {"bit_depth", metadata.bit_depth},
                            {"pixel_pitch_um", metadata.pixel_pitch_m * 1e6},
                            {"minimum", least},
                            {"maximum", most},
                            {"mean", seen.mean},
                            {"not_finite", not_finite},
                            {"dot_diameter_px", known(seen.dot_diameter_px)},
                            {"channels", metadata.channels},
                            {"orientation", metadata.orientation},
                            {"background", known(seen.background)},
                            {"dot_height", known(seen.dot_height)},
                            {"noise", known(seen.noise)},
                            {"snr", known(seen.snr())}};
  print_result(
      options, json_text(json),
      fmt::format(
          "{}: {} x {} px, {} bits{}{}, grey levels {:.6g} to {:.6g}, mean {:.6g}, dots {:.2f} px (e^-2), {}", path,
          image.columns(), image.rows(), metadata.bit_depth,
          metadata.channels >= 3 ? ", colour converted to luminance" : "",
          metadata.orientation == 1 ? "" : fmt::format(", Orientation {} rotated upright", metadata.orientation), least,
          most, seen.mean, seen.dot_diameter_px,
          std::isfinite(seen.snr()) ? fmt::format("SNR {:.3g} (dots {:.4g} levels high, noise {:.3g})", seen.snr(),
                                                  seen.dot_height, seen.noise)
                                    : "SNR unknown (no noise or no dots detected)"));
  return ok;
}

}  // namespace

CommandBody attach_info(CLI::App& app, GlobalOptions const& options) {
  struct Arguments {
    std::string kind, file, dataset, axes, setup, figure;
    LensQuestion lens;
    MieQuestion mie;
  };
  auto arguments = std::make_shared<Arguments>();
  app.add_option("kind", arguments->kind, "field, image, lens, mie or particles")
      ->required()
      ->check(one_of({"field", "image", "lens", "mie", "particles"}));
  app.add_option("file", arguments->file, "Input file; for particles a setup, for mie none");
  app.add_option("--dataset", arguments->dataset, "Dataset inside the file");
  app.add_option("--axes", arguments->axes,
                 "World axes in the order of the field's file, the slowest first (\"zxy\"), as medium.field.axes");
  app.add_option("--setup", arguments->setup, "Setup (TOML) for which the filled fraction of the view is reported");
  app.add_option("--glass", arguments->lens.glasses, "Additional glass catalogue (AGF) for info lens");
  app.add_option("--wavelength-nm", arguments->lens.wavelength_nm, "Wavelength for info lens")
      ->check(CLI::Range(100.0, 20000.0));
  app.add_option("--figure", arguments->figure, "Figure of info lens or info mie (.png or .svg)");
  app.add_option("--x", arguments->mie.x, "Size parameter pi d n / lambda of the sphere, for info mie");
  app.add_option("--m", arguments->mie.m,
                 "Refractive index of the sphere relative to its surroundings, for info mie: RE or RE,IM");
  return [arguments, &options] {
    if (arguments->kind == "mie") {
      if (!arguments->file.empty()) throw DataError("info mie", "reads no file; give only --x and --m");
      arguments->mie.figure = arguments->figure;
      return describe_mie(arguments->mie, options);
    }
    if (!arguments->mie.x.empty() || !arguments->mie.m.empty()) {
      throw DataError("info " + arguments->kind, "has no --x and --m (they belong to info mie); remove them");
    }
    if (arguments->file.empty()) throw DataError("info " + arguments->kind, "requires a file; add its name");
    if (arguments->kind == "lens") {
      arguments->lens.file = arguments->file;
      arguments->lens.figure = arguments->figure;
      return describe_lens(arguments->lens, options);
    }
    if (arguments->kind == "particles") return describe_particles(arguments->file, options);
    return arguments->kind == "field"
               ? describe_field(arguments->file, arguments->dataset, arguments->axes, arguments->setup, options)
               : describe_image(arguments->file, options);
  };
}

}  // namespace gladstone
