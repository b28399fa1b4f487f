#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "studies/case/case.h"
#include "studies/compare/compare.h"

namespace gladstone::inline report {

/// Simulated repetition of a measurement: the measured density is the medium of the setup, which is rendered,
/// correlated and compared.
struct SimulatedTwin {
  Comparison comparison;             ///< comparison of the first repeat
  double random_px = 0;              ///< scatter between repeats [px]
  double systematic_px = 0;          ///< rms error common to the repeats, relative to Eq. 9 of the given density [px]
  std::vector<std::uint64_t> seeds;  ///< seeds of the repeats
  int columns = 0, rows = 0;         ///< size of the simulated central part of the image [px]
  std::string failed;                ///< reason of a failed simulation; empty: successful
};

inline constexpr int most_twin_px = 512;  ///< maximum width and height of the simulated part [px]

/// Simulates a measurement twice with the given density.
/// @param density  density at the vectors of the lattice, minus the ambient density [kg/m^3]
/// @param spacing  distance between its nodes [m]
/// @param centre   X and Y of its centre [m]
SimulatedTwin simulate_twin(CaseSetup const& loaded, Image<double> const& density, double spacing, Vec2d centre,
                            Backend device);

}  // namespace gladstone::inline report
