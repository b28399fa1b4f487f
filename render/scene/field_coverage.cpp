#include "render/scene/field_coverage.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "render/base/units.h"

namespace gladstone {
namespace {

constexpr double least_share = 0.1;
// Lengths in metres or micrometres, taken for millimetres, are off by 1000; on a logarithmic scale this is nearer to
// that than to a field that fits the view within a factor of ten.
constexpr double another_unit = 300;

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

std::string FieldCoverage::warning() const {
  bool const endless = !(field.x < unbounded && field.y < unbounded);
  bool const small = share < least_share, huge = !endless && ratio > another_unit;
  if (!small && !huge) return {};
  double const mm = unit::millimetre;
  std::string text = fmt::format(
      "medium.field: the field is {:.4g} x {:.4g} mm wide and fills {:.2g} % of the {:.4g} x "
      "{:.4g} mm that are seen where it stands",
      field.x / mm, field.y / mm, 100 * share, view.x / mm, view.y / mm);
  if (huge) {
    text += fmt::format("; were its lengths in um, it would be {:.4g} x {:.4g} mm wide", field.x / mm / 1e3,
                        field.y / mm / 1e3);
  } else if (!endless && ratio < 1 / another_unit) {
    text += fmt::format("; were its lengths in metres, it would be {:.4g} x {:.4g} mm wide", field.x / mm * 1e3,
                        field.y / mm * 1e3);
  }
  return text + "; check medium.field.spacing_mm and center_mm";
}

}  // namespace gladstone
