#include "render/optics/window.h"

#include "render/base/units.h"

namespace gladstone {

std::vector<WindowSetup> read_windows(SetupTable root) {
  std::vector<WindowSetup> windows;
  for (SetupTable table : root.tables("window")) {
    WindowSetup window;
    window.side = table.choice("side", window.side, {{"camera", WindowSide::camera}, {"target", WindowSide::target}});
    window.glass = table.text("glass", "N-BK7");
    window.thickness = table.number("thickness_mm", 10.0, Range::positive(1e4)) * unit::millimetre;
    window.position = table.quantities("position_mm", window.position, unit::millimetre);
    if (!table.has("position_mm"))
      table.problem("position_mm", "is missing (the centre of the window); add it", ErrorCode::missing_key);
    window.tilt = table.quantities("tilt_deg", window.tilt, unit::degree, {-80, 80});
    table.mark_as_read("cameras");  // the cameras that look through it, in setups with several
    windows.push_back(window);
  }
  return windows;
}

}  // namespace gladstone
