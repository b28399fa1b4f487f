#include "studies/case/shared_target.h"

#include <algorithm>
#include <cmath>

#include "render/base/units.h"
#include "render/setup/setup_node.h"

namespace gladstone::inline cases {
namespace {

SetupNode pair(Vec2d numbers) { return setup_array({setup_number(numbers.x), setup_number(numbers.y)}); }

/// Returns width and height of a target centred at `middle` that covers the targets of all cameras [mm].
Vec2d extent_of_all(std::vector<CameraCase> const& cameras, Vec2d middle) {
  Vec2d half{};
  for (CameraCase const& camera : cameras) {
    Setup const& one = camera.loaded.setup;
    Vec2d const off = one.target_centre() - middle, extent = one.target_extent();
    half = {std::max(half.x, std::abs(off.x) + extent.x / 2), std::max(half.y, std::abs(off.y) + extent.y / 2)};
  }
  // round up to whole micrometres, so that the number is independent of its text format
  auto const in_mm = [](double metres) { return std::ceil(metres / unit::micrometre) * 1e-3; };
  return {in_mm(2 * half.x), in_mm(2 * half.y)};
}

/// Sets another camera's dot density so that the number of dots equals the first camera's.
void share_dots(SetupDocument& document, Setup const& first, Setup const& own, Vec2d extent) {
  // the density of the other camera, from which it computes exactly the same number of dots
  double const density = first.dot_count() * 1024.0 * own.pixel_area() / (extent.x * extent.y);
  document.set({"target", "dots_per_32px_window"}, setup_number(density));
}

/// Sets another camera's dot diameter in mm to that of the first camera.
void share_diameter(SetupDocument& document, Setup const& first) {
  if (first.target.dot_diameter_m) return;
  document.remove({"target", "dot_diameter_px"});
  document.set({"target", "dot_diameter_mm"}, setup_number(first.dot_diameter() / unit::millimetre));
}

/// Places the common target of all cameras.
void share_place(std::vector<CameraCase>& cameras, Setup first) {
  Vec2d const middle = first.target.centre_m.value_or(Vec2d{});
  Vec2d const extent_mm =
      first.target.extent_m ? *first.target.extent_m / unit::millimetre : extent_of_all(cameras, middle);
  if (!first.target.extent_m) first.target.extent_m = extent_mm * unit::millimetre;
  for (CameraCase& one : cameras) {
    SetupDocument& document = one.loaded.document;
    TargetSetup const& own = one.loaded.setup.target;
    if (!own.extent_m) document.set({"target", "extent_mm"}, pair(extent_mm));
    if (!own.centre_m) document.set({"target", "center_mm"}, pair(middle));
    if (own.kind == TargetKind::dots) share_dots(document, first, one.loaded.setup, *first.target.extent_m);
  }
}

}  // namespace

void share_target(std::vector<CameraCase>& cameras) {
  Setup const& first = cameras.front().loaded.setup;
  TargetKind const kind = first.target.kind;
  if (kind == TargetKind::lattice) return;  // given in metres, so all cameras already have the same one
  if (kind != TargetKind::image) {
    for (CameraCase& one : cameras) share_diameter(one.loaded.document, first);
  }
  // Points are given in metres, so all cameras already have the same ones.
  if (kind != TargetKind::points) share_place(cameras, first);
  for (CameraCase& one : cameras) one.loaded.setup.target = read_target_setup(one.loaded.document.reread("target"));
}

}  // namespace gladstone::inline cases
