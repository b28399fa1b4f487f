#include "render/optics/window.h"

#include "render/base/units.h"

namespace gladstone {

std::vector<WindowSetup> read_windows(SetupTable root) {
  std::vector<WindowSetup> windows;
  for (SetupTable table : root.tables("window")) {
    WindowSetup window;
    if (table.word("side", "camera", {"camera", "target"}) == "target") window.side = WindowSide::target;
    window.glass = table.text("glass", "N-BK7");
    window.thickness = table.number("thickness_mm", 10.0, Range::positive(1e4)) * unit::millimetre;
    auto const position = table.numbers("position_mm", {0, 0, 0}, 3);
    if (!table.has("position_mm")) table.problem("position_mm", "is missing (the centre of the window); add it");
    if (position.size() == 3) window.position = Vec3d{position[0], position[1], position[2]} * unit::millimetre;
    auto const tilt = table.numbers("tilt_deg", {0, 0}, 2, {-80, 80});
    if (tilt.size() == 2) window.tilt = Vec2d{tilt[0], tilt[1]} * unit::degree;
    table.pass_over("cameras");  // those that look through it, where there are several
    windows.push_back(window);
  }
  return windows;
}

}  // namespace gladstone
