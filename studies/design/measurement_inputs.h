#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "studies/case.h"
#include "studies/design/bench.h"
#include "studies/design/propagation.h"

namespace gladstone {

/// What a density gradient measured with a setup is uncertain by: the sheet's part about inputs.
struct MeasurementUncertainty {
  std::vector<MeasurementInput> inputs;  ///< the displacement first
  std::vector<PropagatedResult> results;
  double random_px = 0;  ///< of the displacement
  double share_resolved =
      0;                ///< of a wave twice as long as the resolved one that is left; the rest: uncorrected_bias.h
  bool traced = false;  ///< whether rays were traced for the derivatives
};

/// d ln(displacement per gradient) / d(key) of a setup, in the key's own unit: central differences over twice a
/// thousandth of the value (of sigma where the value is 0), of chief rays that no stop clips, through a uniform
/// gradient, with the same random numbers on both sides; from one side where the value is 0 and cannot have either
/// sign. Nothing where the setup cannot be traced so.
std::optional<double> traced_log_derivative(CaseSetup const& loaded, UncertainInput const& input, Renderer& renderer);

/// The formula's values for a displacement [px] that a setup measures.
GradientMeasurement<double> gradient_measurement(Setup const& setup, int window_px, double displacement_px);

/// Inputs of a setup that were written with their uncertainty (take_uncertain_inputs() before it was loaded), as the
/// measurement has them; those that the formula does not have, and off the bench all, by tracing.
std::vector<MeasurementInput> measurement_inputs(CaseSetup const& loaded, std::vector<UncertainInput> const& uncertain,
                                                 Renderer& renderer);

/// Propagates the inputs of a setup that are written with their uncertainty, and the random error of a displacement, to
/// the density gradient that makes it.
/// @param gradient that is measured [kg/m^4]
/// @pre BOS
MeasurementUncertainty measurement_uncertainty(CaseSetup const& loaded, std::vector<UncertainInput> const& uncertain,
                                               Bench<double> const& bench, double gradient, Renderer& renderer);

/// "geometry.z_a_mm and geometry.z_d_mm, -0.8" of every pair that is correlated.
std::vector<std::string> correlation_texts(std::vector<MeasurementInput> const& inputs);

std::string uncertainty_text(MeasurementUncertainty const& uncertainty);
nlohmann::ordered_json uncertainty_json(MeasurementUncertainty const& uncertainty);

}  // namespace gladstone
