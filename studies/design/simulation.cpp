#include "studies/design/simulation.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "studies/design/simulated_repeats.h"
#include "studies/sweep/plan.h"

namespace gladstone::inline design {
namespace {

constexpr double wave_strain = 0.02;   ///< strain of the image caused by the simulated wave: the largest strain in the
                                       ///< study of the estimator
constexpr double shorter_wave = 0.85;  ///< wavelength of the shorter wave, relative to the one resolved by formula
/// dots whose image centre is this close to a pixel's centre are used for the peak
constexpr double near_centre_px = 0.15;

SetupNode wave_field(DesignPoint<double> const& bench, double wavelength) {
  double const length_px = wavelength / bench.pixel_at_medium();
  double const displacement_px = wave_strain * length_px / (2 * pi);
  double const amplitude = displacement_px / bench.sensitivity() * wavelength / (2 * pi);
  SetupNode field;
  field.members.push_back({"kind", setup_text("sinusoid")});
  field.members.push_back({"amplitude_kg_m3", setup_number(amplitude)});
  field.members.push_back({"wavelength_mm", setup_number(wavelength / unit::millimetre)});
  return field;
}

AxisValue value_of(char const* label, SetupNode node) {
  AxisValue value;
  value.parameter.label = label;
  value.node = std::move(node);
  return value;
}

/// Studies of a design's setup, reduced to the central part of the image and repeated with other dots, rays and noise.
struct BenchStudies {
  SetupDocument base;
  std::size_t repeats;
  std::uint64_t seed;

  /// @param rays  number of rays per dot; nullopt: "auto"
  StudyFile of(std::vector<AxisValue> media, std::optional<std::uint64_t> rays) const {
    SetupDocument setup = base.copy();
    if (rays) setup.set({"render", "rays_per_dot"}, setup_integer(static_cast<long long>(*rays)));
    StudyFile study;
    study.path = study.base_path = "recommended setup";
    study.base = std::make_shared<SetupDocument const>(std::move(setup));
    AxisPlan& medium = study.axes.emplace_back();
    medium.key = "medium.field";
    medium.path = {"medium", "field"};
    medium.list = std::move(media);
    study.repeats = repeats;
    study.seed = seed;
    return study;
  }
  AxisValue own_medium() const {
    SetupNode none;
    none.members.push_back({"kind", setup_text("none")});
    SetupNode const* const own = base.find({"medium", "field"});
    return value_of("as set up", own ? *own : none);
  }
};

BenchStudies make_studies(SetupDocument const& setup, DesignPoint<double> const& bench, std::size_t repeats,
                          std::uint64_t seed) {
  SetupDocument base = setup.copy();
  CameraSetup const& camera = bench.given->camera;
  int const side =
      std::max(3 * bench.given->first_window_px,
               std::clamp(simulated_windows * bench.given->window.window_px(), least_simulated_px, most_simulated_px));
  int const columns = std::min(camera.columns, side), rows = std::min(camera.rows, side);
  base.set({"camera", "pixels"}, setup_array({setup_integer(columns), setup_integer(rows)}));
  // the waves have the thickness of the setup's medium
  base.set({"medium", "thickness_mm"}, setup_number(bench.given->thickness / unit::millimetre));
  return {std::move(base), repeats, seed};
}

/// Returns the wavelength at which the measured amplitude is 1/sqrt(2), by linear interpolation or extrapolation in the
/// logarithm of the wavelength.
Estimate interpolate_resolution(std::vector<WaveShares> const& waves) {
  WaveShares const &a = waves[0], &b = waves[1];
  double const slope = (a.measured.value - b.measured.value) / std::log(a.wavelength / b.wavelength);
  if (!(slope > 0)) return {};
  double const x = (transfer_at_resolution - a.measured.value) / slope;
  // Propagate the errors of both waves, weighted by their distance from the crossing.
  double const part = x / std::log(b.wavelength / a.wavelength);
  double const error = std::hypot((1 - part) * a.measured.standard_error, part * b.measured.standard_error) / slope;
  double const value = a.wavelength * std::exp(x);
  return {value, value * error};
}

/// Electrons in the central pixel of dots that are centred on a pixel, in the reference image.
struct Peaks {
  double sum = 0, squares = 0;
  std::size_t count = 0;

  void add(ObservedCase const& seen) {
    CameraSetup const& camera = seen.prepared.scene.setup.camera;
    double const per_level = camera.noise.full_well_e / (std::pow(2.0, camera.bit_depth) - 1);
    Image<double> const& levels = seen.frames.levels->reference();
    for (Vec2d const place : seen.rendered.rendering->truth.reference_px) {
      Vec2d const pixel{std::round(place.x), std::round(place.y)};
      if (!(length(place - pixel) < near_centre_px)) continue;
      if (pixel.x < 0 || pixel.y < 0 || pixel.x >= levels.columns() || pixel.y >= levels.rows()) continue;
      double const level = levels(static_cast<int>(pixel.x), static_cast<int>(pixel.y));
      double const electrons = (level - camera.offset_dn) * per_level;
      sum += electrons;
      squares += electrons * electrons;
      ++count;
    }
  }
  Estimate mean() const {
    if (count < 2) return {};
    auto const n = static_cast<double>(count);
    double const value = sum / n;
    return {value, std::sqrt(std::max(0.0, squares / n - value * value) / (n - 1))};
  }
};

}  // namespace

int compared_apart_px(DesignPoint<double> const& bench) { return bench.given->window.window_px() / 2; }

SimulatedDesign simulate(SetupDocument const& setup, DesignPoint<double> const& bench, std::size_t repeat_count,
                         std::uint64_t seed, CaseRunner& runner, std::string const& device,
                         std::function<void()> const& finished) {
  SimulatedDesign simulated;
  int const window_px = bench.given->window.window_px();
  auto const run = [&](StudyFile const& study, std::vector<Repeats>& repeats, Peaks* peaks) {
    StudyPlan const plan = plan_study(study, device);
    repeats.resize(study.points());
    for (std::size_t i = 0; i < plan.size(); ++i) {
      CaseResult const result = runner.run(plan[i], "", [&](ObservedCase const& seen) {
        enter(repeats[i % repeats.size()], seen, window_px);
        if (peaks) peaks->add(seen);
      });
      finished();
      if (result.status != CaseStatus::ok) simulated.failed = result.error;
      if (!simulated.failed.empty()) return;
    }
  };
  BenchStudies const studies = make_studies(setup, bench, repeat_count, seed);
  std::vector<Repeats> as_set_up, waves;
  Peaks peaks;
  run(studies.of({studies.own_medium()}, std::nullopt), as_set_up, &peaks);
  if (!simulated.failed.empty()) return simulated;
  // Waves are smooth; if the setup's medium is smooth too, its number of rays for correcting the deflection table
  // suffices.
  double const wavelength = resolved_wavelength(bench);
  std::vector<AxisValue> media;
  for (double const share : {1.0, shorter_wave}) {
    media.push_back(value_of("wave", wave_field(bench, share * wavelength)));
  }
  run(studies.of(std::move(media), as_set_up.front().rays), waves, nullptr);
  if (!simulated.failed.empty()) return simulated;
  Repeats const& own = as_set_up.front();
  simulated.columns = own.setup->camera.columns;
  simulated.rows = own.setup->camera.rows;
  simulated.repeats = repeat_count;
  simulated.magnification = own.magnification;
  simulated.displacement_px = own.displacement_px;
  simulated.peak_electrons = peaks.mean();
  add_errors(simulated, own, bench);
  simulated.waves = {compute_wave_shares(waves[0], wavelength, window_px),
                     compute_wave_shares(waves[1], shorter_wave * wavelength, window_px)};
  simulated.resolution = interpolate_resolution(simulated.waves);
  return simulated;
}

}  // namespace gladstone::inline design
