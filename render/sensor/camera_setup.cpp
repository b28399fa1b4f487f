#include "render/sensor/camera_setup.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "render/base/units.h"

namespace gladstone {

CameraSetup read_camera_setup(SetupTable table) {
  CameraSetup setup;
  if (table.has("name")) table.text("name", "");  // of its folder, where there are several
  auto const pixels = table.integers("pixels", {512, 512}, 2, 2, 1, 1000000);
  if (pixels.size() == 2) {
    setup.columns = static_cast<int>(pixels[0]);
    setup.rows = static_cast<int>(pixels[1]);
  }
  setup.pixel_pitch = table.number("pixel_pitch_um", 10.0, Range::positive(1e4)) * unit::micrometre;
  setup.bit_depth = static_cast<int>(table.integer("bit_depth", 16, 1, 16));
  auto const exposure =
      table.number_or_word("exposure", {std::nullopt, "auto"}, {"auto", "absolute"}, Range::positive());
  setup.exposure_e = exposure.number;
  setup.absolute_exposure = exposure.word == "absolute";
  double const full_scale = std::pow(2.0, setup.bit_depth) - 1;
  setup.offset_dn = table.number("offset_dn", 0.0, Range::at_least(0.0, 0.8 * full_scale));

  if (SetupTable sensor = table.table("sensor"); sensor.present()) {
    auto const tilt = sensor.numbers("tilt_deg", {0, 0}, 2, {-80, 80});
    if (tilt.size() == 2) setup.tilt = Vec2d{tilt[0], tilt[1]} * unit::degree;
    setup.scheimpflug = sensor.word("scheimpflug", "off", {"off", "auto"}) == "auto";
    if (setup.scheimpflug && sensor.has("tilt_deg") && !(setup.tilt == Vec2d{})) {
      sensor.problem("scheimpflug", "stands beside tilt_deg (one of them tilts the sensor); remove one");
    }
    auto const brown = sensor.numbers("distortion", {0, 0, 0, 0}, 4, {-100, 100});
    if (brown.size() == 4) setup.distortion = {brown[0], brown[1], brown[2], brown[3]};
  }

  SetupTable noise = table.table("noise");
  setup.noise.enabled = noise.present();
  if (setup.noise.enabled) {
    setup.noise.full_well_e = noise.number("full_well_e", 30000.0, Range::at_least(1.0, 1e9));
    setup.noise.read_noise_e = noise.number("read_noise_e", 3.0, Range::at_least(0.0, 1e6));
    if (setup.noise.read_noise_e > setup.noise.full_well_e) {
      noise.problem("read_noise_e",
                    fmt::format("is more than the full well of {:.6g} electrons (nothing but noise would "
                                "be seen); give the standard deviation of a pixel in the dark, a few "
                                "electrons for most cameras",
                                setup.noise.full_well_e));
    }
    setup.noise.dark_current_e = noise.number("dark_current_e", 0.0, Range::at_least(0.0, 1e9));
    Range efficiency = Range::positive(1.0);
    setup.noise.quantum_efficiency = noise.number("quantum_efficiency", 0.6, efficiency);
    setup.noise.shot_noise = noise.boolean("shot_noise", true);
    setup.noise.seed = static_cast<std::uint64_t>(noise.integer("seed", 1, 0, std::numeric_limits<long long>::max()));
  }
  return setup;
}

double clipped_at_black(CameraSetup const& camera) {
  NoiseSetup const& noise = camera.noise;
  if (!noise.enabled) return 0;
  double const gain = (std::pow(2.0, camera.bit_depth) - 1) / noise.full_well_e;
  double const dark_variance = noise.shot_noise ? noise.dark_current_e : 0.0;
  double const sigma = gain * std::sqrt(noise.read_noise_e * noise.read_noise_e + dark_variance);
  double const black = camera.offset_dn + gain * noise.dark_current_e;
  auto const below = [&](double level) { return 0.5 * std::erfc((black - level) / (sigma * std::sqrt(2.0))); };
  // levels are whole numbers: the mean of what is cut off is the sum over them of the chance to fall short of each
  if (sigma < 100) {
    double sum = 0;
    for (double level = -0.5; level > black - 9 * sigma; --level) sum += below(level);
    return sum;
  }
  double const t = black / sigma;
  return sigma * std::exp(-0.5 * t * t) / std::sqrt(2 * pi) - black * below(0);
}

}  // namespace gladstone
