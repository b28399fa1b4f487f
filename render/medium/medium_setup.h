#pragma once

#include <array>
#include <optional>
#include <string>
#include <type_traits>

#include "render/base/setup_table.h"
#include "render/base/vec.h"
#include "render/medium/closed_forms.h"
#include "render/medium/trace_medium.h"

namespace gladstone {

/// Where a density comes from: nowhere, a file, or one of the closed forms.
enum class FieldKind { none, file, closed_form };

enum class FieldQuantity { density, refractive_index, refractivity };
enum class FieldInterpolation { cubic_bspline, trilinear };

/// Table [medium.field] of a setup, in SI; only the members of its kind are read.
struct FieldSetup {
  FieldSetup() = default;
  template <class Form>
  requires std::is_constructible_v<ClosedForm<double>, Form> FieldSetup(Form const& closed_form)
      : kind(FieldKind::closed_form), form(closed_form) {}

  FieldKind kind = FieldKind::none;
  // file
  std::string file;
  std::string dataset;
  std::string axes;   ///< world axes in the file's order, the slowest first ("zxy"); empty: as the file has them
  std::string where;  ///< of the key `file`, for messages
  FieldQuantity quantity = FieldQuantity::density;
  double scale = 1.0;            ///< file value times scale = kg/m^3, or a pure number
  std::optional<Vec3d> spacing;  ///< [m]
  Vec3d center{};                ///< [m]
  bool extrude = false;
  std::array<bool, 3> periodic{false, false, false};
  // closed form
  ClosedForm<double> form;  ///< without its slab, which the medium gives: see closed_form_of

  /// Its closed form of that type; null where it is another's, or none.
  template <class Form>
  Form const* closed_form() const {
    return kind == FieldKind::closed_form ? std::get_if<Form>(&form) : nullptr;
  }
};

/// Table [medium] of a setup, in SI.
struct MediumSetup {
  double wavelength = 532e-9;       ///< [m]
  double gladstone_dale = 2.26e-4;  ///< K [m^3/kg]
  double ambient_density = 1.225;   ///< [kg/m^3]
  double thickness = 0.01;          ///< depth along Z: of slabs as given or automatic, of a volume its own [m]
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

/// The field in the slab of its medium. @pre setup.field.kind is closed_form
ClosedForm<double> closed_form_of(MediumSetup const& setup);

/// The medium that the second pulse sees. @pre setup.second_field
MediumSetup at_second_pulse(MediumSetup const& setup);

/// Whether a field is a volume from a file, whose depth does not depend on thickness_mm.
bool has_own_depth(FieldSetup const& field);

/// The radius of a field that fades on its own along Z, so that a slab can be too thin for it [m]; 0 for others.
double radius_along_z(FieldSetup const& field);

/// What medium.thickness_mm = "auto" stands for: 10 mm, and for a plume or a blob, whose displacement a slab about its
/// middle cuts off by erfc(half thickness / radius), at least seven radii, which cut off 7e-7 of it [mm].
double automatic_thickness_mm(FieldSetup const& field);
/// Of a setup's field, or of the second pulse's where that is more.
double automatic_thickness_mm(MediumSetup const& setup);

/// Share of a field's displacement that the faces of its slab cut off [1]: erfc(half thickness / radius) for a plume
/// and a blob, whose density is a Gaussian along Z; 0 for fields that have no size along Z.
double cut_off_share(MediumSetup const& setup);

}  // namespace gladstone
