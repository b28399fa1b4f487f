#pragma once

#include <array>
#include <optional>
#include <string>
#include <type_traits>

#include "render/base/vec.h"
#include "render/medium/closed_forms.h"
#include "render/medium/gas_mixture.h"
#include "render/medium/trace_medium.h"
#include "render/setup/setup_table.h"

namespace gladstone::inline medium {

/// Source of a density field.
enum class FieldKind { none, file, closed_form };

enum class FieldQuantity { density, refractive_index, refractivity };
enum class FieldInterpolation { cubic_bspline, trilinear };

/// Table [medium.field] of a setup, in SI. Only the members that belong to its kind are used.
struct FieldSetup {
  FieldSetup() = default;
  template <class Form>
  requires std::is_constructible_v<ClosedForm<double>, Form> FieldSetup(Form const& closed_form)
      : kind(FieldKind::closed_form), form(closed_form) {}

  FieldKind kind = FieldKind::none;
  // file
  std::string file;
  std::string dataset;
  std::string axes;   ///< world axes in the file's order, slowest first ("zxy"); empty: order defined by the file
  std::string where;  ///< location of the key `file` in the setup, for messages
  FieldQuantity quantity = FieldQuantity::density;
  std::optional<double>
      scale;  ///< factor from file values to kg/m^3, or to an index or refractivity; nullopt: by the file's unit
  std::optional<Vec3d> spacing;  ///< node spacing [m]; empty: as in the file
  Vec3d center{};                ///< world position of the grid's centre [m]
  bool extrude = false;
  std::array<bool, 3> periodic{false, false, false};
  // closed form
  ClosedForm<double> form;  ///< parameters without those of Slab, which come from [medium], see make_closed_form()

  /// Returns the closed form if it has the given type, else null.
  template <class Form>
  Form const* closed_form() const {
    return kind == FieldKind::closed_form ? std::get_if<Form>(&form) : nullptr;
  }
};

/// Table [medium] of a setup, in SI.
struct MediumSetup {
  double wavelength = 532e-9;       ///< vacuum wavelength [m]
  double gladstone_dale = 2.26e-4;  ///< K [m^3/kg]
  std::optional<GasMixture> gas;    ///< mixture that gladstone_dale follows from; empty: given directly
  double ambient_density = 1.225;   ///< [kg/m^3]
  double thickness = 0.01;          ///< depth along Z [m]; of a volume from a file, set when the setup is resolved
  bool automatic_thickness = true;  ///< thickness is determined by automatic_thickness_mm()
  FieldInterpolation interpolation = FieldInterpolation::cubic_bspline;
  Integrator integrator = Integrator::rk4;
  Faces faces = Faces::matched;
  std::optional<double> step_mm;  ///< step size [mm], unit as in the setup; empty: automatic
  FieldSetup field;
  std::optional<FieldSetup> second_field;  ///< field at PIV's second pulse, if it differs from the first

  double ambient_refractivity() const { return gladstone_dale * ambient_density; }
};

MediumSetup read_medium_setup(SetupTable table);

/// Returns the closed form with the slab parameters of its medium. @pre setup.field.kind is closed_form
ClosedForm<double> make_closed_form(MediumSetup const& setup);

/// Returns the setup with the field of the second pulse. @pre setup.second_field has a value
MediumSetup select_second_pulse(MediumSetup const& setup);

/// Returns true if a field is a volume from a file, whose depth does not depend on thickness_mm.
bool has_own_depth(FieldSetup const& field);

/// Returns the radius of a field that decays along Z, to compare with the thickness of the slab [m]; 0 for other
/// fields.
double radius_along_z(FieldSetup const& field);

/// Returns the value of medium.thickness_mm = "auto" [mm]: 10 mm, or seven radii for a plume or blob if that is more.
/// The slab's faces truncate the displacement of these Gaussian fields by a fraction erfc(half thickness / radius),
/// which is 7e-7 at seven radii.
double automatic_thickness_mm(FieldSetup const& field);
/// Returns the larger of the automatic thicknesses of the fields of both pulses [mm].
double automatic_thickness_mm(MediumSetup const& setup);

/// Returns the fraction of a field's displacement that is lost by truncation at the slab's faces [1]: erfc(half
/// thickness / radius) for a plume or blob, whose density is Gaussian along Z; 0 for other fields.
double truncated_fraction(MediumSetup const& setup);

}  // namespace gladstone::inline medium
