#include "studies/design/sheet.h"

#include <algorithm>
#include <optional>

#include "render/base/contracts.h"
#include "render/planning.h"
#include "render/scene/field_map.h"
#include "render/scene/scene.h"

namespace gladstone::inline design {
namespace {

/// Returns half the width and height of the camera's view in the medium's mid-plane [m].
Vec2d half_view_at_medium(Setup const& setup) {
  double const pixel = setup.camera.pixel_pitch / setup.imaging().magnification * setup.z_a / setup.z_b();
  return 0.5 * pixel * Vec2d{double(setup.camera.columns), double(setup.camera.rows)};
}

/// Returns the largest density gradient in the view, averaged over the thickness [kg/m^4].
double largest_gradient(Setup const& setup) {
  if (auto const known = closed_form_gradient(setup)) return *known;
  double largest = 0;
  constexpr int lattice_px = 4;
  Scene const scene = build_scene(setup);
  for (Vec2d const gradient : map_field(scene, plan_step(scene).step, lattice_px).density_gradient) {
    largest = std::max(largest, length(gradient));
  }
  return largest;
}

}  // namespace

std::optional<double> closed_form_gradient(Setup const& setup) {
  if (setup.medium.field.kind == FieldKind::none) return 0;
  if (setup.medium.field.kind != FieldKind::closed_form) return std::nullopt;
  Vec2d const half = half_view_at_medium(setup);
  return std::visit(
      [half](auto const& form) -> std::optional<double> {
        if constexpr (requires { form.steepest_mean_density(half); }) return form.steepest_mean_density(half);
        return std::nullopt;
      },
      make_closed_form(setup.medium));
}

Margin at_least(double value, double good, double least) {
  return value >= good ? Margin::green : value >= least ? Margin::marginal : Margin::violated;
}

Margin at_most(double value, double good, double most) {
  return value <= good ? Margin::green : value <= most ? Margin::marginal : Margin::violated;
}

ResultRow const& DesignSheet::row(std::string const& key) const {
  auto const found = std::find_if(rows.begin(), rows.end(), [&key](ResultRow const& row) { return row.key == key; });
  GLADSTONE_EXPECTS(found != rows.end());
  return *found;
}

FixedDesignParameters collect_fixed_parameters(CaseSetup const& loaded) {
  Setup const& setup = loaded.setup;
  FixedDesignParameters given;
  given.camera = setup.camera;
  given.light = loaded.light;
  given.wavelength = setup.medium.wavelength;
  given.gladstone_dale = setup.medium.gladstone_dale;
  given.ambient_index = setup.ambient_index();
  given.thickness = setup.medium.thickness;
  given.largest_gradient = largest_gradient(setup);
  given.dots_per_window_32 = setup.target.dots_per_32px_window;
  given.first_window_px = loaded.correlate.window_px.front();
  bool const uniform = loaded.correlate.weighting == "uniform";
  given.window =
      WindowTransfer(uniform ? WindowWeighting::uniform : WindowWeighting::gaussian, loaded.correlate.window_px.back());
  return given;
}

DesignPoint<double> make_design_point(Setup const& setup, FixedDesignParameters const& given) {
  return {&given, setup.lens.focal_length, setup.lens.f_number, setup.z_a, setup.z_d, setup.dot_diameter()};
}

Warnings list_neglected_effects(Setup const& setup) {
  Warnings warnings;
  if (!setup.experiment().correlated) return warnings;  // no sheet describes it
  if (setup.lens.focus != Focus::target && setup.experiment().sources.on_target) {
    warnings.push_back(
        {WarningCode::approximated, "lens.focus", "the sheet assumes dots in focus, but these are out of focus"});
  }
  if (!setup.has_closed_form_layout()) {
    warnings.push_back({WarningCode::approximated, "",
                        "the sheet assumes a thin lens on the axis, perpendicular to the target: it neglects poses, "
                        "tilts, other elements, distortion and aberrations"});
  }
  return warnings;
}

}  // namespace gladstone::inline design
