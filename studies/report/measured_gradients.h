#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "render/base/displacement_field.h"
#include "studies/design/bench.h"

namespace gladstone {

/// Gradients at measured vectors, with what they are uncertain by. Components along X and Y of the world.
struct MeasuredGradients {
  std::vector<Vec2d> gradient;  ///< NaN where a vector does not count [kg/m^4]
  std::vector<Vec2d> random;    ///< standard uncertainty by the displacement's
  std::vector<Vec2d> combined;  ///< with that of the setup's numbers
  std::size_t estimated = 0;    ///< of vectors whose displacement's uncertainty is the estimator's, else the formula's
  double common = 0;            ///< relative, of the setup's numbers
  std::size_t count = 0;        ///< of vectors
};

/// @param common relative uncertainty of the setup's numbers together
MeasuredGradients gradients_of(DisplacementField const& field, Bench<double> const& bench, double common);

/// Both components of all vectors that have them.
std::vector<double> finite_components(std::vector<Vec2d> const& values);

/// NaN of none.
double rms_of(std::vector<double> const& values);

/// Maps of the report, of a lattice: displacement, gradient, its combined uncertainty, and the displacement's part.
nlohmann::json measured_maps(DisplacementField const& field, MeasuredGradients const& all);

/// Displacement, gradient and its combined standard uncertainty on the lattice of the vectors, as a figure. @return
/// path
std::string draw_measured_maps(std::string const& path, DisplacementField const& field, MeasuredGradients const& all);

}  // namespace gladstone
