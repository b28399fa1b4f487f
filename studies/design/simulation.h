#pragma once

#include <string>
#include <vector>

#include "studies/design/branches.h"
#include "studies/sweep/case_runner.h"

namespace gladstone::inline design {

/// A simulated quantity with its standard error; NaN: unknown.
struct Estimate {
  double value = std::numeric_limits<double>::quiet_NaN();
  double standard_error = std::numeric_limits<double>::quiet_NaN();
};

/// Amplitude of a density wave after each cause of loss, relative to the small-angle theory (Eq. 9).
struct WaveShares {
  double wavelength = 0;  ///< [m]
  double cone = 0;        ///< amplitude by the aperture-averaged theory, over light cone and dot [1]
  double refraction = 0;  ///< amplitude by rays through an ideal lens [1]
  double lens = 0;        ///< amplitude by rays through the actual lens [1]
  Estimate measured;      ///< amplitude measured by correlation of the images [1]
};

/// A cause of the systematic error, rms over vectors and components [px].
struct SystematicCause {
  std::string name;  ///< name of the budget's term; "window" includes the estimator
  double simulated = 0;
  double predicted = 0;  ///< error by formula; 0 if no formula exists
};

/// Errors of the simulated measurement of a design. Repeats differ in dots, rays and noise; the systematic error is
/// common to all repeats, the random error differs between them.
struct SimulatedDesign {
  int columns = 0, rows = 0;  ///< size of the simulated central part of the image [px]
  std::size_t repeats = 0;
  std::size_t vectors = 0;       ///< number of vectors that are valid in every repeat and away from the border
  Estimate random_px;            ///< random error per component, for the setup's medium
  Estimate bias_px;              ///< systematic error against Eq. 9, rms over vectors and components [px]
  double predicted_bias_px = 0;  ///< loss by light cone, dot and window for the same field, by formula [px]
  std::vector<SystematicCause> causes;
  double displacement_px = 0;  ///< largest true displacement [px]
  Estimate peak_electrons;     ///< charge at the centre of the dot images [e]
  double magnification = 0;    ///< M [1]
  Estimate resolution;         ///< wavelength at which the measurement has a transfer of 1/sqrt(2) [m]
  std::vector<WaveShares> waves;
  std::string failed;  ///< reason of a failed simulation; empty: successful
};

/// Size of the simulated central part: as many windows of the last pass across and down as determine the random error
/// to a few per cent, within limits on the size so that a simulation takes at most a minute.
inline constexpr int simulated_windows = 12, least_simulated_px = 192, most_simulated_px = 384;
/// Number of cases per design: the setup's medium and two waves, each with all repeats.
constexpr std::size_t simulated_cases(std::size_t repeats) { return 3 * repeats; }

/// Returns the distance between the compared vectors: half a window, since closer vectors are strongly correlated [px].
int compared_apart_px(DesignPoint<double> const& bench);

/// Simulates a design: renders, correlates and compares three media, namely the setup's, and density waves of the
/// wavelength resolved by formula and of a shorter one.
/// @param setup     as returned by applied_setup()
/// @param repeats   number of repeats per medium, at least 2, with different dots, rays and noise
/// @param seed      base seed of the repeats
/// @param finished  called after every case
/// @throws as CaseRunner::run; errors of a case are reported in `failed`
SimulatedDesign simulate(SetupDocument const& setup, DesignPoint<double> const& bench, std::size_t repeats,
                         std::uint64_t seed, CaseRunner& runner, std::string const& device,
                         std::function<void()> const& finished);

}  // namespace gladstone::inline design
