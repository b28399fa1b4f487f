#include "studies/compare/calibration_results.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "render/base/units.h"
#include "render/files/hdf5_axes.h"
#include "render/files/hdf5_file.h"
#include "studies/case/flat_values.h"
#include "studies/case/result_rows.h"
#include "studies/case/warning_json.h"
#include "studies/drawing/draw_figure.h"

namespace gladstone::inline compare {
namespace {

double largest(std::vector<Vec2d> const& residuals) {
  double most = 0;
  for (Vec2d const r : residuals) most = std::max(most, length(r));
  return most;
}

void write_pinhole(Hdf5Writer& file, PinholeFit const& fit, Hdf5Axes& axes) {
  auto const& p = fit.camera.value;
  std::size_t const count = PinholeCamera::count;
  std::vector<double> const matrix{p[0], 0, p[2], 0, p[1], p[3], 0, 0, 1};
  file.write("/pinhole/camera_matrix", std::span<double const>(matrix), {3, 3}, "px",
             "fx, 0, cx; 0, fy, cy; 0, 0, 1, as in OpenCV", "row, column");
  file.write("/pinhole/distortion", std::span(p).subspan(4, 4), {4}, "1", "k1, k2, p1, p2 as in OpenCV", "coefficient");
  file.write("/pinhole/rvec", std::span(p).subspan(8, 3), {3}, "rad",
             "rotation R from the world to the camera (x right, y down, z into the scene), as axis times angle",
             "axis");
  file.write("/pinhole/tvec", std::span(p).subspan(11, 3), {3}, "m", "t of R X + t", "axis");
  file.write("/pinhole/standard_errors", std::span<double const>(fit.standard_error), {count}, "of the parameter",
             "standard errors, from the scatter of the residuals", "fx, fy, cx, cy, k1, k2, p1, p2, rvec, tvec");
  file.write("/pinhole/covariance", std::span<double const>(fit.covariance), {count, count}, "of both parameters",
             "covariance of the parameters", "parameter, parameter");
  file.attribute("/pinhole", "rms_px", fit.rms_px);
  axes.write_numbers("/pinhole/row", 3, "row of the matrix");
  axes.write_numbers("/pinhole/column", 3, "column of the matrix");
  axes.write_numbers("/pinhole/coefficient", 4, "k1, k2, p1, p2");
  axes.write_numbers("/pinhole/parameter", count, "fx, fy, cx, cy, k1, k2, p1, p2, rvec, tvec");
  axes.write_numbers("/pinhole/other_parameter", count, "as parameter");
  axes.name("/pinhole/camera_matrix", {"/pinhole/row", "/pinhole/column"});
  axes.name("/pinhole/distortion", {"/pinhole/coefficient"});
  axes.name("/pinhole/rvec", {"/coordinate"});
  axes.name("/pinhole/tvec", {"/coordinate"});
  axes.name("/pinhole/standard_errors", {"/pinhole/parameter"});
  axes.name("/pinhole/covariance", {"/pinhole/parameter", "/pinhole/other_parameter"});
}

void write_soloff(Hdf5Writer& file, SoloffFit const& fit, Hdf5Axes& axes) {
  SoloffPolynomial const& polynomial = fit.polynomial;
  std::size_t const count = polynomial.exponents.size();
  std::vector<std::int64_t> exponents;
  for (auto const& term : polynomial.exponents) exponents.insert(exponents.end(), term.begin(), term.end());
  file.write("/soloff/exponents", std::span<std::int64_t const>(exponents), {count, 3}, "1",
             "powers of X, Y, Z in every term", "term, (X, Y, Z)");
  file.write("/soloff/coefficients", flat(polynomial.coefficients), {count, 2}, "px / m^(sum of exponents)",
             "pixel = sum of coefficients times X^i Y^j Z^k, in metres (Soloff, Adrian & Liu 1997)",
             "term, (column, row)");
  file.write("/soloff/standard_errors", flat(fit.standard_error), {count, 2}, "px / m^(sum of exponents)",
             "standard errors of the coefficients", "term, (column, row)");
  file.attribute("/soloff", "rms_px", fit.rms_px);
  axes.write_numbers("/soloff/term", count, "number of the term");
  axes.name("/soloff/exponents", {"/soloff/term", "/coordinate"});
  axes.name("/soloff/coefficients", {"/soloff/term", "/component"});
  axes.name("/soloff/standard_errors", {"/soloff/term", "/component"});
}

/// Returns the residuals of one model as arrows.
/// @param enlarged  magnification of the arrows [1]
plot::Panel make_residual_panel(Calibration const& calibration, std::vector<Vec2d> const& residuals, double enlarged) {
  plot::Panel panel{.grid = plot::Grid::both, .equal_scales = true};
  panel.x = {"column [px]", 0, static_cast<double>(calibration.columns)};
  panel.y = {"row [px]", static_cast<double>(calibration.rows), 0};
  panel.legend = {plot::LegendPlace::below, 0, true};
  for (std::size_t plane = 0; plane < calibration.planes.size(); ++plane) {
    plot::Layer arrows{plot::Layer::Kind::arrows,
                       {{}, {}, {}, {}},
                       house_colour(plane),
                       fmt::format("Z = {:.4g} mm", calibration.planes[plane].z / unit::millimetre),
                       1.2};
    for (std::size_t k = 0; k < residuals.size(); ++k) {
      if (calibration.plane_of[k] != plane) continue;
      Vec2d const at = calibration.points.pixel[k];
      arrows.columns[0].push_back(at.x);
      arrows.columns[1].push_back(at.y);
      arrows.columns[2].push_back(enlarged * residuals[k].x);
      arrows.columns[3].push_back(enlarged * residuals[k].y);
    }
    panel.layers.push_back(std::move(arrows));
  }
  return panel;
}

nlohmann::ordered_json strangers_json(CalibratedPlane const& plane) {
  nlohmann::ordered_json places = nlohmann::ordered_json::array();
  for (Vec2d const place : plane.strangers) places.push_back({place.x, place.y});
  return places;
}

/// Returns the parameters of the pinhole camera, each with its fitted value and, if known, the rendered one.
std::vector<ResultGroup> parameter_groups(Calibration const& calibration) {
  PinholeFit const& fit = calibration.pinhole;
  std::vector<ResultGroup> groups;
  for (std::size_t i = 0; i < PinholeCamera::count; ++i) {
    double const value = fit.camera.value[i], error = fit.standard_error[i];
    std::vector<ResultRow> rows{{.key = "value", .label = "fitted", .value = value},
                                {.key = "standard_error", .label = "standard error", .value = error}};
    if (calibration.rendered) {
      double const truth = calibration.rendered->value[i];
      rows.push_back({.key = "rendered", .label = "rendered", .value = truth});
      rows.push_back({.key = "off_by", .label = "off by", .value = (value - truth) / error});
    }
    groups.push_back({fmt::format("{} [{}]", PinholeCamera::names[i], PinholeCamera::units[i]), std::move(rows)});
  }
  return groups;
}

/// Returns e.g. "; excluded spots: 3 by size or shape, 1 by their position on the grid"; empty without such spots.
std::string spots_in_words(CalibratedPlane const& plane) {
  if (plane.not_dots == 0 && plane.strangers.empty()) return "";
  return fmt::format("; excluded spots: {} by size or shape, {} by their position on the grid", plane.not_dots,
                     plane.strangers.size());
}

}  // namespace

void write_calibration_file(std::string const& path, Calibration const& calibration) {
  FileOrigin origin{"gladstone calibration", 1, calibration.setup, calibration.seed, "cpu", calibration.sources};
  Hdf5Writer file(path, origin);
  Hdf5Axes axes(file);
  axes.write_numbers("/component", 2, "column, row; of the grid along X, Y");
  axes.write_numbers("/coordinate", 3, "x, y, z");
  axes.write_numbers("/dots/dot", calibration.points.size(), "number of the dot");
  write_pinhole(file, calibration.pinhole, axes);
  write_soloff(file, calibration.soloff, axes);
  std::size_t const count = calibration.points.size();
  std::vector<double> position;
  std::vector<std::int64_t> plane_of, index;
  for (std::size_t k = 0; k < count; ++k) {
    Vec3d const at = calibration.points.world[k];
    position.insert(position.end(), {at.x, at.y, at.z});
    plane_of.push_back(static_cast<std::int64_t>(calibration.plane_of[k]));
    index.insert(index.end(), calibration.index[k].begin(), calibration.index[k].end());
  }
  file.write("/dots/position_m", std::span<double const>(position), {count, 3}, "m", "dot centres in the world frame",
             "dot, (x, y, z)");
  file.write("/dots/image_px", flat(calibration.points.pixel), {count, 2}, "px", "detected centroids",
             "dot, (column, row)");
  file.write("/dots/plane", std::span<std::int64_t const>(plane_of), {count}, "1", "plane of the dot, from 0", "dot");
  file.write("/dots/index", std::span<std::int64_t const>(index), {count, 2}, "1",
             "grid position relative to the middle of the grid, in spacings along X and Y", "dot, (x, y)");
  file.write("/dots/pinhole_residual_px", flat(calibration.pinhole.residual_px), {count, 2}, "px",
             "detected minus fitted, pinhole", "dot, (column, row)");
  file.write("/dots/soloff_residual_px", flat(calibration.soloff.residual_px), {count, 2}, "px",
             "detected minus fitted, polynomial", "dot, (column, row)");
  axes.name("/dots/position_m", {"/dots/dot", "/coordinate"});
  axes.name("/dots/plane", {"/dots/dot"});
  for (char const* const pairs :
       {"/dots/image_px", "/dots/index", "/dots/pinhole_residual_px", "/dots/soloff_residual_px"})
    axes.name(pairs, {"/dots/dot", "/component"});
  axes.attach();
  file.attribute("/dots", "drift_x", calibration.drift.x);
  file.attribute("/dots", "drift_y", calibration.drift.y);
  file.close();
}

void draw_calibration(std::string const& path, Calibration const& calibration) {
  constexpr double longest_share = 0.06;  // length of the longest arrow, relative to the width of the image
  Figure figure{1180, 620};
  auto const add = [&](std::vector<Vec2d> const& residuals, char const* model, double rms, plot::Box const& box) {
    double const most = largest(residuals);
    double const enlarged =
        most > 0 ? std::pow(10, std::floor(std::log10(longest_share * calibration.columns / most))) : 1;
    figure.panels.push_back(make_residual_panel(calibration, residuals, enlarged));
    figure.panels.back().box = box;
    figure.panels.back().title = fmt::format("{}: {:.3g} px rms, enlarged {:.0f} times", model, rms, enlarged);
  };
  add(calibration.pinhole.residual_px, "pinhole and distortion", calibration.pinhole.rms_px, {76, 570, 40, 534});
  add(calibration.soloff.residual_px, "third-order polynomial", calibration.soloff.rms_px, {666, 1160, 40, 534});
  draw_figure(figure, path);
}

nlohmann::ordered_json calibration_json(Calibration const& calibration) {
  using nlohmann::ordered_json;
  ordered_json planes = ordered_json::array(), pinhole;
  for (CalibratedPlane const& plane : calibration.planes) {
    planes.push_back({{"file", plane.file},
                      {"z_mm", plane.z / unit::millimetre},
                      {"found", plane.found},
                      {"used", plane.used},
                      {"not_dots", plane.not_dots},
                      {"strangers", strangers_json(plane)},
                      {"scatter_px", plane.smoothness_px},
                      {"middle_by", plane.middle_by == CentreDotMethod::whole_grid ? "whole_grid" : "setup"}});
  }
  PinholeFit const& fit = calibration.pinhole;
  std::vector<ResultGroup> const parameters = parameter_groups(calibration);
  for (std::size_t i = 0; i < PinholeCamera::count; ++i) {
    pinhole[PinholeCamera::names[i]] = rows_json(parameters[i].rows);
    pinhole[PinholeCamera::names[i]]["unit"] = PinholeCamera::units[i];
  }
  return {{"dots", calibration.points.size()},
          {"planes", planes},
          {"pinhole", {{"parameters", pinhole}, {"rms_px", fit.rms_px}, {"largest_px", largest(fit.residual_px)}}},
          {"soloff",
           {{"terms", calibration.soloff.polynomial.exponents.size()},
            {"rms_px", calibration.soloff.rms_px},
            {"largest_px", largest(calibration.soloff.residual_px)}}},
          {"drift", {calibration.drift.x, calibration.drift.y}},
          {"warnings", to_strings(calibration.warnings)},
          {"warning_records", calibration.warnings}};
}

std::string calibration_table(Calibration const& calibration) {
  PinholeFit const& fit = calibration.pinhole;
  std::string text = groups_text("", parameter_groups(calibration), 8);
  text +=
      calibration.rendered
          ? "(off by: difference in standard errors)\n"
          : "(no comparison with a rendered camera: your own images have no truth, and the truth of a case contains a "
            "pinhole camera only for an ideal thin lens without windows and without distortion on a tilted sensor)\n";
  for (CalibratedPlane const& plane : calibration.planes) {
    text += fmt::format(
        "Z = {:.6g} mm: {} of {} detected dots are on the grid{}{}\n", plane.z / unit::millimetre, plane.used,
        plane.found,
        plane.middle_by == CentreDotMethod::whole_grid ? "" : ", whose middle was determined from the setup's camera",
        spots_in_words(plane));
  }
  return text + fmt::format(
                    "residuals, rms per component and largest: pinhole {:.3g} and {:.3g} px, polynomial {:.3g} "
                    "and {:.3g} px",
                    fit.rms_px, largest(fit.residual_px), calibration.soloff.rms_px,
                    largest(calibration.soloff.residual_px));
}

}  // namespace gladstone::inline compare
