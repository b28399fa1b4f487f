#include "render/scene/field_coverage.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "render/base/units.h"

namespace gladstone::inline scene {
namespace {

constexpr double least_share = 0.1;
// Lengths in metres or micrometres that are read as millimetres are wrong by a factor of 1000. On a logarithmic scale,
// 300 is closer to 1000 than to the factor of ten up to which a field is considered to fit the view.
constexpr double another_unit = 300;

constexpr double noticeable_jump = 0.2;  // discontinuity at a side face as a fraction of the field's range

/// Returns the rms difference between n - 1 on a face of the field and the ambient value.
/// @param axis  axis normal to the face
double face_difference(BuiltMedium const& medium, Bounds<double> const& box, int axis, bool high, double ambient) {
  constexpr int samples = 16;
  int const a = (axis + 1) % 3, b = (axis + 2) % 3;
  auto const between = [&box](int along, double share) {
    return box.low[along] + share * (box.high[along] - box.low[along]);
  };
  double squares = 0;
  for (int i = 0; i < samples; ++i) {
    for (int j = 0; j < samples; ++j) {
      Vec3d place{};
      place[axis] = between(axis, high ? 1 - 1e-9 : 1e-9);  // just inside the field, despite rounding
      place[a] = between(a, (i + 0.5) / samples);
      place[b] = between(b, (j + 0.5) / samples);
      double const seen =
          std::visit([&place](auto const& view) { return view.sample(place).refractivity; }, medium.view);
      squares += (seen - ambient) * (seen - ambient);
    }
  }
  return std::sqrt(squares) / samples;
}

double overlap(double low, double high, double half_view) {
  return std::max(0.0, std::min(high, half_view) - std::max(low, -half_view));
}

}  // namespace

FieldCoverage field_coverage(Bounds<double> const& box, Setup const& setup) {
  double const middle = 0.5 * (box.low.z + box.high.z);
  double const px = setup.camera.pixel_pitch / setup.imaging().magnification * (setup.z_a - middle) / setup.z_b();
  FieldCoverage coverage;
  coverage.field = {box.high.x - box.low.x, box.high.y - box.low.y};
  coverage.view = {setup.camera.columns * px, setup.camera.rows * px};
  coverage.share = overlap(box.low.x, box.high.x, coverage.view.x / 2) *
                   overlap(box.low.y, box.high.y, coverage.view.y / 2) / (coverage.view.x * coverage.view.y);
  coverage.ratio = std::max(coverage.field.x / coverage.view.x, coverage.field.y / coverage.view.y);
  return coverage;
}

std::optional<Warning> FieldCoverage::warning() const {
  bool const endless = !(field.x < unbounded && field.y < unbounded);
  bool const small = share < least_share, huge = !endless && ratio > another_unit;
  if (!small && !huge) return {};
  double const mm = unit::millimetre;
  std::string text = fmt::format(
      "the field is {:.4g} x {:.4g} mm wide and fills {:.2g} % of the {:.4g} x {:.4g} mm of the view at "
      "its position",
      field.x / mm, field.y / mm, 100 * share, view.x / mm, view.y / mm);
  if (huge) {
    text += fmt::format("; with lengths in um, it would be {:.4g} x {:.4g} mm wide", field.x / mm / 1e3,
                        field.y / mm / 1e3);
  } else if (!endless && ratio < 1 / another_unit) {
    text += fmt::format("; with lengths in metres, it would be {:.4g} x {:.4g} mm wide", field.x / mm * 1e3,
                        field.y / mm * 1e3);
  }
  return Warning{WarningCode::implausible, "medium.field", text + "; check medium.field.spacing_mm and center_mm"};
}

std::optional<Warning> side_face_warning(BuiltMedium const& medium, Setup const& setup) {
  if (setup.medium.field.kind != FieldKind::file) return {};
  Bounds<double> const box = std::visit([](auto const& view) { return view.bounds(); }, medium.view);
  double const ambient = setup.medium.ambient_refractivity();
  double const range = std::max(medium.highest, ambient) - std::min(medium.lowest, ambient);
  if (!(range > 0)) return {};
  Vec2d const view = field_coverage(box, setup).view;
  std::string faces;
  double largest = 0;
  for (int axis = 0; axis < 2; ++axis) {
    double const half = (axis == 0 ? view.x : view.y) / 2;
    bool const endless = !(box.high[axis] - box.low[axis] < unbounded);
    for (bool const high : {false, true}) {
      double const face = high ? box.high[axis] : box.low[axis];
      if (endless || !(std::abs(face) < half)) continue;
      double const jump = face_difference(medium, box, axis, high, ambient) / range;
      if (jump <= noticeable_jump) continue;
      largest = std::max(largest, jump);
      faces += fmt::format("{}{} = {:.4g} mm", faces.empty() ? "" : ", ", "xy"[axis], face / unit::millimetre);
    }
  }
  if (faces.empty()) return {};
  return Warning{
      WarningCode::implausible, "medium.field",
      fmt::format("the field ends within the view at {}, where its density differs from medium.ambient_density_kg_m3 "
                  "by up to {:.2g} % of the field's range (rms), so that the images show an edge there; set the "
                  "ambient density to that of the field's border, or, if the field should cover the view, check "
                  "medium.field.axes and spacing_mm (gladstone info field shows how the file is read)",
                  faces, 100 * largest)};
}

}  // namespace gladstone::inline scene
