#pragma once

#include <optional>
#include <string>
#include <vector>

#include "render/focused_dots/bench_theory.h"
#include "render/focused_dots/scene_view.h"
#include "render/scene/scene.h"

namespace gladstone {

/// A scene that the fast renderer may take: flat discs (or squares) in focus of an ideal thin lens with a stop, on the
/// axis and square to it. There the reference image is known in closed form, and one table of deflections serves all
/// dots (LightModel); nowhere else. Renderer, planners and tables take it, and only focused_dots() gives it. It looks
/// at the scene, which must outlive it, and sees what is planned there later.
class FocusedDots {
 public:
  Scene const& scene() const { return *scene_; }
  /// The same of a copy of the scene, in which other rays, another step or another margin are planned.
  FocusedDots of(Scene const& copy) const { return FocusedDots(copy); }

  /// The view that launches take; `sources` default to the scene's own dots.
  SceneView<double> view() const { return view(scene_->dots); }
  SceneView<double> view(DotPattern const& sources) const;
  /// The view of rays that no stop clips.
  SceneView<double> open_view() const;
  /// The stop in the lens plane. @pre the lens has one
  ApertureStop<double> aperture_stop() const;
  /// What Eq. 9 takes.
  TheoryModel theory_model() const;
  /// Light of one ray of weight one, in fully lit pixels: what makes images independent of rays and margin.
  double light_per_ray(DotPattern const& sources) const;

 private:
  explicit FocusedDots(Scene const& scene) : scene_(&scene) {}
  friend std::optional<FocusedDots> focused_dots(Scene const& scene);
  friend std::optional<FocusedDots> bench_rays(Scene const& scene);

  Scene const* scene_;
};

/// Why a setup is none of these; empty: it is.
std::string reason_against_focused_dots(Setup const& setup);

/// The one door to the fast renderer.
std::optional<FocusedDots> focused_dots(Scene const& scene);

/// Any scene on the bench (Setup::on_bench()), out of focus or without a stop too, where it has no tables: the GPU
/// traces these by the same kernels, ray by ray, as long as it has no general renderer. Nothing else may ask for it.
std::optional<FocusedDots> bench_rays(Scene const& scene);

/// What rendering focused dots takes beside images, field and dots, for check_memory(); before anything is built.
std::vector<MemoryNeed> focused_dots_memory(Setup const& setup);

}  // namespace gladstone
