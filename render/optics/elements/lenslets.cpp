#include "render/optics/elements/lenslets.h"

#include <fmt/format.h>

#include "render/base/units.h"
#include "render/optics/lens_setup.h"

namespace gladstone::inline optics {

LensletSetup LensletSetup::read(SetupTable& table) {
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

std::optional<Warning> LensletSetup::imaging_warning(ImagingGeometry const& imaging, double f_number) const {
  double const picture = to_sensor * imaging.entrance_pupil / imaging.image_distance;
  if (picture <= pitch) return {};
  return Warning{
      WarningCode::unsuitable, "lenslets",
      fmt::format("each images the stop with a diameter of {:.4g} um, more than their pitch of {:.4g} um, so that "
                  "these images overlap; stop the lens down to f/{:.3g} or use lenslets of a shorter focal length",
                  picture / unit::micrometre, pitch / unit::micrometre, f_number * picture / pitch)};
}

}  // namespace gladstone::inline optics
