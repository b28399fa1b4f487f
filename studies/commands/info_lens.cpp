#include "studies/commands/info_lens.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "render/base/units.h"
#include "render/optics/field_analysis.h"
#include "studies/case/json_text.h"
#include "studies/case/lens_glasses.h"
#include "studies/case/warning_json.h"
#include "studies/case/warning_log.h"
#include "studies/drawing/draw_figure.h"
#include "studies/figures/draw_or_warn.h"
#include "studies/figures/lens_figure.h"

namespace gladstone::inline commands {
namespace {

constexpr int spot_rays = 2000;

/// Returns the JSON name of a field angle: "on_axis", "10_deg".
std::string field_name(double angle) {
  double const degrees = angle / unit::degree;
  return degrees == 0 ? "on_axis" : fmt::format("{:.6g}_deg", degrees);
}

/// Cardinal points and pupils; lengths that are rounding errors around 0 are 0.
std::vector<ResultRow> lens_rows(ParaxialLens const& paraxial, FieldAnalysis const& field) {
  std::vector<ResultRow> rows;
  auto const add = [&rows](char const* key, char const* symbol, char const* label, double metres,
                           char const* note = "") {
    constexpr double rounding = 1e-12;  // [m]
    double const value = std::abs(metres) < rounding ? 0.0 : metres / unit::millimetre;
    rows.push_back({.key = key,
                    .symbol = symbol,
                    .label = label,
                    .value = value,
                    .unit = "mm",
                    .source = "paraxial rays",
                    .note = note});
  };
  constexpr char const *before = "from the first vertex", *behind = "from the last vertex";
  add("effective_focal_length_mm", "f", "focal length", paraxial.effective_focal_length);
  add("back_focal_length_mm", "", "back focal length", paraxial.back_focal_length, behind);
  add("front_focal_length_mm", "", "front focal length", paraxial.front_focal_length, before);
  add("front_principal_plane_mm", "", "front principal plane", paraxial.front_principal_plane, before);
  add("rear_principal_plane_mm", "", "rear principal plane", paraxial.rear_principal_plane, behind);
  rows.push_back({.key = "f_number",
                  .symbol = "N",
                  .label = "f-number",
                  .value = paraxial.f_number,
                  .source = "paraxial rays",
                  .note = std::isfinite(paraxial.f_number)                 ? ""
                          : std::isfinite(paraxial.effective_focal_length) ? "telecentric"
                                                                           : "afocal"});
  add("entrance_pupil_mm.position", "", "entrance pupil, position", paraxial.entrance.position, before);
  add("entrance_pupil_mm.diameter", "", "entrance pupil, diameter", paraxial.entrance.diameter);
  add("exit_pupil_mm.position", "", "exit pupil, position", paraxial.exit.position, behind);
  add("exit_pupil_mm.diameter", "", "exit pupil, diameter", paraxial.exit.diameter);
  add("image_plane_mm", "", "image plane", field.image_plane, behind);
  return rows;
}

/// Properties of the image at a field angle; none if no ray passes the lens.
std::vector<ResultRow> field_rows(FieldPoint const& point) {
  if (!point.imaged) return {};
  auto const row = [](char const* key, char const* label, double value, char const* unit_name) {
    return ResultRow{.key = key, .label = label, .value = value, .unit = unit_name, .source = "real rays"};
  };
  return {row("spot_rms_um", "spot rms", point.spot_rms / unit::micrometre, "um"),
          row("best_spot_rms_um", "narrowest", point.best_spot_rms / unit::micrometre, "um"),
          row("best_focus_mm", "its focus", point.best_focus / unit::millimetre, "mm"),
          row("distortion", "distortion", point.distortion, ""),
          row("tangential_focus_mm", "tangential focus", point.tangential_focus / unit::millimetre, "mm"),
          row("sagittal_focus_mm", "sagittal focus", point.sagittal_focus / unit::millimetre, "mm"),
          row("vignetting", "vignetting", point.vignetting, "")};
}

/// Returns all quantities of a lens; the names of those of a field angle contain the angle.
std::vector<ResultRow> all_rows(ParaxialLens const& paraxial, FieldAnalysis const& field) {
  std::vector<ResultRow> rows = lens_rows(paraxial, field);
  for (FieldPoint const& point : field.points) {
    for (ResultRow row : field_rows(point)) {
      row.label += fmt::format(" at {:.6g} deg", point.angle / unit::degree);
      append_rows(rows, {std::move(row)}, field_name(point.angle));
    }
  }
  return rows;
}

nlohmann::ordered_json lens_json(Lens const& lens, ParaxialLens const& paraxial, FieldAnalysis const& field,
                                 std::vector<LensGlass> const& glasses) {
  nlohmann::ordered_json json{{"title", lens.prescription.title},
                              {"source", lens.prescription.source},
                              {"wavelength_nm", lens.wavelength / unit::nanometre},
                              {"surfaces", lens.surfaces.size()}};
  json.update(rows_json(lens_rows(paraxial, field)));
  json["spot_rms_um"] = nlohmann::ordered_json::object();
  json["field"] = nlohmann::ordered_json::array();
  for (FieldPoint const& point : field.points) {
    nlohmann::ordered_json row{{"angle_deg", point.angle / unit::degree}, {"imaged", point.imaged}};
    row.update(rows_json(field_rows(point)));
    if (point.imaged) row["chief_ray_mm"] = {point.chief.x / unit::millimetre, point.chief.y / unit::millimetre};
    row["lost"] = nlohmann::ordered_json::array();
    for (SurfaceRayLoss const& lost : point.lost)
      row["lost"].push_back({{"surface", lost.surface + 1}, {"cause", to_string(lost.cause)}, {"share", lost.share}});
    json["spot_rms_um"][field_name(point.angle)] = row.value("spot_rms_um", nlohmann::ordered_json());
    json["field"].push_back(std::move(row));
  }
  json["glasses"] = lens_glasses_json(glasses);
  json["warnings"] = to_strings(lens.warnings);
  json["warning_records"] = lens.warnings;
  return json;
}

std::string lens_text(LensQuestion const& question, Lens const& lens, ParaxialLens const& paraxial,
                      FieldAnalysis const& field, std::vector<LensGlass> const& glasses) {
  std::string text = fmt::format("{}: {}{} surfaces at {:.6g} nm\n", question.file,
                                 lens.prescription.title.empty() ? "" : lens.prescription.title + ", ",
                                 lens.surfaces.size(), lens.wavelength / unit::nanometre);
  text += rows_text(lens_rows(paraxial, field)) + lens_glasses_text(glasses);
  std::vector<ResultGroup> groups;
  std::string dark;
  for (FieldPoint const& point : field.points) {
    std::string const angle = fmt::format("{:.4g}", point.angle / unit::degree);
    if (point.imaged) {
      groups.push_back({angle, field_rows(point)});
    } else {
      dark += fmt::format("  {:<16}  no ray passes the lens\n", angle);
    }
  }
  return text + groups_text("field [deg]", groups) + dark;
}

}  // namespace

Description describe_lens(LensQuestion const& question) {
  GlassCatalogue catalogue = GlassCatalogue::shipped();
  for (std::string const& file : question.glasses) catalogue.add_file(file);
  Prescription prescription = read_prescription(question.file);
  double wavelength = question.wavelength_nm * unit::nanometre;
  if (wavelength == 0) wavelength = prescription.primary_wavelength;
  if (wavelength == 0) wavelength = spectral_line::d;
  Lens lens = build_lens(std::move(prescription), catalogue, wavelength);
  lens.warnings.insert(lens.warnings.begin(), catalogue.warnings().begin(), catalogue.warnings().end());
  log_warnings(lens.warnings);
  ParaxialLens const paraxial = paraxial_lens(lens);
  FieldAnalysis const field = analyse_field(lens, paraxial, spot_rays);
  std::vector<LensGlass> const glasses = list_lens_glasses(lens, catalogue);
  nlohmann::ordered_json json = lens_json(lens, paraxial, field, glasses);
  auto const draw = [&] { draw_figure(make_lens_figure(lens, paraxial, field), question.figure); };
  if (!question.figure.empty() && draw_or_warn(draw)) json["figure"] = question.figure;
  return {json_text(json), lens_text(question, lens, paraxial, field, glasses), all_rows(paraxial, field)};
}

}  // namespace gladstone::inline commands
