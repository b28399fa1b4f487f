#include "render/focused_dots/dot_planning.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "render/base/parallel.h"
#include "render/base/random.h"
#include "render/focused_dots/deflection_map.h"
#include "render/focused_dots/dot_exposure.h"
#include "render/focused_dots/light_model.h"
#include "render/scene/ray_scatter.h"

namespace gladstone {
namespace {

constexpr int scramblings = plan_scramblings;
constexpr double widest_image_px = 100;  // of a dot that is measured whole

constexpr std::size_t checked_dots = 24;  // of these, whose table is checked by rays alone
constexpr std::uint64_t fewest_checking_rays = 1024, most_checking_rays = 16384;

template <class Medium>
Sampled sample_dot(FocusedDots const& bench, SceneView<double> view, Medium const& medium, LightModel model,
                   std::size_t dot, Window const& window) {
  Scene const& scene = bench.scene();
  // pixels are counted from the window's corner: the sensor's own first pixel moves, its axis does not
  view.sensor.columns -= 2 * window.left;
  view.sensor.rows -= 2 * window.top;
  model.image.axis_px = model.image.axis_px - Vec2d{static_cast<double>(window.left), static_cast<double>(window.top)};
  LightImage frames[frame_count] = {{window.side, window.side}, {window.side, window.side}};
  LightImage* const images[frame_count] = {&frames[0], &frames[1]};
  DotExposure exposure(model, true);
  TracePair<double, Medium> const pair{view, medium};
  exposure.begin(scene.dots.centre[dot], scene.dots.radiance_of(dot), images, bench.light_per_ray(scene.dots));
  trace_dot(pair, dot, scene.rays_per_dot, exposure);
  GroundTruth truth;
  truth.resize(1);
  exposure.finish(truth, 0);
  Sampled sampled;
  if (std::isfinite(truth.displacement_px[0].x)) sampled.displacement = truth.displacement_px[0];
  for (LightImage const& frame : frames) {
    Image<double> const light = frame.to_light();
    sampled.light.insert(sampled.light.end(), light.begin(), light.end());
  }
  return sampled;
}

/// The scene's view with other rays.
SceneView<double> scrambled(FocusedDots const& bench, int scrambling) {
  SceneView<double> view = bench.view();
  view.bundle.seed = repeat_seed(view.bundle.seed, 1000003u + static_cast<std::uint64_t>(scrambling));
  return view;
}

template <class Medium>
MeanDisplacement mean_displacement(FocusedDots const& bench, Medium const& medium, LightModel const& model,
                                   std::size_t index, std::uint64_t rays) {
  Scene const& scene = bench.scene();
  Vec2d found[scramblings];
  DotExposure exposure(model, false);
  LightImage* const no_images[frame_count] = {};
  GroundTruth truth;
  truth.resize(1);
  for (int scrambling = 0; scrambling < scramblings; ++scrambling) {
    TracePair<double, Medium> const pair{scrambled(bench, scrambling), medium};
    exposure.begin(scene.dots.centre[index], scene.dots.radiance_of(index), no_images, 0);
    trace_dot(pair, index, rays, exposure);
    exposure.finish(truth, 0);
    found[scrambling] = truth.displacement_px[0];
  }
  return MeanDisplacement::of(found);
}

/// Width of a dot's image without diffraction and medium: its disc and its blur out of focus [px].
double image_width_px(Scene const& scene) {
  double const sharp = 1 / (1 / scene.setup.lens.focal_length - 1 / scene.setup.z_b());
  double const blur = scene.imaging.entrance_pupil * std::abs(1 - scene.imaging.image_distance / sharp);
  return (2 * scene.dots.half_size * scene.imaging.magnification + blur) / scene.setup.camera.pixel_pitch;
}

/// Measures a scene's errors at its present number of rays; what does not depend on that number is made once.
class RayErrors {
 public:
  explicit RayErrors(FocusedDots const& bench)
      : bench_(bench),
        scene_(bench.scene()),
        spot_(make_spot(scene_, airy_)),
        deflections_(bench, DeflectionPlan(bench, scene_.dots)) {
    std::vector<std::size_t> const in_view = dots_in_view(scene_);
    levels_ = GreyLevels(scene_.setup.camera, in_view.size());
    sample_ = choose_sample(in_view, plan_sample_dots);
    if (deflections_.table().exists()) {
      std::vector<std::size_t> places(sample_.size());
      std::iota(places.begin(), places.end(), std::size_t{0});
      checked_ = choose_sample(places, checked_dots);
      for (std::uint64_t rays = fewest_checking_rays;; rays *= 2) {
        by_rays_ = trace_checked(rays);
        double const variance = mean_variance(by_rays_) / scramblings;  // of their means
        if (variance <= 0.1 * truth_tolerance_px * truth_tolerance_px || rays == most_checking_rays) break;
      }
    }
  }

  RaysPlan measure() const {
    RaysPlan plan;
    plan.rays = scene_.rays_per_dot;
    plan.bits = levels_.bits;
    if (sample_.empty()) return plan;
    OwnedLightModel const light(bench_, scene_.dots, &spot_, deflections_.table());
    int const side = 2 * spot_.half_width() + 49 + static_cast<int>(std::min(image_width_px(scene_), widest_image_px));
    Scatter const scatter = measure_scatter(sample_, levels_, [&](std::size_t dot, int scrambling) {
      Vec2d const at = scene_.to_pixel(scene_.dots.centre[dot]);
      Window const window{static_cast<int>(std::floor(at.x)) - side / 2, static_cast<int>(std::floor(at.y)) - side / 2,
                          side};
      return std::visit(
          [&](auto const& medium) {
            return sample_dot(bench_, scrambled(bench_, scrambling), medium, light.model, dot, window);
          },
          scene_.medium.view);
    });
    plan.truth_error_px = std::sqrt(mean_variance(scatter.displacements) + table_bias(scatter.displacements));
    plan.image_error_levels = levels_.error(scatter);
    return plan;
  }

 private:
  /// Of the dots that are checked, by their rays alone.
  std::vector<MeanDisplacement> trace_checked(std::uint64_t rays) const {
    std::vector<MeanDisplacement> means(checked_.size());
    OwnedLightModel const light(bench_, scene_.dots, nullptr, DeflectionTable{});
    std::visit(
        [&](auto const& medium) {
          parallel_for(means.size(), [&](std::size_t i) {
            means[i] = mean_displacement(bench_, medium, light.model, sample_[checked_[i]], rays);
          });
        },
        scene_.medium.view);
    return means;
  }

  /// Mean square by which the table leads displacements from those of rays alone, the scatter of both taken off [px^2].
  /// @param by_table of the sample
  double table_bias(std::vector<MeanDisplacement> const& by_table) const {
    if (checked_.empty()) return 0;
    double sum = 0;
    for (std::size_t i = 0; i < checked_.size(); ++i) {
      MeanDisplacement const& table = by_table[checked_[i]];
      Vec2d const off = table.mean - by_rays_[i].mean;
      double const bias = 0.5 * dot(off, off) - table.variance_of_mean() - by_rays_[i].variance_of_mean();
      if (std::isfinite(bias)) sum += bias;
    }
    return std::max(0.0, sum / static_cast<double>(checked_.size()));
  }

  FocusedDots bench_;
  Scene const& scene_;
  std::optional<AiryTable> airy_;
  SpotView spot_;
  DeflectionMap deflections_;
  std::vector<std::size_t> sample_, checked_;  // dots; those among them whose table is checked, by their places here
  std::vector<MeanDisplacement> by_rays_;
  GreyLevels levels_{scene_.setup.camera, 0};
};

}  // namespace

RaysPlan measure_rays(FocusedDots const& dots) { return RayErrors(dots).measure(); }

RaysPlan plan_rays(FocusedDots const& dots) {
  if (auto const given = given_rays(dots.scene().setup)) return *given;
  Scene searched = dots.scene();  // at one number of rays after the other
  RayErrors const errors(dots.of(searched));
  return choose_rays(
      searched, [&] { return errors.measure(); }, rays_seconds(searched));
}

}  // namespace gladstone
