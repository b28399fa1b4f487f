#include "studies/report/layout_view.h"

#include <fmt/format.h>

#include <cmath>

#include "studies/case/expected_particles.h"
#include "studies/design/sheet.h"
#include "studies/drawing/draw_figure.h"
#include "studies/figures/design_map.h"
#include "studies/figures/layout_figure.h"
#include "studies/figures/piv_map.h"

namespace gladstone::inline report {
namespace {

constexpr double mm = unit::millimetre;

std::string text_of_layout(DesignPoint<double> const& b) {
  return fmt::format(
      "Side view, to scale: the dots are Z_D = {:.5g} mm behind the mid-plane of the medium, the lens (f = {:.5g} mm, "
      "f/{:.4g}) is Z_A = {:.5g} mm in front of it. The field of view is {:.4g} x {:.4g} mm in the medium and {:.4g} x "
      "{:.4g} mm on the dots; the light cone of a dot is {:.3g} mm wide in the medium.",
      b.z_d / mm, b.focal_length / mm, b.f_number, b.z_a / mm, b.given->camera.columns * b.pixel_at_medium() / mm,
      b.given->camera.rows * b.pixel_at_medium() / mm, b.given->camera.columns * b.pixel_at_dots() / mm,
      b.given->camera.rows * b.pixel_at_dots() / mm, b.cone_diameter() / mm);
}

std::string text_of_layout(Setup const& setup) {
  ImagingGeometry const imaging = setup.imaging();
  double const seen = setup.camera.pixel_pitch / imaging.magnification;
  return fmt::format(
      "Side view, to scale: the laser sheet is {:.4g} mm thick and is Z_A = {:.5g} mm in front of the lens at "
      "f/{:.4g}, the sensor {:.5g} mm behind it. The field of view in the sheet is {:.4g} x {:.4g} mm (M = {:.4g}).",
      setup.piv->laser.thickness / mm, setup.z_a / mm, setup.lens.f_number, imaging.image_distance / mm,
      setup.camera.columns * seen / mm, setup.camera.rows * seen / mm, imaging.magnification);
}

std::string text_of_stop(Setup const& setup) {
  ExpectedParticles const expected = expected_particles(setup);
  return fmt::format(
      "Particle images against the f-number. At f/{:.4g} of the set-up, an image is {:.3g} px wide (e^-2; 2 to 4 px "
      "are suitable for correlation), {:.3g} px at the edge of the sheet, and the median particle has {:.3g} electrons "
      "at its peak.",
      setup.lens.f_number, expected.image_diameter_px, expected.sheet_edge_diameter_px, expected.peak_electrons.median);
}

bool is_drawn(Setup const& setup) {
  if (!setup.planes.empty() || setup.pose || setup.camera.tilted() || !setup.elements.empty()) return false;
  if (setup.piv) {
    LaserSetup const& laser = setup.piv->laser;
    bool const upright = std::abs(laser.normal.z) > 1 - 1e-9 && laser.tilt == std::array<double, 2>{};
    if (!upright || laser.centre.z != 0) return false;
  }
  return std::isfinite(setup.lens.f_number);
}

std::string map_text(DesignPoint<double> const& b) {
  return fmt::format(
      "Resolution against sensitivity over Z_D, one curve per f-number. The set-up is the point at {:.4g} px per "
      "kg/m^4 and {:.4g} mm.",
      b.sensitivity(), resolved_wavelength(b) / mm);
}

Figure make_map(LayoutView const& view) {
  return view.piv ? make_piv_map(*view.piv) : make_design_map(view.bench, nullptr);
}

}  // namespace

Figure make_view_figure(LayoutView const& view) {
  return view.piv ? make_piv_layout_figure(*view.piv) : make_layout_figure(view.bench);
}

std::optional<LayoutView> layout_view(CaseSetup loaded) {
  if (!is_drawn(loaded.setup) || loaded.correlate.window_px.empty()) return std::nullopt;
  if (loaded.setup.piv) return LayoutView{nullptr, {}, std::move(loaded.setup)};
  loaded.setup.medium.field.kind = FieldKind::none;
  auto given = std::make_unique<FixedDesignParameters>(collect_fixed_parameters(loaded));
  DesignPoint<double> const bench = make_design_point(loaded.setup, *given);
  return LayoutView{std::move(given), bench, std::nullopt};
}

std::string layout_text(LayoutView const& view) {
  return view.piv ? text_of_layout(*view.piv) : text_of_layout(view.bench);
}

ReportBlock layout_block(LayoutView const& view, std::string const& whose) {
  return Chart{"layout", "Layout of " + whose, layout_text(view), {{"", make_view_figure(view)}}};
}

ReportSection layout_section(LayoutView const& view, std::string const& whose) {
  Chart map{"design_map",
            "Design map of " + whose,
            view.piv ? text_of_stop(*view.piv) : map_text(view.bench),
            {{"", make_map(view)}}};
  return {"Set-up", {layout_block(view, whose), std::move(map)}};
}

std::vector<std::string> draw_layout_and_map(std::string const& folder, std::string const& format,
                                             LayoutView const& view) {
  std::vector<std::string> const drawn{folder + "/layout." + format, folder + "/design_map." + format};
  draw_figure(make_view_figure(view), drawn.front());
  draw_figure(make_map(view), drawn.back());
  return drawn;
}

}  // namespace gladstone::inline report
