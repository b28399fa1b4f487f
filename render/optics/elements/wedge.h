#pragma once

#include <cmath>

#include "render/base/units.h"
#include "render/optics/elements/glass_plate.h"

namespace gladstone::inline optics {

/// Wedge prism: plate whose exit face is inclined to its entry face. A thin prism deflects light towards its thick side
/// by (n - 1) times the angle between the faces; at normal incidence on the entry face, the deflection by an angle a is
/// asin(n sin a) - a. The faces are round and end where the thickness of the prism is zero.
struct WedgePrism : GlassPlate {
  static constexpr char const* kind = "wedge";

  Vec2d wedge{};  ///< right-handed rotations of the exit face relative to the entry face about x, then about y [rad]

  static WedgePrism read(SetupTable& table) {
    WedgePrism prism{read_keys(table)};
    prism.wedge = table.quantities("wedge_deg", Vec2d{0, 1 * unit::degree}, unit::degree, {-45, 45});
    return prism;
  }

  bool deflects() const { return !(wedge == Vec2d{}); }

  template <class Add>
  void add_surfaces(Pose<double> const& at, bool fresnel, Add const& add) const {
    Face entry = entry_face(at.moved({0, 0, -thickness / 2}), fresnel);
    Pose<double> const exit = at.moved({0, 0, thickness / 2}).turned({wedge.x, wedge.y, 0});
    double const along = dot(exit.z, at.z);
    if (along < 1) entry.semi_diameter = thickness * along / std::sqrt(1 - along * along);
    add(entry, "first face");
    add(exit_face(exit, fresnel), "second face");
  }
};

}  // namespace gladstone::inline optics
