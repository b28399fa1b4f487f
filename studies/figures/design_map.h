#pragma once

#include <array>
#include <optional>
#include <vector>

#include "studies/design/design_point.h"
#include "studies/design/question.h"
#include "studies/design/recommend.h"
#include "studies/drawing/figure.h"

namespace gladstone::inline figures {

/// f-numbers of the curves.
inline constexpr std::array<double, 8> map_f_numbers{2.8, 4, 5.6, 8, 11, 16, 22, 32};

/// Returns Z_D at a fraction of the map's range, from 0.05 to 4 times Z_A [m].
double map_z_d(DesignPoint<double> const& bench, double fraction);

/// Returns the set-up with another f-number and Z_D and with dot images of the same size.
/// @return nullopt if the dots are too close for an image
std::optional<DesignPoint<double>> design_on_map(DesignPoint<double> const& bench, double f_number, double z_d);

/// Resolution against sensitivity as a function of Z_D for one f-number, with fixed lens and Z_A.
struct DesignCurve {
  double f_number;
  std::vector<double> z_d;          ///< [m]
  std::vector<double> sensitivity;  ///< [px per kg/m^4]
  std::vector<double> resolution;   ///< wavelength of density with a transfer of 1/sqrt(2) [m]
  std::vector<double> cone;         ///< S_eps / (N (1 + M)), equal to the cone diameter by F23 [m]
};

/// Returns curves for the standard f-numbers from f/2.8 to f/32, with Z_D from 0.05 to 4 times Z_A.
std::vector<DesignCurve> design_curves(DesignPoint<double> const& bench);

/// Draws the design map: the curves of design_curves(), the setup as a point, the limit by the light cone alone, and
/// the excluded designs as shaded areas.
/// @param question  requirements and limits of the requested design; null: only the limits of every set-up
Figure make_design_map(DesignPoint<double> const& bench, DesignQuestion const* question);

/// Draws the trade-off of an answer: the best objective against the limit of a requirement.
Figure make_design_front(Recommendation const& answer, Objective objective);

}  // namespace gladstone::inline figures
