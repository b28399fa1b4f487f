#include "studies/design/simulation.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "studies/budget_stages.h"
#include "studies/design/predicted_blur.h"
#include "studies/scene_renderer.h"
#include "studies/sweep/plan.h"

namespace gladstone {
namespace {

constexpr double wave_strain = 0.02;     ///< of the image, by a wave: as in the estimator's study at most
constexpr double shorter_wave = 0.85;    ///< of the wavelength that the formulas resolve
constexpr double near_centre_px = 0.15;  ///< dots whose image lies so near a pixel's middle tell the peak
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

SetupNode wave_field(Bench<double> const& bench, double wavelength) {
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

/// The bench's setup with the middle of its camera alone, repeated with other dots, rays and noise.
struct BenchStudies {
  SetupDocument base;
  std::size_t repeats;
  std::uint64_t seed;

  /// @param rays of a dot; nothing: "auto"
  StudyFile of(std::vector<AxisValue> media, std::optional<std::uint64_t> rays) const {
    SetupDocument setup = base.copy();
    if (rays) setup.set({"render", "rays_per_dot"}, setup_integer(static_cast<long long>(*rays)));
    StudyFile study;
    study.path = study.base_path = "recommended setup";
    study.base_text = setup.written();
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

BenchStudies studies_of(std::string const& setup, Bench<double> const& bench, std::size_t repeats, std::uint64_t seed) {
  SetupDocument base = SetupDocument::from_text(setup, "recommended setup");
  CameraSetup const& camera = bench.given->camera;
  int const side =
      std::max(3 * bench.given->first_window_px,
               std::clamp(simulated_windows * bench.given->window.window_px(), least_simulated_px, most_simulated_px));
  int const columns = std::min(camera.columns, side), rows = std::min(camera.rows, side);
  base.set({"camera", "pixels"}, setup_array({setup_integer(columns), setup_integer(rows)}));
  return {std::move(base), repeats, seed};
}

/// What is kept of the repeats of one medium, at the vectors of the grid.
struct Repeats {
  std::vector<Vec2d> place, eq9;
  std::vector<std::vector<Vec2d>> error;         ///< of each: measured less Eq. 9; NaN where one does not count
  std::vector<std::vector<BudgetStage>> causes;  ///< of each: budget_differences()
  std::vector<Vec2d> cone, refraction, lens;     ///< displacements of the first
  double displacement_px = 0;
  std::optional<Setup> setup;
  double magnification = 0;
  std::optional<std::uint64_t> rays;  ///< that correct a plain table; nothing where dots take what they need
};

bool inside(Vec2d place, Setup const& setup, double border) {
  return place.x >= border && place.y >= border && place.x <= setup.camera.columns - 1 - border &&
         place.y <= setup.camera.rows - 1 - border;
}

void enter(Repeats& repeats, ObservedCase const& seen, double border) {
  Comparison const& all = seen.comparison;
  if (repeats.error.empty()) {
    repeats.place = all.measured.position_px;
    repeats.eq9 = all.point.eq9_px;
    repeats.cone = all.point.eq9_cone_px;
    repeats.refraction = all.thin_lens;
    repeats.lens = all.point.displacement_px;
    repeats.setup = seen.prepared.scene.setup;
    repeats.magnification = seen.prepared.scene.imaging.magnification;
    RaysPlan const& plan = seen.prepared.rays;
    bool const plain = method_of(seen.prepared.scene) == RenderMethod::focused_dots && plan.fineness == 1;
    if (plain && !plan.by_need) repeats.rays = plan.rays;
  }
  std::vector<Vec2d>& error = repeats.error.emplace_back(all.mask.size(), Vec2d{nan, nan});
  for (std::size_t i = 0; i < all.mask.size(); ++i) {
    if (!all.mask[i] || !inside(all.measured.position_px[i], seen.prepared.scene.setup, border)) continue;
    error[i] = all.measured.displacement_px[i] - all.point.eq9_px[i];
    repeats.displacement_px = std::max(repeats.displacement_px, length(all.point.displacement_px[i]));
  }
  repeats.causes.push_back(budget_differences(all));
}

/// Mean over the repeats where all of them count; NaN elsewhere.
std::vector<Vec2d> mean_of(std::vector<std::vector<Vec2d>> const& repeats) {
  std::vector<Vec2d> mean(repeats.front().size());
  for (auto const& one : repeats) {
    for (std::size_t i = 0; i < mean.size(); ++i) mean[i] += one[i] / static_cast<double>(repeats.size());
  }
  return mean;
}

bool finite(Vec2d a) { return std::isfinite(a.x) && std::isfinite(a.y); }

/// Root mean square over the components of the vectors that count.
double rms_of(std::vector<Vec2d> const& values, std::vector<Vec2d> const& counts) {
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!finite(counts[i]) || !finite(values[i])) continue;
    sum += dot(values[i], values[i]);
    count += 2;
  }
  return count > 0 ? std::sqrt(sum / static_cast<double>(count)) : nan;
}

/// How many vectors of a grid share what one window measures: windows overlap.
double vectors_per_window(std::vector<Vec2d> const& place, int window_px) {
  double spacing = window_px;
  for (std::size_t i = 1; i < place.size(); ++i) {
    double const step = place[i].x - place[i - 1].x;
    if (step > 0) spacing = std::min(spacing, step);
  }
  double const across = window_px / spacing;
  return std::max(1.0, across * across);
}

/// A budget's term of one repeat; nothing where it is not known.
std::vector<Vec2d> term_of(Repeats const& repeats, std::size_t repeat, std::string const& name) {
  for (BudgetStage const& stage : repeats.causes[repeat]) {
    if (stage.name == name) return stage.displacement_px;
  }
  return std::vector<Vec2d>(repeats.place.size());
}

std::vector<Vec2d> mean_term(Repeats const& repeats, std::string const& name) {
  std::vector<std::vector<Vec2d>> terms;
  for (std::size_t k = 0; k < repeats.causes.size(); ++k) terms.push_back(term_of(repeats, k, name));
  return mean_of(terms);
}

std::vector<Vec2d> sum_of(std::vector<Vec2d> a, std::vector<Vec2d> const& b, double sign) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] += sign * b[i];
  return a;
}

/// Random and systematic error over repeats, after RepeatSplit; the systematic one's error in the limit of many
/// windows: its square has a standard deviation of sqrt((v^2 + 2 b^2 v) / n), v the variance of a mean over repeats,
/// n = 2 N components over independent windows.
void add_errors(SimulatedBench& bench, Repeats const& repeats, Bench<double> const& formulas) {
  RepeatSplit const split = split_repeats(repeats.error);
  bench.vectors = split.vectors;
  auto const count = static_cast<double>(repeats.error.size());
  double const independent = std::max(1.0, 2 * static_cast<double>(split.vectors) /
                                               vectors_per_window(repeats.place, formulas.given->window.window_px()));
  bench.random_px = {split.scatter_px, split.scatter_px / std::sqrt(2 * independent * (count - 1))};
  double const variance = split.scatter_px * split.scatter_px / count,
               bias2 = split.systematic_px * split.systematic_px;
  double const error2 = std::sqrt((variance * variance + 2 * bias2 * variance) * 2 / independent);
  bench.bias_px = {split.systematic_px, std::sqrt(bias2 + error2) - split.systematic_px};
  std::vector<Vec2d> const counts = mean_of(repeats.error);
  PredictedBlur const blur = predicted_blur(*repeats.setup, formulas, repeats.place);
  bench.predicted_bias_px = rms_of(blur.whole_px, counts);
  std::vector<std::vector<Vec2d>> window;  // what the estimator's term has of the patterns is none of the window's
  for (std::size_t k = 0; k < repeats.error.size(); ++k) {
    window.push_back(sum_of(term_of(repeats, k, "window"), term_of(repeats, k, "estimator"), 1));
    for (std::size_t i = 0; i < counts.size(); ++i) window[k][i] += 0.0 * counts[i];  // NaN where one does not count
  }
  bench.causes = {
      {"cone", rms_of(mean_term(repeats, "cone"), counts), rms_of(blur.cone_px, counts)},
      {"window", split_repeats(window).systematic_px, rms_of(sum_of(blur.whole_px, blur.cone_px, -1), counts)},
      {"refraction", rms_of(mean_term(repeats, "refraction"), counts), 0},
      {"aberration", rms_of(mean_term(repeats, "aberration"), counts), 0},
      {"small_angle", rms_of(mean_term(repeats, "small_angle"), counts), 0}};
}

/// Share of Eq. 9 that a displacement has, by least squares over the vectors that count.
double share_of(std::vector<Vec2d> const& displacement, Repeats const& repeats, std::vector<Vec2d> const& counts) {
  double product = 0, square = 0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (!finite(counts[i])) continue;
    product += dot(displacement[i], repeats.eq9[i]);
    square += dot(repeats.eq9[i], repeats.eq9[i]);
  }
  return product / square;
}

WaveShares shares_of(Repeats const& repeats, double wavelength, int window_px) {
  std::vector<Vec2d> const error = mean_of(repeats.error);
  WaveShares shares;
  shares.wavelength = wavelength;
  shares.cone = share_of(repeats.cone, repeats, error);
  shares.refraction = share_of(repeats.refraction, repeats, error);
  shares.lens = share_of(repeats.lens, repeats, error);
  shares.measured.value = 1 + share_of(error, repeats, error);
  // noise along the wave: scatter of a mean over repeats, by as many independent windows as there are
  double square = 0;
  for (std::size_t i = 0; i < error.size(); ++i) square += finite(error[i]) ? dot(repeats.eq9[i], repeats.eq9[i]) : 0;
  double const scatter = split_repeats(repeats.error).scatter_px;
  shares.measured.standard_error = scatter * std::sqrt(vectors_per_window(repeats.place, window_px) / square /
                                                       static_cast<double>(repeats.error.size()));
  return shares;
}

/// Where the measured share crosses 1/sqrt(2), linear in the wavelength's logarithm between the waves and beyond them.
Estimate resolution_of(std::vector<WaveShares> const& waves) {
  WaveShares const &a = waves[0], &b = waves[1];
  double const slope = (a.measured.value - b.measured.value) / std::log(a.wavelength / b.wavelength);
  if (!(slope > 0)) return {};
  double const x = (transfer_at_resolution - a.measured.value) / slope;
  // the error of a straight line's crossing: each wave's, by its share of it
  double const part = x / std::log(b.wavelength / a.wavelength);
  double const error = std::hypot((1 - part) * a.measured.standard_error, part * b.measured.standard_error) / slope;
  double const value = a.wavelength * std::exp(x);
  return {value, value * error};
}

/// Electrons at the pixel of dots whose image lies in its middle, in the reference frame.
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

int compared_apart_px(Bench<double> const& bench) { return bench.given->window.window_px() / 2; }

SimulatedBench simulate(std::string const& setup, Bench<double> const& bench, std::size_t repeat_count,
                        std::uint64_t seed, CaseRunner& runner, std::string const& device,
                        std::function<void()> const& finished) {
  SimulatedBench simulated;
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
  BenchStudies const studies = studies_of(setup, bench, repeat_count, seed);
  std::vector<Repeats> as_set_up, waves;
  Peaks peaks;
  run(studies.of({studies.own_medium()}, std::nullopt), as_set_up, &peaks);
  if (!simulated.failed.empty()) return simulated;
  // waves are smooth: where the medium is, too, what corrects its table corrects theirs
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
  simulated.waves = {shares_of(waves[0], wavelength, window_px),
                     shares_of(waves[1], shorter_wave * wavelength, window_px)};
  simulated.resolution = resolution_of(simulated.waves);
  return simulated;
}

}  // namespace gladstone
