#pragma once

#include <cstdint>
#include <limits>

#include "render/focused_dots/scene_view.h"
#include "render/scene/ground_truth.h"
#include "render/scene/theory.h"

/// Eq. 9 for a thin lens on the Z axis: of one number, the magnification.
namespace gladstone {

/// What turns integrals along a dot's straight rays into theory; the same for all dots.
struct TheoryModel {
  double step = 0;           ///< [m]
  double lever = 0;          ///< Z_D [m]
  double magnification = 0;  ///< M [1]
  double n0 = 1;             ///< ambient index [1]
  double pitch = 0;          ///< [m]
  double stop_radius = 0;    ///< rays beyond it do not count; 0: chief rays [m]

  /// @param with_lever of the integral [m]; 1 for levered ones @return [px]
  GLADSTONE_HD Vec2<double> displacement(Vec2<double> integral, double with_lever) const {
    return theory_displacement(integral, with_lever, magnification, n0, pitch);
  }
};

/// Along the chief ray of a dot.
template <class Medium>
GLADSTONE_HD GradientIntegral<double> integrate_chief(TheoryModel const& model, SceneView<double> const& view,
                                                      Medium const& medium, std::uint64_t dot) {
  Vec2<double> const centre = view.sources.centre[dot];
  Vec3<double> const start{centre.x, centre.y, view.sources.plane_z};
  return integrate_gradient(
      medium, Ray<double>{start, normalized(Vec3<double>{-centre.x, -centre.y, view.bundle.lens_z - start.z})},
      model.step);
}

/// A dot's average over disc and pupil, ray by ray.
struct ConeSum {
  Vec2<double> levered{};
  double weight = 0;

  template <class Medium>
  GLADSTONE_HD void add(TheoryModel const& model, SceneView<double> const& view, Medium const& medium,
                        std::uint64_t dot, std::uint64_t ray) {
    EmittedRay<double> const emitted = emit(view.sources, view.bundle, dot, ray);
    if (model.stop_radius > 0 && length(emitted.pupil) > model.stop_radius) return;
    add(model, medium, emitted.ray, emitted.weight);
  }
  template <class Medium>
  GLADSTONE_HD void add(TheoryModel const& model, Medium const& medium, Ray<double> const& ray, double ray_weight) {
    levered += ray_weight * integrate_gradient(medium, ray, model.step).levered;
    weight += ray_weight;
  }
};

/// Writes what theory says of a dot.
inline void set_theory(GroundTruth& truth, std::size_t dot, TheoryModel const& model,
                       GradientIntegral<double> const& chief, ConeSum const& cone) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  truth.eq9_px[dot] = model.displacement(chief.plain, model.lever);
  truth.chief_px[dot] = model.displacement(chief.levered, 1.0);
  truth.eq9_cone_px[dot] = cone.weight > 0 ? model.displacement(cone.levered / cone.weight, 1.0) : Vec2d{nan, nan};
}

}  // namespace gladstone
