#include "studies/case/light_exposure.h"

#include "render/base/units.h"

namespace gladstone::inline cases {

std::optional<PaperLight> read_light(SetupTable root) {
  SetupTable table = root.table("light");
  if (!table.present()) return std::nullopt;
  PaperLight light;
  light.radiance = table.required_number("radiance_w_m2_sr", Range::positive());
  light.exposure_time = table.required_number("exposure_us", Range::positive()) * unit::microsecond;
  return light;
}

double exposure_from_light(PaperLight const& light, Setup const& setup) {
  ImagingGeometry const imaging = setup.imaging();
  double const working = imaging.image_distance / imaging.entrance_pupil;  // N (1 + M)
  return fully_lit_electrons(light, working, 0.0, setup.camera.pixel_pitch, setup.medium.wavelength,
                             setup.camera.noise.quantum_efficiency);
}

}  // namespace gladstone::inline cases
