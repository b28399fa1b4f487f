#include "studies/report/layout_view.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <utility>

#include "render/scene/experiment.h"
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

std::string map_text(DesignPoint<double> const& b) {
  return fmt::format(
      "Resolution against sensitivity over Z_D, one curve per f-number. The set-up is the point at {:.4g} px per "
      "kg/m^4 and {:.4g} mm.",
      b.sensitivity(), resolved_wavelength(b) / mm);
}

LayoutView view_bos(CaseSetup loaded) {
  loaded.setup.medium.field.kind = FieldKind::none;
  auto given = std::make_unique<FixedDesignParameters>(collect_fixed_parameters(loaded));
  DesignPoint<double> const bench = make_design_point(loaded.setup, *given);
  return {nullptr, std::move(loaded.setup), std::move(given), bench};
}

LayoutView view_piv(CaseSetup loaded) { return {nullptr, std::move(loaded.setup), nullptr, {}}; }

bool has_upright_sheet(Setup const& setup) {
  LaserSetup const& laser = setup.piv->laser;
  bool const upright = std::abs(laser.normal.z) > 1 - 1e-9 && laser.tilt == std::array<double, 2>{};
  return upright && laser.centre.z == 0;
}

}  // namespace

/// Layout and design map of an experiment in reports.
struct LayoutKind {
  Experiment const& experiment;
  /// Returns true if the drawing covers the light sources of a setup.
  bool (*covers)(Setup const& setup);
  /// Creates the layout, except its kind.
  LayoutView (*view)(CaseSetup loaded);
  Figure (*layout)(LayoutView const& view);
  std::string (*layout_text)(LayoutView const& view);
  Figure (*map)(LayoutView const& view);
  std::string (*map_text)(LayoutView const& view);
};

namespace {

constexpr std::array layout_kinds{
    LayoutKind{.experiment = bos_experiment,
               .covers = [](Setup const& /*setup*/) { return true; },
               .view = view_bos,
               .layout = [](LayoutView const& view) { return make_layout_figure(view.bench); },
               .layout_text = [](LayoutView const& view) { return text_of_layout(view.bench); },
               .map = [](LayoutView const& view) { return make_design_map(view.bench, nullptr); },
               .map_text = [](LayoutView const& view) { return map_text(view.bench); }},
    LayoutKind{.experiment = piv_experiment,
               .covers = has_upright_sheet,
               .view = view_piv,
               .layout = [](LayoutView const& view) { return make_piv_layout_figure(view.setup); },
               .layout_text = [](LayoutView const& view) { return text_of_layout(view.setup); },
               .map = [](LayoutView const& view) { return make_piv_map(view.setup); },
               .map_text = [](LayoutView const& view) { return text_of_stop(view.setup); }}};

/// Returns the kind of layout that covers a setup; null if none does.
LayoutKind const* find_layout_kind(Setup const& setup) {
  if (setup.pose || setup.camera.tilted() || !setup.elements.empty() || !std::isfinite(setup.lens.f_number)) {
    return nullptr;
  }
  LayoutKind const* const kind = find_kind(layout_kinds, setup.experiment());
  return kind && kind->covers(setup) ? kind : nullptr;
}

}  // namespace

Figure make_view_figure(LayoutView const& view) { return view.kind->layout(view); }

std::optional<LayoutView> layout_view(CaseSetup loaded) {
  LayoutKind const* const kind = find_layout_kind(loaded.setup);
  if (!kind || loaded.correlate.window_px.empty()) return std::nullopt;
  LayoutView view = kind->view(std::move(loaded));
  view.kind = kind;
  return view;
}

std::string layout_text(LayoutView const& view) { return view.kind->layout_text(view); }

ReportBlock layout_block(LayoutView const& view, std::string const& whose) {
  return Chart{"layout", "Layout of " + whose, layout_text(view), {{"", make_view_figure(view)}}};
}

ReportSection layout_section(LayoutView const& view, std::string const& whose) {
  Chart map{"design_map", "Design map of " + whose, view.kind->map_text(view), {{"", view.kind->map(view)}}};
  return {"Set-up", {layout_block(view, whose), std::move(map)}};
}

std::vector<std::string> draw_layout_and_map(std::string const& folder, std::string const& format,
                                             LayoutView const& view) {
  std::vector<std::string> const drawn{folder + "/layout." + format, folder + "/design_map." + format};
  draw_figure(make_view_figure(view), drawn.front());
  draw_figure(view.kind->map(view), drawn.back());
  return drawn;
}

}  // namespace gladstone::inline report
