#include <cmath>
#include <filesystem>

#include "render/base/units.h"
#include "render/files/text_file.h"
#include "render/optics/even_asphere.h"
#include "render/optics/prescription_readers/lines.h"
#include "render/optics/prescription_readers/readers.h"
#include "render/setup/setup_table.h"

namespace gladstone::inline optics {
namespace {

using unit::millimetre;

PrescribedMedium read_medium(SetupTable& table) {
  if (table.has("index")) {
    table.refuse("glass", "conflicts with index (both define the medium behind the surface); remove one");
    return {PrescribedMedium::Index{table.number("index", 1.5, {1, 5, false, false})}};
  }
  if (table.has("nd") || table.has("vd")) {
    table.refuse("glass", "conflicts with nd and vd (both define the medium behind the surface); remove one");
    double const nd = table.required_number("nd", {1, 5, true, false});
    return {PrescribedMedium::Described{nd, table.required_number("vd", Range::positive(1e4))}};
  }
  std::string const glass = table.text("glass", "air");
  if (glass == "air") return {};
  if (glass == "mirror") return {PrescribedMedium::Mirror{}};
  return {PrescribedMedium::Named{glass}};
}

PrescribedSurface read_surface(SetupTable& table) {
  PrescribedSurface surface;
  surface.where = table.where("");
  if (table.word("shape", "conic", {"conic", "cylinder"}) == "cylinder") {
    surface.shape = PrescribedSurface::Shape::cylinder;
  }
  if (table.has("curvature_per_mm")) {
    table.refuse("radius_mm", "conflicts with curvature_per_mm (both set the curvature); remove one");
    surface.curvature = table.number("curvature_per_mm", 0) / millimetre;
  } else {
    Range any = Range::any();
    any.allow_inf = true;
    double const radius = table.number("radius_mm", HUGE_VAL, any);
    if (radius == 0) {
      table.problem("radius_mm", "a radius of 0 is impossible; a plane has inf");
    } else {
      surface.curvature = 1 / (radius * millimetre);
    }
  }
  surface.conic = table.number("conic", 0.0);
  if (table.has("asphere_mm")) {
    if (surface.shape == PrescribedSurface::Shape::cylinder) {
      table.problem("asphere_mm", "is for surfaces of revolution, not for cylinders; remove it");
    }
    std::vector<double> const terms = table.number_list("asphere_mm", {}, 1, EvenAsphere<double>::terms);
    for (std::size_t i = 0; i < terms.size(); ++i) {
      surface.asphere.push_back(terms[i] / std::pow(millimetre, static_cast<double>(2 * i + 1)));
    }
  }
  surface.thickness = table.number("thickness_mm", 0.0, {-1e6, 1e6, false, false}) * millimetre;
  surface.after = read_medium(table);
  for (char const* const key : {"glass", "index", "nd"}) {
    if (table.has(key)) surface.after.where = table.where(key);
  }
  if (auto const edge = table.optional_number("semi_diameter_mm", Range::positive())) {
    surface.semi_diameter = *edge * millimetre;
  }
  surface.obscured = table.number("obscured_mm", 0.0, Range::at_least(0)) * millimetre;
  surface.stop = table.boolean("stop", false);
  if (table.has("decentre_mm") || table.has("tilt_deg")) {
    std::vector<double> const shift = table.numbers("decentre_mm", {0, 0}, 2);
    std::vector<double> const tilt = table.numbers("tilt_deg", {0, 0, 0}, 3, {-180, 180, false, false});
    CoordinateBreak here;
    here.decentre = Vec2d{shift[0], shift[1]} * millimetre;
    here.tilt = Vec3d{tilt[0], tilt[1], tilt[2]} * unit::degree;
    surface.before.push_back(here);
  }
  return surface;
}

}  // namespace

Prescription read_toml_prescription(std::string const& path) {
  std::string const folder = std::filesystem::absolute(path).parent_path().string();
  SetupDocument document =
      SetupDocument::from_text(read_text_file(path, "a lens file", most_setup_bytes), path, folder);
  SetupTable root = document.root();
  Prescription result;
  result.file = path;
  root.integer("schema", 1, 1, 1);
  result.title = root.text("title", "");
  result.source = root.text("source", "");
  if (auto const primary = root.optional_number("primary_wavelength_nm", Range::positive(1e5))) {
    std::string const fault = describe_wavelength_fault(*primary, unit::nanometre, "nm");
    if (!fault.empty()) root.problem("primary_wavelength_nm", fault, ErrorCode::out_of_range);
    result.primary_wavelength = *primary * unit::nanometre;
  }
  Range distance = Range::positive();
  distance.allow_inf = true;
  result.object_distance = root.number("object_distance_mm", HUGE_VAL, distance) * millimetre;
  using Kind = PrescribedAperture::Kind;
  auto const aperture = [&](char const* key, Kind kind, double scale, Range range) {
    auto const value = root.optional_number(key, range);
    if (!value) return;
    if (result.aperture.kind != Kind::stop) {
      root.problem(key, "conflicts with another key that sets the stop (one is enough); remove one");
    }
    result.aperture = {kind, *value * scale, root.where(key)};
  };
  aperture("entrance_pupil_mm", Kind::entrance_pupil, millimetre, Range::positive());
  aperture("f_number", Kind::f_number, 1, Range::positive());
  aperture("object_na", Kind::object_na, 1, {0, 1, true, false});
  for (double const angle : root.number_list("field_deg", {0}, 1, 100, {-89, 89, false, false})) {
    result.field_angles.push_back(angle * unit::degree);
  }
  for (SetupTable& table : root.tables("surface")) result.surfaces.push_back(read_surface(table));
  document.finish();
  return result;
}

}  // namespace gladstone::inline optics
