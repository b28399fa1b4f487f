#include "studies/commands/info_lens.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "render/base/units.h"
#include "render/optics/field_analysis.h"
#include "studies/case/json_text.h"
#include "studies/case/lens_glasses.h"
#include "studies/drawing/draw_figure.h"
#include "studies/figures/lens_figure.h"

namespace gladstone {
namespace {

constexpr int spot_rays = 2000;

nlohmann::json pupil_json(Pupil const& pupil) {
  return {{"position", number_or_null(pupil.position / unit::millimetre)},
          {"diameter", number_or_null(pupil.diameter / unit::millimetre)}};
}

/// Returns the JSON name of a field angle: "on_axis", "10_deg".
std::string field_name(double angle) {
  double const degrees = angle / unit::degree;
  return degrees == 0 ? "on_axis" : fmt::format("{:.6g}_deg", degrees);
}

/// Formats a length in millimetres; rounding errors around 0 are displayed as 0.
std::string length_text(double metres) {
  constexpr double rounding = 1e-12;  // [m]
  if (!std::isfinite(metres)) return "infinite";
  return fmt::format("{:.6g} mm", std::abs(metres) < rounding ? 0.0 : metres / unit::millimetre);
}

nlohmann::json lens_json(Lens const& lens, ParaxialLens const& paraxial, FieldAnalysis const& field,
                         std::vector<LensGlass> const& glasses) {
  nlohmann::json spots = nlohmann::json::object(), points = nlohmann::json::array();
  for (FieldPoint const& point : field.points) {
    spots[field_name(point.angle)] = point.imaged ? nlohmann::json(point.spot_rms * 1e6) : nlohmann::json(nullptr);
    nlohmann::json row{{"angle_deg", point.angle / unit::degree}, {"imaged", point.imaged}};
    if (point.imaged) {
      row["spot_rms_um"] = point.spot_rms * 1e6;
      row["best_spot_rms_um"] = point.best_spot_rms * 1e6;
      row["best_focus_mm"] = point.best_focus * 1e3;
      row["chief_ray_mm"] = {point.chief.x * 1e3, point.chief.y * 1e3};
      row["distortion"] = number_or_null(point.distortion);
      row["tangential_focus_mm"] = number_or_null(point.tangential_focus * 1e3);
      row["sagittal_focus_mm"] = number_or_null(point.sagittal_focus * 1e3);
      row["vignetting"] = point.vignetting;
    }
    row["lost"] = nlohmann::json::array();
    for (SurfaceRayLoss const& lost : point.lost) {
      row["lost"].push_back({{"surface", lost.surface + 1}, {"cause", to_string(lost.cause)}, {"share", lost.share}});
    }
    points.push_back(row);
  }
  return {{"title", lens.prescription.title},
          {"source", lens.prescription.source},
          {"wavelength_nm", lens.wavelength / unit::nanometre},
          {"surfaces", lens.surfaces.size()},
          {"effective_focal_length_mm", number_or_null(paraxial.effective_focal_length / unit::millimetre)},
          {"back_focal_length_mm", number_or_null(paraxial.back_focal_length / unit::millimetre)},
          {"front_focal_length_mm", number_or_null(paraxial.front_focal_length / unit::millimetre)},
          {"front_principal_plane_mm", number_or_null(paraxial.front_principal_plane / unit::millimetre)},
          {"rear_principal_plane_mm", number_or_null(paraxial.rear_principal_plane / unit::millimetre)},
          {"f_number", number_or_null(paraxial.f_number)},
          {"entrance_pupil_mm", pupil_json(paraxial.entrance)},
          {"exit_pupil_mm", pupil_json(paraxial.exit)},
          {"image_plane_mm", number_or_null(field.image_plane / unit::millimetre)},
          {"spot_rms_um", spots},
          {"field", points},
          {"glasses", lens_glasses_json(glasses)},
          {"warnings", lens.warnings}};
}

std::string lens_text(LensQuestion const& question, Lens const& lens, ParaxialLens const& paraxial,
                      FieldAnalysis const& field, std::vector<LensGlass> const& glasses) {
  std::string text = fmt::format("{}: {}{} surfaces at {:.6g} nm\n", question.file,
                                 lens.prescription.title.empty() ? "" : lens.prescription.title + ", ",
                                 lens.surfaces.size(), lens.wavelength / unit::nanometre);
  auto const line = [&text](char const* name, std::string const& value) {
    text += fmt::format("  {:<22}{}\n", name, value);
  };
  line("focal length", length_text(paraxial.effective_focal_length));
  line("back focal length", length_text(paraxial.back_focal_length) + " behind the last vertex");
  line("front focal length", length_text(paraxial.front_focal_length) + " from the first vertex");
  line("principal planes",
       fmt::format("{} from the first vertex, {} from the last", length_text(paraxial.front_principal_plane),
                   length_text(paraxial.rear_principal_plane)));
  char const* const none = std::isfinite(paraxial.effective_focal_length) ? "none (telecentric)" : "none (afocal)";
  line("f-number", std::isfinite(paraxial.f_number) ? fmt::format("{:.4g}", paraxial.f_number) : none);
  line("entrance pupil", fmt::format("{} wide at {} from the first vertex", length_text(paraxial.entrance.diameter),
                                     length_text(paraxial.entrance.position)));
  line("exit pupil", fmt::format("{} wide at {} from the last vertex", length_text(paraxial.exit.diameter),
                                 length_text(paraxial.exit.position)));
  line("image plane", length_text(field.image_plane) + " behind the last vertex");
  text += lens_glasses_text(glasses);
  text += "  field [deg]  spot rms [um]  narrowest [um]  its focus [mm]  distortion [%]  vignetting [%]\n";
  for (FieldPoint const& point : field.points) {
    text += point.imaged ? fmt::format("  {:>11.4g}  {:>13.4g}  {:>14.4g}  {:>14.4g}  {:>14.3f}  {:>14.1f}\n",
                                       point.angle / unit::degree, point.spot_rms * 1e6, point.best_spot_rms * 1e6,
                                       point.best_focus * 1e3, 100 * point.distortion, 100 * point.vignetting)
                         : fmt::format("  {:>11.4g}  no ray passes the lens\n", point.angle / unit::degree);
  }
  return text;
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
  for (std::string const& warning : lens.warnings) spdlog::warn("{}", warning);
  ParaxialLens const paraxial = paraxial_lens(lens);
  FieldAnalysis const field = analyse_field(lens, paraxial, spot_rays);
  std::vector<LensGlass> const glasses = list_lens_glasses(lens, catalogue);
  nlohmann::json json = lens_json(lens, paraxial, field, glasses);
  auto const draw = [&] { draw_figure(make_lens_figure(lens, paraxial, field), question.figure); };
  if (!question.figure.empty() && draw_or_warn(draw)) json["figure"] = question.figure;
  return {json_text(json), lens_text(question, lens, paraxial, field, glasses)};
}

}  // namespace gladstone
