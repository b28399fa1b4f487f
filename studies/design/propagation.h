#pragma once

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "render/base/units.h"
#include "studies/case/uncertain_inputs.h"

namespace gladstone::inline design {

/// Inputs from which a density gradient is computed.
enum class GradientInput {
  displacement,
  pixel_pitch,
  focal_length,
  z_a,
  z_d,
  gladstone_dale,
  thickness,
  ambient_density
};
inline constexpr std::size_t gradient_inputs = 8;

/// Measurement formula: F6 solved for the gradient. T is double, or a Jet for derivatives. In SI, displacements in px.
template <class T>
struct GradientMeasurement {
  std::array<T, gradient_inputs> value;
  double window_px = 32;

  T const& operator[](GradientInput input) const { return value[static_cast<std::size_t>(input)]; }
  T& operator[](GradientInput input) { return value[static_cast<std::size_t>(input)]; }
  T z_b() const { return (*this)[GradientInput::z_a] + (*this)[GradientInput::z_d]; }
  T magnification() const {
    return (*this)[GradientInput::focal_length] / (z_b() - (*this)[GradientInput::focal_length]);
  }
  /// Returns the density gradient averaged over the thickness, Delta p n0 / (M Z_D K L_z), n0 = 1 + K rho_ambient
  /// [kg/m^4].
  T gradient() const {
    using I = GradientInput;
    T const n0 = 1.0 + (*this)[I::gladstone_dale] * (*this)[I::ambient_density];
    return (*this)[I::displacement] * (*this)[I::pixel_pitch] * n0 /
           (magnification() * (*this)[I::z_d] * (*this)[I::gladstone_dale] * (*this)[I::thickness]);
  }
  /// Returns the density difference across one interrogation window, the step of an integration: gradient times N_w p /
  /// M_A [kg/m^3].
  T density_step() const { return gradient() * density_over_gradient(); }
  /// Returns the width of an interrogation window in the medium [m].
  T density_over_gradient() const {
    return window_px * (*this)[GradientInput::pixel_pitch] * (*this)[GradientInput::z_a] / (magnification() * z_b());
  }
};

/// An uncertain input of the measurement, in the unit of its key.
struct MeasurementInput {
  std::string key;
  double value = 0, sigma = 0;
  InputDistribution distribution = InputDistribution::normal;
  double degrees_of_freedom = std::numeric_limits<double>::infinity();
  /// corresponding input of the formula; empty if the formula does not contain it
  std::optional<GradientInput> enters;
  double unit = 1;  ///< value of the key's unit in SI
  /// Exponent of the key in the formula's input: 1; for a wavelength (never 0), the exponent with which K depends on
  /// it.
  double chain = 1;
  /// d ln(displacement per gradient) / d(key) by ray tracing, in the key's unit; empty: not traced.
  std::optional<double> traced;
  std::vector<InputCorrelation> correlations{};  ///< correlations with other inputs
  /// Input through which the key affects the conversion from gradient to density difference across a window, for setups
  /// that the closed forms do not describe; that conversion is assumed to be the one on the optical axis.
  std::optional<GradientInput> scales{};
};

/// Contribution of an input to the uncertainty of a result.
struct Contribution {
  double derivative = 0;  ///< sensitivity coefficient d(result) / d(input), in the units of both
  double standard = 0;    ///< |derivative| times sigma, in the result's unit
  double share = 0;       ///< fraction of the combined variance, including half of each covariance term
};

/// A result with its uncertainty, in the terms of the GUM (JCGM 100:2008) and, for samples, of its Supplement 1 (JCGM
/// 101:2008).
struct PropagatedResult {
  std::string key;  ///< name with the unit as suffix
  double value = 0;
  double standard = 0;  ///< combined standard uncertainty, to first order
  /// effective degrees of freedom (Welch-Satterthwaite formula); infinite if every input has infinitely many
  double degrees_of_freedom = 0;
  double coverage_factor = 2;               ///< coverage factor for 95.45 %
  std::vector<Contribution> contributions;  ///< contributions of the inputs, in their order
  /// mean of the samples; empty if an input has one degree of freedom, since its mean does not exist
  std::optional<double> sampled_mean;
  /// standard deviation of the samples; empty if an input has at most two degrees of freedom, since its variance does
  /// not exist
  std::optional<double> sampled_standard;
  double sampled_low = 0, sampled_high = 0;  ///< interval of 95.45 % of the samples, with equal tails
  /// True if the limits of the sampled interval agree with value -+ k u within half of the first digit of `standard`
  /// (JCGM 101:2008, 8) plus three standard errors of the sampled limits.
  bool linear = true;

  double expanded() const { return coverage_factor * standard; }
};

inline constexpr int propagation_samples = 100'000;

/// Returns the coverage factor of Student's t distribution for 95.45 %; 2 for infinitely many degrees of freedom.
double coverage_factor(double degrees_of_freedom);

/// Propagates the inputs to density gradient and density difference by exact derivatives (JCGM 100:2008, eq. 16, with
/// covariances) and by samples from drawn_distribution(). Degrees of freedom follow from the Welch-Satterthwaite
/// formula; a group of correlated inputs counts as one, with the smallest degrees of freedom of its members.
/// @param at  values of all inputs of the formula
std::vector<PropagatedResult> propagate(GradientMeasurement<double> const& at,
                                        std::vector<MeasurementInput> const& inputs);

/// Returns the relative uncertainty of a gradient from all inputs except the displacement, to first order; it is common
/// to all vectors.
double common_relative_uncertainty(GradientMeasurement<double> at, std::vector<MeasurementInput> const& inputs);

}  // namespace gladstone::inline design
