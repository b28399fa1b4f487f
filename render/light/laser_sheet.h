#pragma once

#include <array>
#include <cmath>

#include "render/base/host_device.h"
#include "render/base/pose.h"
#include "render/base/setup_table.h"
#include "render/base/units.h"
#include "render/base/vec.h"
#include "render/light/mie_scattering.h"

namespace gladstone {

/// How a sheet's light falls off along its normal.
enum class SheetProfile : int {
  gaussian,  ///< the thickness is the e^-2 full width
  top_hat,   ///< the thickness is the full width
};

/// Table [laser] of a setup, in SI.
struct LaserSetup {
  double wavelength = 532e-9;   ///< in vacuum [m]
  double pulse_energy = 50e-3;  ///< [J]
  Vec3d direction{1, 0, 0};     ///< of propagation at the centre, unit length
  Vec3d normal{0, 0, 1};        ///< of the sheet, unit length, across the direction
  Vec3d centre{};               ///< a point of the sheet's axis, where its height is `height` [m]
  SheetProfile profile = SheetProfile::gaussian;
  double thickness = 1e-3;         ///< [m]
  double height = 40e-3;           ///< at the centre, uniform across it [m]
  double divergence = 0;           ///< full angle that the sheet fans out by in its plane [rad]
  double polarization = 0;         ///< of the electric field out of the sheet's plane, towards the normal [rad]
  std::array<double, 2> offset{};  ///< of the sheet along its normal, at either pulse [m]
  std::array<double, 2> tilt{};    ///< of the sheet about its direction through the centre, right-handed [rad]
};

/// Reads [laser]. @param wavelength where the table names none [m]
LaserSetup read_laser_setup(SetupTable table, double wavelength);

/// A pulsed laser sheet: light that propagates along x of its pose, is uniform over a height along y and falls off
/// along z. With a divergence it fans out of a line, so that a plane square to the axis is lit uniformly everywhere.
template <class T>
struct LaserSheet {
  Pose<T> pose[2];  ///< at either pulse: x direction, y height, z normal
  SheetProfile profile = SheetProfile::gaussian;
  T pulse_energy{};  ///< [J]
  T thickness{};     ///< [m]
  T height{};        ///< at the centre [m]
  T growth{};        ///< of the height along the axis, 2 tan(divergence / 2) [1]
  T cos_polarization = T(1), sin_polarization{};
  T photons_per_joule{};  ///< lambda / (h c) [1/J]

  /// Energy per area across the light's way that a pulse (0 or 1) brings to a point: for a Gaussian profile
  /// E / (h w sqrt(pi/8)) exp(-8 z^2 / w^2), over the cosine of the fan's angle there. [J/m^2]
  GLADSTONE_HD T fluence(Vec3<T> point, int pulse) const {
    using std::exp;
    using std::sqrt;
    Vec3<T> const p = pose[pulse].point_inwards(point);
    T const h = height + p.x * growth;
    if (!(h > T(0)) || p.y + p.y > h || p.y + p.y < -h) return T(0);
    T across;  // [1/m], its integral over z is 1
    if (profile == SheetProfile::gaussian) {
      constexpr double sqrt_pi_over_8 = 0.62665706865775012560;
      T const z = p.z / thickness;
      across = exp(T(-8) * z * z) / (T(sqrt_pi_over_8) * thickness);
    } else {
      across = p.z + p.z > thickness || p.z + p.z < -thickness ? T(0) : T(1) / thickness;
    }
    T const slope = p.y * growth / h;  // tangent of the light's angle to the axis
    return pulse_energy / h * across * sqrt(T(1) + slope * slope);
  }

  /// Photons per area. [1/m^2]
  GLADSTONE_HD T photons(Vec3<T> point, int pulse) const { return fluence(point, pulse) * photons_per_joule; }

  /// The wave at a point of the sheet.
  GLADSTONE_HD LightWave<T> wave(Vec3<T> point, int pulse) const {
    using std::sqrt;
    Vec3<T> const p = pose[pulse].point_inwards(point);
    T const h = height + p.x * growth;
    T const slope = h > T(0) ? p.y * growth / h : T(0);
    T const cosine = T(1) / sqrt(T(1) + slope * slope), sine = slope * cosine;
    return {pose[pulse].direction_outwards({cosine, sine, T(0)}),
            pose[pulse].direction_outwards({-sine * cos_polarization, cosine * cos_polarization, sin_polarization})};
  }
};

template <class T>
LaserSheet<T> laser_sheet(LaserSetup const& setup);

}  // namespace gladstone
