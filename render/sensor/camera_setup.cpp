#include "render/sensor/camera_setup.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <limits>

#include "render/base/units.h"

namespace gladstone::inline sensor {
namespace {

constexpr double max_background = 0.8;  // largest background as a fraction of the full well
constexpr long long largest_seed = std::numeric_limits<long long>::max();

void read_pattern(SetupTable& noise, NoiseSetup& setup) {
  setup.prnu = noise.number("prnu_percent", 100 * setup.prnu, Range::at_least(0.0, 30.0)) / 100;
  setup.dsnu_e = noise.number("dsnu_e", setup.dsnu_e, Range::at_least(0.0, 1e6));
  setup.hot_pixel_share = noise.number("hot_pixel_share", setup.hot_pixel_share, Range::at_least(0.0, 1.0));
  setup.hot_pixel_e = noise.number("hot_pixel_e", 0.25 * setup.full_well_e, Range::at_least(0.0, 1e9));
  setup.pattern_seed = static_cast<std::uint64_t>(
      noise.integer("pattern_seed", static_cast<long long>(setup.pattern_seed), 0, largest_seed));
}

BackgroundSetup read_background(SetupTable table, double full_well_e) {
  BackgroundSetup setup;
  setup.level_e = table.number("level_e", setup.level_e, Range::at_least(0.0, 1e9));
  setup.gradient_e = table.quantities("gradient_e", setup.gradient_e, 1.0, {-1e9, 1e9});
  if (table.has("glare_file")) {
    setup.glare_file = table.required_path("glare_file");
    if (std::error_code error; !setup.glare_file.empty() && !std::filesystem::exists(setup.glare_file, error)) {
      table.problem(
          "glare_file",
          "file not found: " + setup.glare_file + "; relative names are resolved against the setup file's folder",
          ErrorCode::missing_file);
    }
    setup.glare_e = table.number("glare_e", 0.1 * full_well_e, Range::positive(1e9));
  } else {
    table.refuse("glare_e", "has no effect without glare_file; add glare_file or remove this key");
  }
  if (setup.most_e() > max_background * full_well_e) {
    table.problem("level_e", fmt::format("gives, with gradient and glare, a background of up to {:.6g} electrons (the "
                                         "limit is {:.6g}, {} of camera.noise.full_well_e); lower it",
                                         setup.most_e(), max_background * full_well_e, max_background));
  }
  return setup;
}

}  // namespace

CameraSetup read_camera_setup(SetupTable table) {
  CameraSetup setup;
  if (table.has("name")) table.text("name", "");  // used only if there are several cameras, as name of a folder
  auto const pixels = table.integers("pixels", {setup.columns, setup.rows}, 2, 2, 1, 1000000);
  if (pixels.size() == 2) {
    setup.columns = static_cast<int>(pixels[0]);
    setup.rows = static_cast<int>(pixels[1]);
  }
  setup.pixel_pitch = table.quantity("pixel_pitch_um", setup.pixel_pitch, unit::micrometre, Range::positive(1e4));
  setup.bit_depth = static_cast<int>(table.integer("bit_depth", setup.bit_depth, 1, 16));
  auto const exposure =
      table.number_or_word("exposure", {std::nullopt, "auto"}, {"auto", "absolute"}, Range::positive());
  setup.exposure_e = exposure.number;
  setup.absolute_exposure = exposure.word == "absolute";
  double const full_scale = std::pow(2.0, setup.bit_depth) - 1;
  setup.offset_dn = table.number("offset_dn", setup.offset_dn, Range::at_least(0.0, 0.8 * full_scale));

  if (SetupTable sensor = table.table("sensor"); sensor.present()) {
    setup.tilt = sensor.quantities("tilt_deg", setup.tilt, unit::degree, {-80, 80});
    setup.scheimpflug = sensor.word("scheimpflug", "off", {"off", "auto"}) == "auto";
    if (setup.scheimpflug && sensor.has("tilt_deg") && !(setup.tilt == Vec2d{})) {
      sensor.problem("scheimpflug", "conflicts with tilt_deg (both tilt the sensor); remove one");
    }
    auto const brown = sensor.numbers("distortion", {0, 0, 0, 0}, 4, {-100, 100});
    if (brown.size() == 4) setup.distortion = {brown[0], brown[1], brown[2], brown[3]};
  }

  SetupTable noise = table.table("noise");
  setup.noise.enabled = noise.present();
  if (setup.noise.enabled) {
    setup.noise.full_well_e = noise.number("full_well_e", setup.noise.full_well_e, Range::at_least(1.0, 1e9));
    setup.noise.read_noise_e = noise.number("read_noise_e", setup.noise.read_noise_e, Range::at_least(0.0, 1e6));
    if (setup.noise.read_noise_e > setup.noise.full_well_e) {
      noise.problem("read_noise_e",
                    fmt::format("exceeds the full well of {:.6g} electrons; give the standard deviation of a dark "
                                "pixel, a few electrons for most cameras",
                                setup.noise.full_well_e));
    }
    setup.noise.dark_current_e = noise.number("dark_current_e", setup.noise.dark_current_e, Range::at_least(0.0, 1e9));
    Range efficiency = Range::positive(1.0);
    setup.noise.quantum_efficiency = noise.number("quantum_efficiency", setup.noise.quantum_efficiency, efficiency);
    setup.noise.shot_noise = noise.boolean("shot_noise", setup.noise.shot_noise);
    setup.noise.seed =
        static_cast<std::uint64_t>(noise.integer("seed", static_cast<long long>(setup.noise.seed), 0, largest_seed));
    read_pattern(noise, setup.noise);
  }
  setup.background = read_background(table.table("background"), setup.noise.full_well_e);
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
  // Grey levels are integers: sum the probabilities of falling below each of them.
  if (sigma < 100) {
    double sum = 0;
    for (double level = -0.5; level > black - 9 * sigma; --level) sum += below(level);
    return sum;
  }
  double const t = black / sigma;
  return sigma * std::exp(-0.5 * t * t) / std::sqrt(2 * pi) - black * below(0);
}

}  // namespace gladstone::inline sensor
