#include "render/medium/medium_setup.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "render/base/contracts.h"
#include "render/base/units.h"
#include "render/files/fields/field_axes.h"
#include "render/medium/gladstone_dale.h"
#include "render/setup/setup_table.h"

namespace gladstone::inline medium {
namespace {

template <class... Forms>
std::vector<std::string> kind_words(std::variant<Forms...> const*) {
  std::vector<std::string> words{"none", "file"};
  (words.emplace_back(Forms::kind), ...);
  return words;
}

/// Reads the closed form with the given name, if there is one.
template <class... Forms>
void read_form(std::string const& word, SetupTable& table, FieldSetup& field, std::variant<Forms...> const*) {
  auto const read = [&]<class Form>(Form const*) {
    if (word == Form::kind) field = Form::read(table);
  };
  (read(static_cast<Forms const*>(nullptr)), ...);
}

void read_file_field(SetupTable& table, FieldSetup& field) {
  field.file = table.required_path("file");
  field.where = table.where("file");
  if (std::error_code error; !field.file.empty() && !std::filesystem::exists(field.file, error)) {
    table.problem("file",
                  "file not found: " + field.file + "; relative names are resolved against the setup file's folder",
                  ErrorCode::missing_file);
  }
  field.dataset = table.text("dataset", "");
  field.axes = table.text("axes", "");
  if (!field.axes.empty() && !is_axis_order(field.axes)) {
    table.problem("axes",
                  "is not an order of axes; list the axes of the file, slowest first: \"zyx\", or \"yx\" for a plane");
  }
  field.quantity = table.choice("quantity", field.quantity,
                                {{"density", FieldQuantity::density},
                                 {"refractive_index", FieldQuantity::refractive_index},
                                 {"refractivity", FieldQuantity::refractivity}});
  if (table.has("scale")) field.scale = table.number("scale", 1.0);
  if (field.scale == 0) table.problem("scale", "is zero (the field would vanish); use kind = \"none\" for that");
  if (table.has("spacing_mm")) {
    field.spacing = table.quantities("spacing_mm", {1e-3, 1e-3, 1e-3}, unit::millimetre, Range::positive());
  }
  field.center = table.quantities("center_mm", field.center, unit::millimetre);
  field.extrude = table.boolean("extrude", field.extrude);
  auto const periodic = table.booleans("periodic", {false, false, false}, 3);
  for (std::size_t axis = 0; axis < 3 && periodic.size() == 3; ++axis) field.periodic[axis] = periodic[axis];
}

FieldSetup read_field(SetupTable table) {
  constexpr ClosedForm<double> const* forms = nullptr;
  FieldSetup field;
  std::string const word = table.kind_word("kind", "none", kind_words(forms));
  if (word == "file") {
    field.kind = FieldKind::file;
    read_file_field(table, field);
  } else {
    read_form(word, table, field, forms);
  }
  return field;
}

/// Reads the Gladstone-Dale constant, or the mixture of gases that it follows from.
void read_gladstone_dale(SetupTable& table, MediumSetup& setup) {
  if (table.table("gas").present()) {
    table.refuse("gladstone_dale", "conflicts with medium.gas (both set the constant); remove one of them");
    setup.gas = read_gas_mixture(table, setup.wavelength);
    setup.gladstone_dale = setup.gas->gladstone_dale(setup.wavelength);
    return;
  }
  auto const constant =
      table.number_or_word("gladstone_dale", {setup.gladstone_dale, ""}, {"ciddor", "merzkirch"}, Range::positive(1.0));
  if (constant.number) setup.gladstone_dale = *constant.number;
  if (constant.word == "ciddor") setup.gladstone_dale = gladstone_dale_ciddor(setup.wavelength);
  if (constant.word == "merzkirch") setup.gladstone_dale = gladstone_dale_merzkirch(setup.wavelength);
}

}  // namespace

MediumSetup read_medium_setup(SetupTable table) {
  MediumSetup setup;
  setup.wavelength = table.quantity("wavelength_nm", setup.wavelength, unit::nanometre, {230.0, 1690.0, false, false});
  read_gladstone_dale(table, setup);
  setup.ambient_density = table.number("ambient_density_kg_m3", setup.ambient_density, Range::at_least(0.0, 1e4));
  auto const thickness_mm = table.number_or_auto("thickness_mm", Range::positive(1e6));
  setup.interpolation = table.choice(
      "interpolation", setup.interpolation,
      {{"cubic_bspline", FieldInterpolation::cubic_bspline}, {"trilinear", FieldInterpolation::trilinear}});
  setup.integrator =
      table.choice("integrator", setup.integrator,
                   {{"rk4", Integrator::rk4}, {"euler", Integrator::euler}, {"straight", Integrator::straight}});
  setup.step_mm = table.number_or_auto("step_mm", Range::positive());
  setup.faces = table.choice("faces", setup.faces, {{"matched", Faces::matched}, {"refract", Faces::refract}});
  auto fields = table.tables("field");
  if (fields.size() > 1) {
    table.problem("field", "is an array of several fields, which is not available yet (one field per setup); keep one");
    for (std::size_t other = 1; other < fields.size(); ++other) fields[other].suppress_unread_keys();
  }
  setup.field = read_field(fields.empty() ? table.table("field") : fields.front());
  if (SetupTable second = table.table("second_field"); second.present()) setup.second_field = read_field(second);
  setup.automatic_thickness = !thickness_mm;
  setup.thickness = thickness_mm.value_or(automatic_thickness_mm(setup)) * unit::millimetre;
  return setup;
}

MediumSetup select_second_pulse(MediumSetup const& setup) {
  MediumSetup second = setup;
  second.field = *setup.second_field;
  second.second_field.reset();
  return second;
}

ClosedForm<double> make_closed_form(MediumSetup const& setup) {
  GLADSTONE_EXPECTS(setup.field.kind == FieldKind::closed_form);
  ClosedForm<double> whole = setup.field.form;
  std::visit(
      [&setup](Slab<double>& slab) {
        slab = {setup.thickness / 2, setup.gladstone_dale, setup.ambient_density};
      },
      whole);
  return whole;
}

bool has_own_depth(FieldSetup const& field) { return field.kind == FieldKind::file && !field.extrude; }

double radius_along_z(FieldSetup const& field) {
  if (field.kind != FieldKind::closed_form) return 0;
  return std::visit(
      [](auto const& form) {
        if constexpr (requires { form.radius_along_z(); }) return form.radius_along_z();
        return 0.0;
      },
      field.form);
}

double automatic_thickness_mm(MediumSetup const& setup) {
  double const first = automatic_thickness_mm(setup.field);
  return setup.second_field ? std::max(first, automatic_thickness_mm(*setup.second_field)) : first;
}

double automatic_thickness_mm(FieldSetup const& field) {
  constexpr double radii = 7.0;
  // round to a nanometre, to remove conversion errors: the radius was given in mm
  return std::max(10.0, std::round(radii * radius_along_z(field) / unit::nanometre) * 1e-6);
}

double truncated_fraction(MediumSetup const& setup) {
  double const radius = radius_along_z(setup.field);
  return radius > 0 ? std::erfc(setup.thickness / 2 / radius) : 0.0;
}

}  // namespace gladstone::inline medium
