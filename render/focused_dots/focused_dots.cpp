#include "render/focused_dots/focused_dots.h"

#include <cmath>

namespace gladstone {

std::string reason_against_focused_dots(Setup const& setup) {
  if (setup.lens.prescription) return "the lens is a prescription";
  if (setup.pose) return "the camera has a pose of its own";
  if (!setup.windows.empty()) return "there are windows";
  if (setup.camera.tilted()) return "the sensor is tilted";
  if (setup.camera.distorted()) return "the lens distorts";
  if (std::isinf(setup.lens.f_number)) return "the lens has no stop (f_number = inf)";
  if (!(std::abs(setup.focus_distance() - setup.z_b()) <= 1e-12 * setup.z_b())) return "the dots are out of focus";
  return "";
}

std::optional<FocusedDots> focused_dots(Scene const& scene) {
  if (!reason_against_focused_dots(scene.setup).empty()) return std::nullopt;
  return FocusedDots{&scene};
}

}  // namespace gladstone
