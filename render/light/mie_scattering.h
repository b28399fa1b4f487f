#pragma once

#include <cmath>
#include <complex>
#include <cstdint>
#include <vector>

#include "render/base/host_device.h"
#include "render/base/pose.h"
#include "render/base/units.h"
#include "render/base/vec.h"

namespace gladstone::inline light {

/// Plane wave incident on a particle.
template <class T>
struct LightWave {
  Vec3<T> propagation{T(1), T(0), T(0)};  ///< direction of propagation, unit vector
  Vec3<T> field{T(0), T(1), T(0)};  ///< direction of the electric field, unit vector perpendicular to the propagation
};

/// Optical properties of a set of spheres and of the incident light, except for its direction.
struct MieSetting {
  std::complex<double> index{1.45, 0};  ///< refractive index of the spheres, n + i k [1]
  double wavelength = 532e-9;           ///< vacuum wavelength [m]
  double surroundings = 1;              ///< refractive index of the surrounding medium [1]
};

/// Interval of scattering angles [rad].
struct AngleInterval {
  double least = 0, most = pi;
};

/// Location of one diameter's data in the table.
struct MieTable {
  std::uint64_t first = 0;  ///< index of the first coefficient; S1 and S2 alternate
  std::uint32_t cells = 0;  ///< number of cells between the ends of the interval
  float cells_per_radian = 0;
};

/// View of the tabulated differential cross-sections of particles, as used by the ray tracer.
template <class T>
struct MieScatteringView {
  std::uint32_t const* table_of = nullptr;  ///< index into `table` of every particle
  MieTable const* table = nullptr;          ///< tables, one per distinct diameter
  float const* coefficient = nullptr;       ///< cubic B-spline coefficients of |S1|^2 and |S2|^2 [1]
  T least_angle{};                          ///< smallest scattering angle of the table [rad]
  T inverse_wave_number2{};                 ///< 1/k^2, k the wave number in the surrounding medium [m^2]

  /// Returns the differential scattering cross-section of a particle in a direction: power per solid angle over
  /// incident power per area, (|S2|^2 cos^2 phi + |S1|^2 sin^2 phi) / k^2, phi the angle between the electric field and
  /// the scattering plane (Bohren & Huffman 1983, sec. 3.3 and 4.4). Scattering angles outside the table are clamped.
  /// @param direction  unit vector away from the particle
  /// @param wave       light that is incident on the particle
  /// @return [m^2/sr]
  GLADSTONE_HD T cross_section(std::uint64_t particle, Vec3<T> direction, LightWave<T> const& wave) const {
    using std::atan2;
    using std::sqrt;
    T const along = dot(direction, wave.field);
    T const across = dot(direction, cross(wave.propagation, wave.field));
    T const along2 = along * along, across2 = across * across;
    T const sine2 = along2 + across2;
    T s1, s2;
    intensities(particle, atan2(sqrt(sine2), dot(direction, wave.propagation)), s1, s2);
    // phi is undefined for forward and backward scattering, where |S1| = |S2|
    T const share = sine2 > T(0) ? along2 / sine2 : T(0);
    return (s1 + (s2 - s1) * share) * inverse_wave_number2;
  }

  /// Computes |S1|^2 and |S2|^2 of a particle at a scattering angle [rad].
  GLADSTONE_HD void intensities(std::uint64_t particle, T angle, T& s1, T& s2) const {
    MieTable const own = table[table_of[particle]];
    T place = (angle - least_angle) * T(own.cells_per_radian);
    place = place > T(0) ? place : T(0);
    std::uint32_t cell = static_cast<std::uint32_t>(place);
    if (cell >= own.cells) cell = own.cells - 1;
    T u = place - T(cell);
    if (u > T(1)) u = T(1);
    T const v = T(1) - u;
    T const w0 = v * v * v / T(6), w3 = u * u * u / T(6);
    T const w1 = T(2) / T(3) - u * u * (T(1) - u / T(2));
    T const w2 = T(1) - w0 - w1 - w3;
    float const* const c = coefficient + own.first + 2 * std::uint64_t{cell};
    s1 = w0 * T(c[0]) + w1 * T(c[2]) + w2 * T(c[4]) + w3 * T(c[6]);
    s2 = w0 * T(c[1]) + w1 * T(c[3]) + w2 * T(c[5]) + w3 * T(c[7]);
    // the spline can undershoot at a zero of |S|^2
    s1 = s1 > T(0) ? s1 : T(0);
    s2 = s2 > T(0) ? s2 : T(0);
  }
};

/// Table of the light scattered by many spheres of one material: |S1|^2 and |S2|^2 of every distinct diameter, over the
/// interval of scattering angles seen by the cameras. The coefficients a_n, b_n are computed exactly for every
/// diameter, since resonances rule out interpolation in diameter. Only the angle is tabulated, by cubic B-splines on
/// nodes spaced according to the angular ripples.
class MieScattering {
 public:
  /// Computes the table on all threads, with a progress bar.
  /// @param diameters  diameters of all particles [m]; equal ones are computed once. A diameter of 0 scatters no light.
  /// @param angles     range of scattering angles
  /// @throws DataError (code `memory`) if the table exceeds the available memory
  /// @pre diameters >= 0, size parameters <= largest_size_parameter; 0 <= angles.least < angles.most <= pi
  MieScattering(std::vector<double> const& diameters, MieSetting const& setting, AngleInterval angles);

  /// Returns the memory required for the table [bytes].
  static double bytes_needed(std::vector<double> const& diameters, MieSetting const& setting, AngleInterval angles);

  MieScatteringView<double> view() const {
    return {table_of_.data(), tables_.data(), coefficients_.data(), angles_.least, 1 / (wave_number_ * wave_number_)};
  }

  /// Largest error of the tabulated |S1|^2 and |S2|^2, relative to their mean over the interval for the same diameter
  /// [1]. Measured midway between all nodes for all diameters.
  double error() const { return error_; }

  /// Data of the view, for copying to a device.
  std::vector<std::uint32_t> const& table_of() const { return table_of_; }
  std::vector<MieTable> const& tables() const { return tables_; }
  std::vector<float> const& coefficients() const { return coefficients_; }

 private:
  AngleInterval angles_;
  double wave_number_;
  double error_ = 0;
  std::vector<std::uint32_t> table_of_;
  std::vector<MieTable> tables_;
  std::vector<float> coefficients_;
};

}  // namespace gladstone::inline light
