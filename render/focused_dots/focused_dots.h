#pragma once

#include <optional>
#include <string>
#include <vector>

#include "render/focused_dots/bench_theory.h"
#include "render/scene/render_plan.h"

namespace gladstone::inline focused_dots {

/// Scene that the fast renderer supports: flat discs or squares in focus of an ideal thin lens with a stop, on and
/// perpendicular to the axis, with a Gaussian PSF. Only then is the reference image known in closed form and a single
/// deflection table valid for all dots (DotModel).
/// Required as an argument by renderer and tables; created by build_focused_dots() only. Refers to the scene, which
/// must outlive it.
class FocusedDots {
 public:
  Scene const& scene() const { return *scene_; }
  RenderPlan const& plan() const { return plan_; }
  /// Dots that every deflection table covers: those of the scene, unless they are replaced.
  DotPattern const& dots() const { return *dots_; }
  /// Returns the same with other dots of the same size, which must outlive it.
  FocusedDots with_dots(DotPattern const& dots) const;
  FocusedSetupView bench() const;
  /// Parameters of small-angle theory (Eq. 9).
  TheoryModel theory_model() const;

 private:
  FocusedDots(Scene const& scene, RenderPlan const& plan) : scene_(&scene), dots_(&scene.dots), plan_(plan) {}
  friend std::optional<FocusedDots> build_focused_dots(Scene const& scene, RenderPlan const& plan);

  Scene const* scene_;
  DotPattern const* dots_;
  RenderPlan plan_;
};

/// Returns the reason why the fast renderer does not support a setup; empty if it does.
std::string reason_against_focused_dots(Setup const& setup);

/// Returns the scene for the fast renderer; nullopt if it is not supported. Besides the conditions of
/// reason_against_focused_dots(), fields that are so fine compared with the view that the table would need too much
/// time and memory, dots that are wide compared with the field's length scale, and too wide a PSF are not supported.
std::optional<FocusedDots> build_focused_dots(Scene const& scene, RenderPlan const& plan = {});

/// Returns the memory requirements of the fast renderer beyond images, field and dots, for check_memory(), before
/// anything is built.
std::vector<MemoryRequirement> focused_dots_memory(Setup const& setup);

}  // namespace gladstone::inline focused_dots
