#pragma once

#include "render/optics/elements/glass_plate.h"

namespace gladstone::inline optics {

/// Plane-parallel plate: optical window, beam splitter or filter.
struct OpticalWindow : GlassPlate {
  static constexpr char const* kind = "window";
  static constexpr char const* root_table = "window";

  static OpticalWindow read(SetupTable& table) { return {read_keys(table)}; }

  template <class Add>
  void add_surfaces(Pose<double> const& at, bool fresnel, Add const& add) const {
    add(entry_face(at.moved({0, 0, -thickness / 2}), fresnel), "first face");
    add(exit_face(at.moved({0, 0, thickness / 2}), fresnel), "second face");
  }
};

}  // namespace gladstone::inline optics
