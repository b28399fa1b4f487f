#include "render/optics/lenslet_array.h"

#include "render/base/units.h"

namespace gladstone {

std::optional<LensletSetup> read_lenslets(SetupTable table) {
  if (!table.present()) return std::nullopt;
  LensletSetup setup;
  Range const length = Range::positive(1e6);
  setup.pitch = table.required_number("pitch_um", length) * unit::micrometre;
  if (table.has("radius_um") || table.has("index")) {
    table.refuse("focal_length_um",
                 "conflicts with radius_um and index (which determine it); remove it, or both of them");
    double const radius = table.required_number("radius_um", length) * unit::micrometre;
    setup.focal_length = radius / (table.required_number("index", {1, 5, true, false}) - 1);
  } else {
    setup.focal_length = table.required_number("focal_length_um", length) * unit::micrometre;
  }
  setup.to_sensor = table.number("distance_um", setup.focal_length / unit::micrometre, length) * unit::micrometre;
  setup.layout = table.choice("layout", setup.layout,
                              {{"square", LensletLayout::square}, {"hexagonal", LensletLayout::hexagonal}});
  return setup;
}

}  // namespace gladstone
