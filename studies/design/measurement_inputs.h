#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "studies/case/case.h"
#include "studies/design/design_point.h"
#include "studies/design/propagation.h"

namespace gladstone::inline design {

/// Uncertainty of a density gradient measured with a setup, by contributions of the inputs.
struct MeasurementUncertainty {
  std::vector<MeasurementInput> inputs;  ///< uncertain inputs; the first one is the displacement
  std::vector<PropagatedResult> results;
  double random_px = 0;  ///< random error of the displacement [px]
  /// amplitude transfer of a wave twice as long as the resolved one [1]; for the remaining loss see
  /// studies/compare/uncorrected_bias.h
  double share_resolved = 0;
  bool traced = false;  ///< whether derivatives were computed by ray tracing
};

/// Computes d ln(displacement per gradient) / d(key) of a setup, in the key's unit, by ray tracing. Uses central
/// differences with a step of a thousandth of the value (of sigma if the value is 0), or one-sided differences if the
/// value is 0 and its sign is restricted. Chief rays, unclipped by any stop, cross a uniform gradient, with the same
/// random numbers on both sides. Returns nullopt if the setup cannot be traced in this way.
std::optional<double> traced_log_derivative(CaseSetup const& loaded, UncertainInput const& input, Renderer& renderer);

/// Returns the inputs of the measurement formula for a displacement [px] measured with a setup.
GradientMeasurement<double> gradient_measurement(Setup const& setup, int window_px, double displacement_px);

/// Converts the setup's uncertain inputs (extracted by extract_uncertain_inputs() before loading) to inputs of the
/// measurement. Those that the formula does not contain, and all inputs of a setup off the optical axis, get
/// derivatives by ray tracing.
std::vector<MeasurementInput> measurement_inputs(CaseSetup const& loaded, std::vector<UncertainInput> const& uncertain,
                                                 Renderer& renderer);

/// Propagates the uncertain inputs of a setup and the random error of a displacement to the density gradient.
/// @param gradient  density gradient to be measured [kg/m^4]
/// @pre the setup is BOS
MeasurementUncertainty measurement_uncertainty(CaseSetup const& loaded, std::vector<UncertainInput> const& uncertain,
                                               DesignPoint<double> const& bench, double gradient, Renderer& renderer);

/// Returns "geometry.z_a_mm and geometry.z_d_mm, -0.8" for every correlated pair.
std::vector<std::string> correlation_texts(std::vector<MeasurementInput> const& inputs);

std::string uncertainty_text(MeasurementUncertainty const& uncertainty);
nlohmann::ordered_json uncertainty_json(MeasurementUncertainty const& uncertainty);

}  // namespace gladstone::inline design
