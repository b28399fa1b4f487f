#pragma once

#include <memory>
#include <string>
#include <vector>

#include "studies/design/branches.h"
#include "studies/sweep/case_runner.h"

namespace gladstone {

/// A number that a simulation gives, with its standard error; NaN: unknown.
struct Estimate {
  double value = std::numeric_limits<double>::quiet_NaN();
  double standard_error = std::numeric_limits<double>::quiet_NaN();
};

/// Shares of Eq. 9's amplitude that a wave of density has left after each cause of loss.
struct WaveShares {
  double wavelength = 0;  ///< [m]
  double cone = 0;        ///< cone of light and dot, by theory averaged over the stop
  double refraction = 0;  ///< rays through an ideal lens
  double lens = 0;        ///< rays through the lens there is
  Estimate measured;      ///< correlation of the images
};

/// A cause of the systematic error, rms over vectors and components [px].
struct SystematicCause {
  std::string name;  ///< of the budget's terms, "window" with the estimator's
  double simulated = 0;
  double predicted = 0;  ///< by formula; 0 where no formula has it
};

/// What the simulated measurement of a bench came to. Systematic is what repeats with other dots, rays and noise have
/// in common, random what changes from one to another.
struct SimulatedBench {
  int columns = 0, rows = 0;  ///< of the camera's middle that was simulated [px]
  std::size_t repeats = 0;
  std::size_t vectors = 0;       ///< that count in every repeat, away from the border
  Estimate random_px;            ///< of a vector of the setup's own medium, per component
  Estimate bias_px;              ///< systematic error against Eq. 9, rms over vectors and components
  double predicted_bias_px = 0;  ///< what cone, dot and window lose of that very field, by formula
  std::vector<SystematicCause> causes;
  double displacement_px = 0;  ///< largest true one
  Estimate peak_electrons;     ///< at the middle of dots' images
  double magnification = 0;    ///< M [1]
  Estimate resolution;         ///< wavelength that the measurement passes with 1/sqrt(2) [m]
  std::vector<WaveShares> waves;
  std::string failed;  ///< why there is nothing of all this; empty: there is
};

/// Of the camera's middle that is simulated, across or down: as many last windows as tell a random error to some per
/// cent, and no more than cost a minute.
inline constexpr int simulated_windows = 12, least_simulated_px = 192, most_simulated_px = 384;
/// Cases that a bench takes: its own medium and two waves, each of them as often as is repeated.
constexpr std::size_t simulated_cases(std::size_t repeats) { return 3 * repeats; }

/// How far apart the vectors of a bench are compared: half a window, since nearer ones tell little more. [px]
int compared_apart_px(Bench<double> const& bench);

/// Renders a bench, correlates and compares it, as a study of three media: the setup's own, and waves of the wavelength
/// that the formulas resolve and of less.
/// @param setup    as applied_setup() writes it
/// @param repeats  of every medium, 2 at least, with other dots, rays and noise
/// @param seed     that theirs derive from
/// @param finished called after every case
/// @throws as CaseRunner::run; what a case cannot have is `failed`
SimulatedBench simulate(std::string const& setup, Bench<double> const& bench, std::size_t repeats, std::uint64_t seed,
                        CaseRunner& runner, std::string const& device, std::function<void()> const& finished);

}  // namespace gladstone
