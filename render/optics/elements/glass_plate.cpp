#include "render/optics/elements/glass_plate.h"

#include "render/base/units.h"

namespace gladstone::inline optics {

GlassPlate GlassPlate::read_keys(SetupTable& table) {
  GlassPlate plate;
  plate.side =
      table.choice("side", plate.side,
                   {{"camera", ElementSide::camera}, {"target", ElementSide::target}, {"sensor", ElementSide::sensor}});
  plate.glass = table.text("glass", "N-BK7");
  plate.thickness = table.number("thickness_mm", 10.0, Range::positive(1e4)) * unit::millimetre;
  plate.position = table.quantities("position_mm", plate.position, unit::millimetre);
  if (!table.has("position_mm"))
    table.problem("position_mm", "is missing (the centre of the plate); add it", ErrorCode::missing_key);
  plate.tilt = table.quantities("tilt_deg", plate.tilt, unit::degree, {-80, 80});
  return plate;
}

}  // namespace gladstone::inline optics
