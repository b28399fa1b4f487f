#pragma once

#include <algorithm>
#include <cmath>

#include "render/base/units.h"
#include "render/medium/fields/slab.h"
#include "render/setup/setup_table.h"

namespace gladstone::inline medium {

/// Plane density wave rho = rho_0 + A sin(k . x + phase) with the wavevector k in the x-y plane.
template <class T>
struct Sinusoid : Slab<T> {
  static constexpr char const* kind = "sinusoid";
  static constexpr char const* density_key = "amplitude_kg_m3";
  static constexpr char const* length_key = "wavelength_mm";

  T amplitude{};         ///< A [kg/m^3]
  Vec2<T> wavevector{};  ///< 2 pi d / wavelength [1/m]
  T phase{};             ///< [rad]
  T wavelength{};        ///< [m]

  /// Returns a wave. @param direction  direction of the wavevector, unit length
  static Sinusoid wave(T amplitude, T wavelength, Vec2<T> direction = {1, 0}, T phase = 0) {
    return {{}, amplitude, direction * (2 * pi / wavelength), phase, wavelength};
  }
  static Sinusoid read(SetupTable& table) {
    double const amplitude = table.required_number("amplitude_kg_m3");
    double const wavelength = table.required_number("wavelength_mm", Range::positive()) * unit::millimetre;
    auto const given = table.numbers("direction", {1, 0}, 2);
    Vec2d direction{1, 0};
    if (given.size() == 2) direction = {given[0], given[1]};
    double const norm = length(direction);
    if (norm == 0) {
      table.problem("direction", "is zero (a wave needs a direction); use [1, 0] for a wave along X");
    } else {
      direction = direction / norm;
    }
    return wave(amplitude, wavelength, direction, table.number("phase_rad", 0.0));
  }

  GLADSTONE_HD IndexSample<T> sample(Vec3<T> p) const {
    using std::cos;
    using std::sin;
    T const angle = wavevector.x * p.x + wavevector.y * p.y + phase;
    T const slope = amplitude * cos(angle);
    return this->from_density(this->ambient_density + amplitude * sin(angle),
                              {slope * wavevector.x, slope * wavevector.y, T(0)});
  }

  T finest() const { return wavelength / 4; }
  T steepest() const { return this->gladstone_dale * std::abs(amplitude) * 2 * pi / wavelength; }
  /// Returns the largest gradient within the extent: its peak value if the phase passes a multiple of pi there, else
  /// the value at one of the corners.
  T steepest_mean_density(Vec2d half_extent) const {
    T const reach = std::abs(wavevector.x) * half_extent.x + std::abs(wavevector.y) * half_extent.y;
    bool const crest = std::floor((phase + reach) / pi) > std::floor((phase - reach) / pi);
    T const share = crest ? T(1) : std::max(std::abs(std::cos(phase - reach)), std::abs(std::cos(phase + reach)));
    return share * std::abs(amplitude) * 2 * pi / wavelength;
  }
  DensityRange densities(Vec2d) const {
    return {this->ambient_density - std::abs(amplitude), this->ambient_density + std::abs(amplitude)};
  }
};

}  // namespace gladstone::inline medium
