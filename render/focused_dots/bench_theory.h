#pragma once

#include "render/focused_dots/dot_model.h"
#include "render/scene/theory.h"

/// Small-angle theory (Eq. 9) for a thin lens on the Z axis, for which the projection is a single magnification.
namespace gladstone::inline focused_dots {

/// Parameters that convert integrals along a dot's straight rays to theoretical displacements; the same for all dots.
struct TheoryModel {
  double step = 0;           ///< maximum panel length of the quadrature [m]
  double lever = 0;          ///< Z_D [m]
  double magnification = 0;  ///< M [1]
  double n0 = 1;             ///< ambient index [1]
  double pitch = 0;          ///< pixel pitch [m]

  /// @param with_lever  lever of the integral [m]; 1 for integrals that include the lever
  /// @return displacement [px]
  GLADSTONE_HD Vec2d displacement(Vec2d integral, double with_lever) const {
    return theory_displacement(integral, with_lever, magnification, n0, pitch);
  }
};

/// Weighted sums over a dot's area and the stop, for the aperture average.
struct ConeSum {
  Vec2d lever_weighted{};
  double weight = 0;

  GLADSTONE_HD ConeSum& operator+=(ConeSum const& o) {
    lever_weighted += o.lever_weighted;
    weight += o.weight;
    return *this;
  }
};

/// Integrals from which the theoretical displacements of one dot follow.
struct DotTheory {
  GradientIntegral<double> along;  ///< integral along the chief ray
  ConeSum cone;
};

/// Integrates the gradient along a dot's chief ray and along the straight rays of its light cone, at the nodes of the
/// cone rule for every point of the source rule, by a group of lanes.
/// @return the integrals, valid on lane 0
template <class Group, class Medium>
GLADSTONE_HD DotTheory integrate_theory(Group const& group, DotModel const& model, TheoryModel const& theory,
                                        Medium const& medium, Vec2d centre) {
  DotTheory found;
  ConeSum sum;
  for (int i = group.lane(); i < model.cone.count * model.places.count; i += group.size()) {
    group.poll();
    int const place = i / model.cone.count;
    ConePoint const at = model.cone.points[i % model.cone.count];
    Ray<double> const ray =
        model.bench.straight_ray(centre + model.offset(model.places.places[place]),
                                 (at.radius * model.stop_radius) * model.cone.directions[at.direction]);
    double const cosine2 = ray.direction.z * ray.direction.z;
    double const weight = model.places.weights[place] * at.weight * cosine2 * cosine2;
    sum += {weight * integrate_gradient(medium, ray, theory.step).lever_weighted, weight};
  }
  found.cone = group.sum(sum);
  if (group.lane() == 0) found.along = integrate_gradient(medium, model.bench.straight_ray(centre, {}), theory.step);
  return found;
}

/// Stores the theoretical displacements of a dot.
inline void set_theory(GroundTruth& truth, std::size_t dot, TheoryModel const& theory, DotTheory const& found) {
  truth.eq9_px[dot] = theory.displacement(found.along.plain, theory.lever);
  truth.chief_px[dot] = theory.displacement(found.along.lever_weighted, 1.0);
  truth.eq9_cone_px[dot] = theory.displacement(found.cone.lever_weighted / found.cone.weight, 1.0);
}

}  // namespace gladstone::inline focused_dots
