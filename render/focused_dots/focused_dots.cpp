#include "render/focused_dots/focused_dots.h"

#include <algorithm>
#include <cmath>

#include "render/focused_dots/deflection_map.h"

namespace gladstone::inline focused_dots {

FocusedDots FocusedDots::with_dots(DotPattern const& dots) const {
  FocusedDots other = *this;
  other.dots_ = &dots;
  return other;
}

FocusedSetupView FocusedDots::bench() const {
  Setup const& setup = scene_->setup;
  return {-setup.z_d,
          setup.z_a,
          scene_->imaging.magnification / setup.camera.pixel_pitch,
          {plan_.step, setup.medium.ambient_refractivity(), setup.medium.integrator, setup.medium.faces}};
}

TheoryModel FocusedDots::theory_model() const {
  return {std::min(plan_.step, scene_->medium.coarsest_step), scene_->setup.z_d, scene_->imaging.magnification,
          scene_->setup.ambient_index(), scene_->setup.camera.pixel_pitch};
}

std::string reason_against_focused_dots(Setup const& setup) {
  if (std::string reason = setup.experiment().reason_for_rays; !reason.empty()) return reason;
  if (std::string reason = setup.reason_against_closed_form(); !reason.empty()) return reason;
  if (std::isinf(setup.lens.f_number)) return "the lens has no stop (f_number = inf)";
  if (!(std::abs(setup.focus_distance() - setup.z_b()) <= 1e-12 * setup.z_b())) return "the dots are out of focus";
  if (setup.lens.spot == SpotModel::airy || setup.lens.spot == SpotModel::none)
    return "the point spread function is not Gaussian";
  if (setup.render.sampling != PupilSampling::sobol) return "render.sampling = \"random\" requires ray tracing";
  return "";
}

std::optional<FocusedDots> build_focused_dots(Scene const& scene, RenderPlan const& plan) {
  constexpr int widest_spot = 22;  // maximum half width of the PSF, limited by the row length of DotPatch [px]
  if (!reason_against_focused_dots(scene.setup).empty()) return std::nullopt;
  if (GaussianSpot<double>{scene.spot_sigma_px()}.half_width() > widest_spot) return std::nullopt;
  if (table_state(scene) != TableState::made && table_state(scene) != TableState::no_medium) return std::nullopt;
  return FocusedDots(scene, plan);
}

std::vector<MemoryRequirement> focused_dots_memory(Setup const& setup) {
  if (!setup.experiment().sources.on_target) return {};
  return {{"camera.pixels", "table of deflections", table_bytes_needed(setup)}};
}

}  // namespace gladstone::inline focused_dots
