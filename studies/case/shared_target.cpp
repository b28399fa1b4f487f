#include "studies/case/shared_target.h"

#include <algorithm>
#include <cmath>

#include "render/base/units.h"
#include "render/setup/setup_node.h"

namespace gladstone::inline cases {
namespace {

SetupNode pair(Vec2d numbers) { return setup_array({setup_number(numbers.x), setup_number(numbers.y)}); }

/// Returns width and height of a target centred at `middle` that covers the targets of all cameras [mm].
Vec2d extent_of_all(std::vector<Setup> const& read, Vec2d middle) {
  Vec2d half{};
  for (Setup const& one : read) {
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
  if (SetupNode const* const table = document.find({"target"}); table && table->find("dot_diameter_px")) {
    SetupNode without = *table;
    std::erase_if(without.members, [](SetupMember const& member) { return member.key == "dot_diameter_px"; });
    document.set({"target"}, without);
  }
  document.set({"target", "dot_diameter_mm"}, setup_number(first.dot_diameter() / unit::millimetre));
}

}  // namespace

void share_target(std::vector<CameraCase>& cases, std::vector<Setup> const& read) {
  Setup first = read.front();
  TargetKind const kind = first.target.kind;
  if (kind == TargetKind::lattice) return;  // lattices are defined in metres and so already equal
  if (kind != TargetKind::image) {
    for (CameraCase& one : cases) share_diameter(one.document, first);
  }
  if (kind == TargetKind::points) return;  // positions are defined in metres and so already equal
  Vec2d const middle = first.target.centre_m.value_or(Vec2d{});
  Vec2d const extent_mm =
      first.target.extent_m ? *first.target.extent_m / unit::millimetre : extent_of_all(read, middle);
  if (!first.target.extent_m) first.target.extent_m = extent_mm * unit::millimetre;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    SetupDocument& document = cases[i].document;
    if (!read[i].target.extent_m) document.set({"target", "extent_mm"}, pair(extent_mm));
    if (!read[i].target.centre_m) document.set({"target", "center_mm"}, pair(middle));
    if (kind == TargetKind::dots) share_dots(document, first, read[i], *first.target.extent_m);
  }
}

}  // namespace gladstone::inline cases
