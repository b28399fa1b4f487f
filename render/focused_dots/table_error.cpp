#include "render/focused_dots/table_error.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "render/base/parallel.h"
#include "render/base/progress.h"
#include "render/focused_dots/deflection_map.h"
#include "render/focused_dots/lone_dot.h"
#include "render/focused_dots/owned_dot_model.h"

namespace gladstone::inline focused_dots {
namespace {

constexpr std::size_t place_count = 16;
/// Rays are added until errors and detection limits are within this fraction of the tolerances.
constexpr double sufficient_excess = 0.75;

/// Returns the van der Corput sequence in base 2 (1935): the bits of i mirrored at the binary point.
double mirrored(std::size_t i) {
  double found = 0;
  for (double digit = 0.5; i > 0; i /= 2, digit /= 2) found += digit * static_cast<double>(i % 2);
  return found;
}

/// Deviation of a rendered quantity, from the differences of independent samples of rays.
struct Deviation {
  double square = 0;    ///< squared deviation without the scatter of the samples; unbiased, and hence negative at times
  double variance = 0;  ///< variance of a single sample

  /// @param sample  returns the difference of sample k
  template <class Sample>
  static Deviation of(Sample const& sample) {
    double mean = 0, squares = 0;
    for (int k = 0; k < LoneDot::sample_count; ++k) mean += sample(k) / LoneDot::sample_count;
    for (int k = 0; k < LoneDot::sample_count; ++k) squares += (sample(k) - mean) * (sample(k) - mean);
    double const variance = squares / (LoneDot::sample_count - 1);
    return {mean * mean - variance / LoneDot::sample_count, variance};
  }
  Deviation& operator+=(Deviation const& o) {
    square += o.square;
    variance += o.variance;
    return *this;
  }
  /// Returns the root of a mean of `count` squared deviations.
  double rms(double count) const { return std::sqrt(std::max(square, 0.0) / count); }
  /// Returns the detection limit of rms(): the root of two standard errors of the mean at zero deviation. With k
  /// samples of variance v, the squared mean has the variance 2 v^2 / k^2 and v / k that of 2 v^2 / (k^2 (k - 1));
  /// their sum is 2 v^2 / (k (k - 1)).
  /// @param independent  number of independent values among `count`
  double detection_limit(double count, double independent) const {
    double const of_one = std::sqrt(2.0 / (LoneDot::sample_count * (LoneDot::sample_count - 1)));
    return std::sqrt(2 * of_one * variance / count / std::sqrt(independent));
  }
};

using LoneDots = std::vector<std::unique_ptr<LoneDot>>;

/// Sums over the lit pixels of lone dots in one image.
struct LitPixels {
  Deviation light;
  double count = 0;
};
LitPixels sum_lit_pixels(LoneDots const& lone, std::size_t frame, double threshold) {
  LitPixels lit;
  for (auto const& dot : lone) {
    std::size_t const area = dot->light().size() / frame_count, first = frame * area;
    for (std::size_t i = first; i < first + area; ++i) {
      if (dot->light()[i] < threshold) continue;
      lit.light += Deviation::of([&](int k) { return dot->difference(k).light[i]; });
      ++lit.count;
    }
  }
  return lit;
}

/// Returns the light of one grey level at error_bit_depth(). For "auto" exposure, the brightest pixel is at 90 % of
/// full scale.
/// @param density  number of overlapping dots per pixel, the squares of an image target [1/px^2]; 0: lone dots
double light_of_a_level(LoneDots const& lone, CameraSetup const& camera, double density) {
  if (camera.exposure_e) return light_per_level(camera, *camera.exposure_e);
  double brightest = 0;
  for (std::size_t frame = 0; frame < frame_count; ++frame) {
    double sum = 0, squares = 0;  // mean over dots of the light, and of its square, added up over pixels
    for (auto const& dot : lone) {
      std::size_t const area = dot->light().size() / frame_count;
      for (std::size_t i = frame * area; i < (frame + 1) * area; ++i) {
        double const light = dot->light()[i];
        brightest = std::max(brightest, light);
        sum += light / static_cast<double>(lone.size());
        squares += light * light / static_cast<double>(lone.size());
      }
    }
    // mean plus three standard deviations of the light of overlapping dots (Campbell's theorem)
    brightest = std::max(brightest, density * sum + 3 * std::sqrt(density * squares));
  }
  return brightest / (0.9 * (std::exp2(error_bit_depth(camera)) - 1));
}

/// Computes errors and detection limits from lone dots that were compared with rays.
void compute_errors(TableError& error, LoneDots const& lone, CameraSetup const& camera, double density) {
  auto const dots = static_cast<double>(lone.size());
  Deviation displacement;
  double components = 0;
  for (auto const& dot : lone) {
    for (double Vec2d::*const component : {&Vec2d::x, &Vec2d::y}) {
      Deviation const found = Deviation::of([&](int k) { return dot->difference(k).displacement.*component; });
      if (std::isnan(found.square)) continue;  // no ray of a sample passes
      displacement += found;
      ++components;
    }
  }
  error.truth_px = displacement.rms(components);
  error.truth_resolution_px = displacement.detection_limit(components, components);
  double const level = light_of_a_level(lone, camera, density);
  error.image_levels = not_measured;
  error.image_resolution_levels = 0;
  for (std::size_t frame = 0; frame < frame_count; ++frame) {
    LitPixels const lit = sum_lit_pixels(lone, frame, level);
    // With n dots per pixel of k lit pixels each, the lit fraction of the image is 1 - exp(-n k).
    double const per_dot = lit.count / dots;
    double const pixels = density > 0 ? -std::expm1(-density * per_dot) / density * dots : lit.count;
    if (!(pixels > 0)) continue;
    // the pixels of a dot count as one independent value
    error.image_levels = std::fmax(error.image_levels, lit.light.rms(pixels) / level);
    error.image_resolution_levels =
        std::max(error.image_resolution_levels, lit.light.detection_limit(pixels, dots) / level);
  }
}

/// Returns 16 positions spread over the view, independent of the scene's dots [m]. No two are in the same sixteenth of
/// the view's width or height.
std::vector<Vec2d> measured_places(Scene const& scene) {
  CameraSetup const& camera = scene.setup.camera;
  std::vector<Vec2d> places;
  for (std::size_t i = 0; i < place_count; ++i) {
    double const x = (static_cast<double>(i) + 0.5) / place_count, y = mirrored(i) + 0.5 / place_count;
    places.push_back(scene.to_target({x * camera.columns - 0.5, y * camera.rows - 0.5}));
  }
  return places;
}

}  // namespace

TableError measure_table_error(FocusedDots const& dots) {
  Scene const& scene = dots.scene();
  TableError error;
  error.fineness = dots.plan().fineness;
  error.bits = error_bit_depth(scene.setup.camera);
  double const px = scene.imaging.magnification / scene.setup.camera.pixel_pitch;
  double const pitch_px = 2 * scene.dots.half_size * px;  // pitch of an image target's pixels, which are adjacent
  double const density = scene.dots.shape == SourceShape::square ? 1 / (pitch_px * pitch_px) : 0;
  int const side =
      2 * GaussianSpot<double>{scene.spot_sigma_px()}.half_width() + 49 + static_cast<int>(std::min(pitch_px, 100.0));
  std::vector<Vec2d> const places = measured_places(scene);
  LoneDots lone(places.size());
  Progress progress("measuring the table", lone.size());
  parallel_for(lone.size(), [&](std::size_t i) {
    lone[i] = std::make_unique<LoneDot>(dots, places[i], side);
    progress.advance();
  });
  std::erase_if(lone, [](auto const& dot) { return dot->is_uncovered(); });
  if (lone.empty()) return error;
  for (int const rays : {LoneDot::largest_sample / 4, LoneDot::largest_sample / 2, LoneDot::largest_sample}) {
    parallel_for(lone.size(), [&](std::size_t i) { lone[i]->compare_with_rays(rays); });
    compute_errors(error, lone, scene.setup.camera, density);
    if (error.excess() <= sufficient_excess) break;
  }
  return error;
}

double table_seconds(FocusedDots const& dots) {
  Scene const& scene = dots.scene();
  DeflectionTableLayout const layout(dots, scene.dots, DeflectionTableLayout::default_aim_distance(scene.imaging));
  if (!layout.wanted()) return 0;
  double const of_table = 4.0 * static_cast<double>(layout.table.fours());
  double const measured = static_cast<double>(place_count) * LoneDot::sample_count * LoneDot::largest_sample /
                          LoneDot::predicted_per_traced;
  return (of_table + measured) * ray_seconds(scene, dots.plan());
}

double dots_seconds(FocusedDots const& dots, RenderTheory theory) {
  constexpr double a_node = 0.1e-6;  // time of the table look-ups at one node of a light cone [s]
  Scene const& scene = dots.scene();
  DeflectionTableLayout const layout(dots, scene.dots, DeflectionTableLayout::default_aim_distance(scene.imaging));
  if (layout.state == TableState::no_medium) return 0;
  OwnedDotModel const owned(dots, scene.dots, layout.table, false);
  double const nodes = static_cast<double>(owned.model.cone.count) * owned.model.places.count;
  double const of_node =
      (layout.wanted() ? a_node : 0) + (theory == RenderTheory::yes ? theory_ray_seconds(scene, dots.plan()) : 0);
  double const of_dot = static_cast<double>(dots.plan().rays) * ray_seconds(scene, dots.plan()) + nodes * of_node;
  return table_seconds(dots) + static_cast<double>(scene.source_count()) * of_dot;
}

RenderPlan plan_rays_by_table(FocusedDots const& dots) {
  RenderPlan plan = dots.plan();
  if (plan.given_rays) {
    plan.rays = *plan.given_rays;
    return plan;
  }
  auto const measure = [&] { return measure_table_error(build_focused_dots(dots.scene(), plan).value()); };
  plan.rays = initial_table_rays;
  plan.table_error = measure();
  if (plan.table_error->excess() <= 1) return plan;
  plan.rays = refined_table_rays;
  plan.fineness = 2;
  plan.table_error = measure();
  return plan;
}

}  // namespace gladstone::inline focused_dots
