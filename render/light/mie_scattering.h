#pragma once

#include <cmath>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "render/base/host_device.h"
#include "render/base/pose.h"
#include "render/base/units.h"
#include "render/base/vec.h"

namespace gladstone {

/// A plane wave that lights a particle.
template <class T>
struct LightWave {
  Vec3<T> propagation{T(1), T(0), T(0)};  ///< unit vector
  Vec3<T> field{T(0), T(1), T(0)};        ///< unit vector of the electric field, across the propagation
};

/// Spheres of one substance in the light of a laser.
struct MieSetting {
  std::complex<double> index{1.45, 0};  ///< of the spheres, n + i k [1]
  double wavelength = 532e-9;           ///< in vacuum [m]
  double surroundings = 1;              ///< refractive index around them [1]
  LightWave<double> wave;
};

/// Angles between a laser's propagation and the directions of scattered light [rad].
struct AngleInterval {
  double least = 0, most = pi;
};

/// What the spheres of one diameter have in the table.
struct MieTable {
  std::uint64_t first = 0;  ///< its first coefficient; that of S2 stands behind each of S1
  std::uint32_t cells = 0;  ///< between the interval's ends
  float cells_per_radian = 0;
};

/// Differential cross-sections of particles, as rays see them: a view that owns nothing.
template <class T>
struct MieScatteringView {
  std::uint32_t const* table_of = nullptr;  ///< of every particle
  MieTable const* table = nullptr;          ///< of every distinct diameter
  float const* coefficient = nullptr;       ///< of cubic B-splines through |S1|^2 and |S2|^2 [1]
  LightWave<T> wave;
  T least_angle{};           ///< scattering angles of the table [rad]
  T most_angle{};            ///< [rad]
  T inverse_wave_number2{};  ///< 1/k^2 in the surroundings [m^2]

  /// Differential scattering cross-section of a particle into a direction: power per solid angle over the wave's power
  /// per area, (|S2|^2 cos^2 phi + |S1|^2 sin^2 phi) / k^2, phi between the electric field and the plane of
  /// propagation and direction (Bohren & Huffman 1983, sec. 3.3 and 4.4).
  /// @param direction unit vector away from the particle. An angle beyond the table's counts as the nearest in it.
  /// @return [m^2/sr]
  GLADSTONE_HD T cross_section(std::uint64_t particle, Vec3<T> direction) const {
    return cross_section(particle, direction, wave);
  }
  /// The same in a wave of the particle's own, where the light of the sheet spreads.
  GLADSTONE_HD T cross_section(std::uint64_t particle, Vec3<T> direction, LightWave<T> const& own) const {
    using std::atan2;
    using std::sqrt;
    T const along = dot(direction, own.field);
    T const across = dot(direction, cross(own.propagation, own.field));
    T const along2 = along * along, across2 = across * across;
    T const sine2 = along2 + across2;
    T s1, s2;
    intensities(particle, atan2(sqrt(sine2), dot(direction, own.propagation)), s1, s2);
    // forward and backward |S1| = |S2|, and phi means nothing
    T const share = sine2 > T(0) ? along2 / sine2 : T(0);
    return (s1 + (s2 - s1) * share) * inverse_wave_number2;
  }

  /// |S1|^2 and |S2|^2 of a particle at a scattering angle [rad].
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
    // between nodes a zero may come out a little below
    s1 = s1 > T(0) ? s1 : T(0);
    s2 = s2 > T(0) ? s2 : T(0);
  }
};

/// Light that many spheres of one substance scatter out of a laser's: |S1|^2 and |S2|^2 of every distinct diameter over
/// the scattering angles that cameras see. Coefficients a_n, b_n are exact for every diameter: resonances defeat any
/// grid over size. Only the angle is tabulated, by cubic B-splines on nodes as dense as the ripples ask for.
class MieScattering {
 public:
  /// Fills the table on all threads, with a progress bar.
  /// @param diameters of all particles [m]; equal ones are computed once. A diameter of 0 scatters nothing.
  /// @param angles that will be asked for
  /// @throws MemoryError where the table is larger than the memory that is left
  /// @pre diameters >= 0, size parameters up to largest_size_parameter; the wave's vectors are unit and square;
  ///      0 <= angles.least < angles.most <= pi
  MieScattering(std::vector<double> const& diameters, MieSetting const& setting, AngleInterval angles);

  /// What the table would take, before it is made [bytes].
  static double bytes_needed(std::vector<double> const& diameters, MieSetting const& setting, AngleInterval angles);

  template <class T>
  MieScatteringView<T> view() const {
    auto const narrow = [](Vec3d v) { return Vec3<T>{T(v.x), T(v.y), T(v.z)}; };
    return {table_of_.data(),
            tables_.data(),
            coefficients_.data(),
            {narrow(setting_.wave.propagation), narrow(setting_.wave.field)},
            T(angles_.least),
            T(angles_.most),
            T(1 / (wave_number_ * wave_number_))};
  }

  /// Largest error of the table, over the mean of |S1|^2 and |S2|^2 of that diameter over the interval, as measured
  /// half-way between all nodes of all diameters [1].
  double error() const { return error_; }
  std::size_t distinct_diameters() const { return tables_.size(); }
  MieSetting const& setting() const { return setting_; }
  AngleInterval angles() const { return angles_; }

  /// What the view points at, for devices.
  std::vector<std::uint32_t> const& table_of() const { return table_of_; }
  std::vector<MieTable> const& tables() const { return tables_; }
  std::vector<float> const& coefficients() const { return coefficients_; }

 private:
  MieSetting setting_;
  AngleInterval angles_;
  double wave_number_;
  double error_ = 0;
  std::vector<std::uint32_t> table_of_;
  std::vector<MieTable> tables_;
  std::vector<float> coefficients_;
};

}  // namespace gladstone
