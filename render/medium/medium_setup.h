#pragma once

#include <array>
#include <optional>
#include <string>

#include "render/base/setup_table.h"
#include "render/base/vec.h"
#include "render/medium/trace_medium.h"

namespace gladstone {

enum class FieldKind { none, file, uniform_gradient, sinusoid, gaussian_plume, gaussian_blob, normal_shock };
/// Whether a field fades on its own along Z, so that a slab can be too thin for it.
constexpr bool has_size_along_z(FieldKind kind) {
  return kind == FieldKind::gaussian_plume || kind == FieldKind::gaussian_blob;
}

enum class FieldQuantity { density, refractive_index, refractivity };
enum class FieldInterpolation { cubic_bspline, trilinear };

/// Table [medium.field] of a setup, in SI; only the members of its kind are read.
struct FieldSetup {
  FieldKind kind = FieldKind::none;
  // file
  std::string file;
  std::string dataset;
  std::string where;  ///< of the key `file`, for messages
  FieldQuantity quantity = FieldQuantity::density;
  double scale = 1.0;            ///< file value times scale = kg/m^3, or a pure number
  std::optional<Vec3d> spacing;  ///< [m]
  Vec3d center{};                ///< [m]
  bool extrude = false;
  std::array<bool, 3> periodic{false, false, false};
  // analytic
  double amplitude = 0;   ///< [kg/m^3]
  double radius = 0;      ///< [m]
  double wavelength = 0;  ///< of the sinusoid [m]
  Vec2d direction{1, 0};
  double phase = 0;  ///< [rad]
  Vec3d gradient{};  ///< [kg/m^4]
  double mach = 1;
  double upstream_density = 0;  ///< [kg/m^3]
  double shock_thickness = 0;   ///< [m]
  double tilt = 0;              ///< [rad]
  double position = 0;          ///< [m]
};

/// Table [medium] of a setup, in SI.
struct MediumSetup {
  double wavelength = 532e-9;       ///< [m]
  double gladstone_dale = 2.26e-4;  ///< K [m^3/kg]
  double ambient_density = 1.225;   ///< [kg/m^3]
  double thickness = 0.01;          ///< of slabs, see automatic_thickness_mm; volumes have their own depth [m]
  bool automatic_thickness = true;  ///< nobody has given it
  FieldInterpolation interpolation = FieldInterpolation::cubic_bspline;
  Integrator integrator = Integrator::rk4;
  Faces faces = Faces::matched;
  std::optional<double> step_mm;  ///< [mm], kept as written; empty: auto
  FieldSetup field;
  std::optional<FieldSetup> second_field;  ///< that PIV's second pulse sees instead

  double ambient_refractivity() const { return gladstone_dale * ambient_density; }
};

MediumSetup read_medium_setup(SetupTable table);

/// The medium that the second pulse sees. @pre setup.second_field
MediumSetup at_second_pulse(MediumSetup const& setup);

/// What medium.thickness_mm = "auto" stands for: 10 mm, and for a plume or a blob, whose displacement a slab about its
/// middle cuts off by erfc(half thickness / radius), at least seven radii, which cut off 7e-7 of it [mm].
double automatic_thickness_mm(FieldSetup const& field);
/// Of a setup's field, or of the second pulse's where that is more.
double automatic_thickness_mm(MediumSetup const& setup);

/// Share of a field's displacement that the faces of its slab cut off [1]: erfc(half thickness / radius) for a plume
/// and a blob, whose density is a Gaussian along Z; 0 for fields that have no size along Z.
double cut_off_share(MediumSetup const& setup);

}  // namespace gladstone
