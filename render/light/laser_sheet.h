#pragma once

#include <array>
#include <cmath>

#include "render/base/host_device.h"
#include "render/base/pose.h"
#include "render/base/units.h"
#include "render/base/vec.h"
#include "render/light/mie_scattering.h"
#include "render/setup/setup_table.h"

namespace gladstone::inline light {

/// Intensity profile of a laser sheet along its normal.
enum class SheetProfile : int {
  gaussian,  ///< Gaussian; thickness is the e^-2 full width
  top_hat,   ///< uniform; thickness is the full width
};

/// Table [laser] of a setup, in SI.
struct LaserSetup {
  double wavelength = 532e-9;   ///< vacuum wavelength [m]
  double pulse_energy = 50e-3;  ///< energy of one pulse [J]
  Vec3d direction{1, 0, 0};     ///< propagation direction on the sheet's axis, unit vector
  Vec3d normal{0, 0, 1};        ///< normal of the sheet, unit vector perpendicular to `direction`
  Vec3d centre{};               ///< point on the sheet's axis at which the height is `height` [m]
  SheetProfile profile = SheetProfile::gaussian;
  double thickness = 1e-3;         ///< thickness of the sheet, see SheetProfile [m]
  double height = 40e-3;           ///< height at the centre; the light is uniform over it [m]
  double divergence = 0;           ///< full divergence angle in the plane of the sheet [rad]
  double polarization = 0;         ///< angle of the electric field to the plane of the sheet, towards the normal [rad]
  std::array<double, 2> offset{};  ///< displacement of the sheet along its normal at each pulse [m]
  std::array<double, 2> tilt{};    ///< right-handed rotation about `direction` through the centre at each pulse [rad]
};

/// Reads table [laser]. @param wavelength  default wavelength [m]
LaserSetup read_laser_setup(SetupTable table, double wavelength);

/// Pulsed laser sheet. Light propagates along x of the sheet's pose, is uniform along y and has a profile along z. A
/// diverging sheet fans out from a line; a plane perpendicular to the axis is illuminated uniformly.
template <class T>
struct LaserSheet {
  Pose<T> pose[2];  ///< pose at each pulse: x propagation, y height, z normal
  SheetProfile profile = SheetProfile::gaussian;
  T pulse_energy{};  ///< energy of one pulse [J]
  T thickness{};     ///< thickness, see SheetProfile [m]
  T height{};        ///< height at the centre [m]
  T growth{};        ///< increase of the height per length along the axis, 2 tan(divergence / 2) [1]
  T cos_polarization = T(1), sin_polarization{};
  T photons_per_joule{};  ///< lambda / (h c) [1/J]

  /// Returns the energy per area, perpendicular to the local propagation direction, of a pulse (0 or 1) at a point
  /// [J/m^2]. For a Gaussian profile: E / (h w sqrt(pi/8)) exp(-8 z^2 / w^2) / cos(angle of the light to the axis).
  GLADSTONE_HD T fluence(Vec3<T> point, int pulse) const {
    using std::exp;
    using std::sqrt;
    Vec3<T> const p = pose[pulse].point_to_local(point);
    T const h = height + p.x * growth;
    if (!(h > T(0)) || p.y + p.y > h || p.y + p.y < -h) return T(0);
    T across;  // profile, normalised to an integral over z of one [1/m]
    if (profile == SheetProfile::gaussian) {
      constexpr double sqrt_pi_over_8 = 0.62665706865775012560;
      T const z = p.z / thickness;
      across = exp(T(-8) * z * z) / (T(sqrt_pi_over_8) * thickness);
    } else {
      across = p.z + p.z > thickness || p.z + p.z < -thickness ? T(0) : T(1) / thickness;
    }
    T const slope = p.y * growth / h;  // tangent of the angle of the light to the axis
    return pulse_energy / h * across * sqrt(T(1) + slope * slope);
  }

  /// Returns the photons per area at a point [1/m^2].
  GLADSTONE_HD T photons(Vec3<T> point, int pulse) const { return fluence(point, pulse) * photons_per_joule; }

  /// Returns propagation and polarisation of the light at a point of the sheet.
  GLADSTONE_HD LightWave<T> wave(Vec3<T> point, int pulse) const {
    using std::sqrt;
    Vec3<T> const p = pose[pulse].point_to_local(point);
    T const h = height + p.x * growth;
    T const slope = h > T(0) ? p.y * growth / h : T(0);
    T const cosine = T(1) / sqrt(T(1) + slope * slope), sine = slope * cosine;
    return {pose[pulse].direction_to_outer({cosine, sine, T(0)}),
            pose[pulse].direction_to_outer({-sine * cos_polarization, cosine * cos_polarization, sin_polarization})};
  }
};

LaserSheet<double> laser_sheet(LaserSetup const& setup);

}  // namespace gladstone::inline light
