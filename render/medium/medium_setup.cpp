#include "render/medium/medium_setup.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "render/base/units.h"
#include "render/medium/gladstone_dale.h"

namespace gladstone {
namespace {

Vec3d three(std::vector<double> const& values, double unit_size) {
  return values.size() == 3 ? Vec3d{values[0], values[1], values[2]} * unit_size : Vec3d{};
}

void read_file_field(SetupTable& table, FieldSetup& field) {
  field.file = table.required_path("file");
  field.where = table.where("file");
  if (std::error_code error; !field.file.empty() && !std::filesystem::exists(field.file, error)) {
    table.problem("file", "there is no file " + field.file + "; relative names start at the setup file's folder");
  }
  field.dataset = table.text("dataset", "");
  std::string const quantity = table.word("quantity", "density", {"density", "refractive_index", "refractivity"});
  if (quantity == "refractive_index") field.quantity = FieldQuantity::refractive_index;
  if (quantity == "refractivity") field.quantity = FieldQuantity::refractivity;
  field.scale = table.number("scale", 1.0);
  if (field.scale == 0) table.problem("scale", "is zero (the field would vanish); use kind = \"none\" for that");
  if (table.has("spacing_mm")) {
    field.spacing = three(table.numbers("spacing_mm", {1, 1, 1}, 3, Range::positive()), unit::millimetre);
  }
  field.center = three(table.numbers("center_mm", {0, 0, 0}, 3), unit::millimetre);
  field.extrude = table.boolean("extrude", false);
  auto const periodic = table.booleans("periodic", {false, false, false}, 3);
  for (std::size_t axis = 0; axis < 3 && periodic.size() == 3; ++axis) field.periodic[axis] = periodic[axis];
}

void read_gaussian(SetupTable& table, FieldSetup& field) {
  field.amplitude = table.required_number("amplitude_kg_m3");
  field.radius = table.required_number("radius_mm", Range::positive()) * unit::millimetre;
}

void read_sinusoid(SetupTable& table, FieldSetup& field) {
  field.amplitude = table.required_number("amplitude_kg_m3");
  field.wavelength = table.required_number("wavelength_mm", Range::positive()) * unit::millimetre;
  auto const direction = table.numbers("direction", {1, 0}, 2);
  if (direction.size() == 2) field.direction = {direction[0], direction[1]};
  double const norm = length(field.direction);
  if (norm == 0) {
    table.problem("direction", "is zero (a wave needs a direction); use [1, 0] for a wave along X");
  } else {
    field.direction = field.direction / norm;
  }
  field.phase = table.number("phase_rad", 0.0);
}

void read_shock(SetupTable& table, FieldSetup& field) {
  field.mach = table.required_number("mach", Range::at_least(1.0, 100.0));
  field.upstream_density = table.required_number("upstream_density_kg_m3", Range::positive());
  field.shock_thickness = table.required_number("shock_thickness_mm", Range::positive()) * unit::millimetre;
  field.tilt = table.number("tilt_deg", 0.0, {-89.0, 89.0, false, false}) * unit::degree;
  field.position = table.number("position_mm", 0.0) * unit::millimetre;
}

FieldSetup read_field(SetupTable table) {
  FieldSetup field;
  std::string const kind = table.kind_word(
      "kind", "none",
      {"none", "file", "uniform_gradient", "sinusoid", "gaussian_plume", "gaussian_blob", "normal_shock"});
  if (kind == "file") {
    field.kind = FieldKind::file;
    read_file_field(table, field);
  } else if (kind == "uniform_gradient") {
    field.kind = FieldKind::uniform_gradient;
    field.gradient = three(table.numbers("gradient_kg_m4", {10, 0, 0}, 3), 1.0);
  } else if (kind == "sinusoid") {
    field.kind = FieldKind::sinusoid;
    read_sinusoid(table, field);
  } else if (kind == "gaussian_plume" || kind == "gaussian_blob") {
    field.kind = kind == "gaussian_plume" ? FieldKind::gaussian_plume : FieldKind::gaussian_blob;
    read_gaussian(table, field);
  } else if (kind == "normal_shock") {
    field.kind = FieldKind::normal_shock;
    read_shock(table, field);
  }
  return field;
}

}  // namespace

MediumSetup read_medium_setup(SetupTable table) {
  MediumSetup setup;
  double const wavelength_nm = table.number("wavelength_nm", 532.0, {230.0, 1690.0, false, false});
  setup.wavelength = wavelength_nm * unit::nanometre;
  auto const constant =
      table.number_or_word("gladstone_dale", {2.26e-4, ""}, {"ciddor", "merzkirch"}, Range::positive(1.0));
  if (constant.number) setup.gladstone_dale = *constant.number;
  if (constant.word == "ciddor") setup.gladstone_dale = gladstone_dale_ciddor(setup.wavelength);
  if (constant.word == "merzkirch") setup.gladstone_dale = gladstone_dale_merzkirch(setup.wavelength);
  setup.ambient_density = table.number("ambient_density_kg_m3", 1.225, Range::at_least(0.0, 1e4));
  auto const thickness_mm = table.number_or_auto("thickness_mm", Range::positive(1e6));
  if (table.word("interpolation", "cubic_bspline", {"cubic_bspline", "trilinear"}) == "trilinear") {
    setup.interpolation = FieldInterpolation::trilinear;
  }
  std::string const integrator = table.word("integrator", "rk4", {"rk4", "euler", "straight"});
  if (integrator == "euler") setup.integrator = Integrator::euler;
  if (integrator == "straight") setup.integrator = Integrator::straight;
  setup.step_mm = table.number_or_auto("step_mm", Range::positive());
  if (table.word("faces", "matched", {"matched", "refract"}) == "refract") setup.faces = Faces::refract;
  auto fields = table.tables("field");
  if (fields.size() > 1) {
    table.problem("field", "is an array of several fields, which is not available yet (one field a setup); keep one");
    for (std::size_t other = 1; other < fields.size(); ++other) fields[other].excuse();
  }
  setup.field = read_field(fields.empty() ? table.table("field") : fields.front());
  if (SetupTable second = table.table("second_field"); second.present()) setup.second_field = read_field(second);
  setup.automatic_thickness = !thickness_mm;
  setup.thickness = thickness_mm.value_or(automatic_thickness_mm(setup)) * unit::millimetre;
  return setup;
}

MediumSetup at_second_pulse(MediumSetup const& setup) {
  MediumSetup second = setup;
  second.field = *setup.second_field;
  second.second_field.reset();
  return second;
}

double automatic_thickness_mm(MediumSetup const& setup) {
  double const first = automatic_thickness_mm(setup.field);
  return setup.second_field ? std::max(first, automatic_thickness_mm(*setup.second_field)) : first;
}

double automatic_thickness_mm(FieldSetup const& field) {
  constexpr double radii = 7.0;
  // to a nanometre: radii were told in mm
  double const wanted = std::round(radii * field.radius / unit::nanometre) * 1e-6;
  return has_size_along_z(field.kind) ? std::max(10.0, wanted) : 10.0;
}

double cut_off_share(MediumSetup const& setup) {
  return has_size_along_z(setup.field.kind) ? std::erfc(setup.thickness / 2 / setup.field.radius) : 0.0;
}

}  // namespace gladstone
