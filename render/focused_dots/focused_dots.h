#pragma once

#include <optional>
#include <string>

#include "render/scene/scene.h"

namespace gladstone {

/// A scene that the fast renderer may take: flat discs (or squares) in focus of an ideal thin lens with a stop, on the
/// axis and square to it. There the reference image is known in closed form, and one table of deflections serves all
/// dots (LightModel); nowhere else.
struct FocusedDots {
  Scene const* scene;
};

/// Why a setup is none of these; empty: it is.
std::string reason_against_focused_dots(Setup const& setup);

/// The one door to the fast renderer.
std::optional<FocusedDots> focused_dots(Scene const& scene);

}  // namespace gladstone
