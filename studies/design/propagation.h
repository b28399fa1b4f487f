#pragma once

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "render/base/units.h"
#include "studies/uncertain_inputs.h"

namespace gladstone {

/// What a density gradient is measured from.
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

/// The measurement as a formula, F6 solved for the gradient: T is double, or a Jet that carries derivatives. In SI,
/// displacements in px.
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
  /// Density gradient, averaged over the thickness: Delta p n0 / (M Z_D K L_z), n0 = 1 + K rho_ambient [kg/m^4].
  T gradient() const {
    using I = GradientInput;
    T const n0 = 1.0 + (*this)[I::gladstone_dale] * (*this)[I::ambient_density];
    return (*this)[I::displacement] * (*this)[I::pixel_pitch] * n0 /
           (magnification() * (*this)[I::z_d] * (*this)[I::gladstone_dale] * (*this)[I::thickness]);
  }
  /// Density that it makes across one window, the step of an integration: the gradient times N_w p / M_A [kg/m^3].
  T density_step() const { return gradient() * density_over_gradient(); }
  T density_over_gradient() const {
    return window_px * (*this)[GradientInput::pixel_pitch] * (*this)[GradientInput::z_a] / (magnification() * z_b());
  }
};

/// An input of the measurement, with what is known of it. In the key's own unit.
struct MeasurementInput {
  std::string key;
  double value = 0, sigma = 0;
  InputDistribution distribution = InputDistribution::normal;
  double degrees_of_freedom = std::numeric_limits<double>::infinity();
  std::optional<GradientInput> enters;  ///< where the formula has it; nothing: it has not
  double unit = 1;                      ///< of the key [SI]
  /// The formula's input goes as this power of the key: 1, or of a wavelength, which is never 0, what K goes as.
  double chain = 1;
  /// d ln(displacement per gradient) / d(key) by tracing, in the key's own unit; nothing: not traced.
  std::optional<double> traced;
  std::vector<InputCorrelation> correlations{};  ///< with other inputs
  /// Where it enters the way from a gradient to the density that it makes across a window, of inputs of a setup that no
  /// formula describes; that way is taken for the bench's.
  std::optional<GradientInput> scales{};
};

/// How an input adds to a result.
struct Contribution {
  double derivative = 0;  ///< d(result) / d(input), the sensitivity coefficient, in the units of both
  double standard = 0;    ///< |derivative| times sigma, in the result's unit
  double share = 0;       ///< of the combined variance, with half of what each correlation adds to it
};

/// A result with its uncertainty, in the words of the GUM (JCGM 100:2008) and, by samples, of its Supplement 1 (JCGM
/// 101:2008).
struct PropagatedResult {
  std::string key;  ///< with its unit as suffix
  double value = 0;
  double standard = 0;                       ///< combined standard uncertainty, first order
  double degrees_of_freedom = 0;             ///< effective, after Welch and Satterthwaite; infinite where all are
  double coverage_factor = 2;                ///< for 95.45 %
  std::vector<Contribution> contributions;   ///< of the inputs, in their order
  std::optional<double> sampled_mean;        ///< nothing where an input has one degree of freedom: it has no mean
  std::optional<double> sampled_standard;    ///< nothing where an input has two of them or fewer: it has no variance
  double sampled_low = 0, sampled_high = 0;  ///< 95.45 % of the samples, as many below as above
  /// The ends of both intervals, the samples' and value -+ k u, agree within half of the first digit of `standard`
  /// (JCGM 101, 8) and what the samples' ends themselves are uncertain by, three standard errors.
  bool linear = true;

  double expanded() const { return coverage_factor * standard; }
};

inline constexpr int propagation_samples = 100'000;

/// Coverage factor of Student's t distribution for 95.45 %, 2 for infinitely many degrees of freedom.
double coverage_factor(double degrees_of_freedom);

/// Propagates the inputs to density gradient and density by exact derivatives (JCGM 100:2008, eq. 16: with covariances)
/// and by samples of what drawn_distribution() says. Degrees of freedom are those of Welch and Satterthwaite; inputs
/// that are correlated, directly or by others, count as one with the fewest of theirs.
/// @param at the values of all inputs of the formula
std::vector<PropagatedResult> propagate(GradientMeasurement<double> const& at,
                                        std::vector<MeasurementInput> const& inputs);

/// What samples of an input are drawn from: "normal"; "t, 4 degrees of freedom", scaled by sigma and shifted to the
/// value (JCGM 101:2008, 6.4.9), of correlated inputs all by one variate of chi squared; "rectangular"; "rectangular,
/// limits inexact", a curvilinear trapezoid (6.4.3) whose half width varies by 1 / sqrt(2 nu) of itself, as sigma does
/// (JCGM 100:2008, G.4.2).
std::string drawn_distribution(std::vector<MeasurementInput> const& inputs, std::size_t input);

/// Relative uncertainty of a gradient that all inputs but the displacement make together, first order: what is the same
/// at all vectors, whatever their displacement.
double common_relative_uncertainty(GradientMeasurement<double> at, std::vector<MeasurementInput> const& inputs);

}  // namespace gladstone
