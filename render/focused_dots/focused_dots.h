#pragma once

#include <optional>
#include <string>
#include <vector>

#include "render/focused_dots/bench_theory.h"
#include "render/scene/scene.h"

namespace gladstone {

/// A scene that the fast renderer may take: flat discs (or squares) in focus of an ideal thin lens with a stop, on the
/// axis and square to it, a Gaussian spot. There the reference image is known in closed form, and one table of
/// deflections serves all dots (DotModel); nowhere else. Renderer and tables take it, and only focused_dots() gives it.
/// It looks at the scene, which must outlive it, and sees what is planned there later.
class FocusedDots {
 public:
  Scene const& scene() const { return *scene_; }
  BenchView bench() const;
  /// What Eq. 9 takes.
  TheoryModel theory_model() const;

 private:
  explicit FocusedDots(Scene const& scene) : scene_(&scene) {}
  friend std::optional<FocusedDots> focused_dots(Scene const& scene);

  Scene const* scene_;
};

/// Why a setup is none of these; empty: it is.
std::string reason_against_focused_dots(Setup const& setup);

/// The one door to the fast renderer. It stays shut, too, to fields so fine beside the view that their table would take
/// too much time and memory, and to dots that are wide beside what the field changes on.
std::optional<FocusedDots> focused_dots(Scene const& scene);

/// What rendering focused dots takes beside images, field and dots, for check_memory(); before anything is built.
std::vector<MemoryNeed> focused_dots_memory(Setup const& setup);

}  // namespace gladstone
