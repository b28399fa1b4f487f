#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "studies/case.h"
#include "studies/compare.h"

namespace gladstone {

/// A measurement that is made again in simulation: the density that was measured, as the medium of the setup, rendered,
/// correlated and compared.
struct SimulatedTwin {
  Comparison comparison;             ///< of the first repeat
  double random_px = 0;              ///< scatter between repeats
  double systematic_px = 0;          ///< what they share against Eq. 9 of the density put in, rms
  std::vector<std::uint64_t> seeds;  ///< of the repeats
  int columns = 0, rows = 0;         ///< of the camera's middle that was simulated
  std::string failed;                ///< why there is none; empty: there is
};

inline constexpr int most_twin_px = 512;  ///< of the camera, across and down

/// @param density of the vectors' lattice, less the ambient one [kg/m^3]
/// @param spacing of its nodes [m] @param centre its middle, X and Y [m]
SimulatedTwin simulate_twin(CaseSetup const& loaded, Image<double> const& density, double spacing, Vec2d centre,
                            Device device);

}  // namespace gladstone
