#include "render/focused_dots/table_error.h"

#include <cmath>
#include <memory>
#include <numeric>

#include "render/base/parallel.h"
#include "render/base/random.h"
#include "render/focused_dots/deflection_map.h"
#include "render/focused_dots/dot_integrator.h"
#include "render/focused_dots/owned_dot_model.h"
#include "render/scene/ray_scatter.h"

namespace gladstone {
namespace {

constexpr std::size_t measured_dots = 12;
constexpr std::uint64_t rays_a_scrambling = 512;

/// One dot of a scene by itself, in a window of pixels about it.
class LoneDot {
 public:
  LoneDot(Scene const& scene, std::size_t dot, int side)
      : radiance_(scene.dots.radiance_of(dot)), scene_(alone(scene, dot)), side_(side) {
    FocusedDots const dots = focused_dots(scene_).value();
    Vec2d const centre = scene_.dots.centre[0];
    double room = DeflectionPlan::usual_aim * scene_.imaging.entrance_pupil / 2;
    do {
      table_ = std::make_unique<DeflectionMap>(dots, DeflectionPlan(dots, scene_.dots, room));
      owned_ = std::make_unique<OwnedDotModel>(dots, scene_.dots, table_->table(), true);
      aim_ = aim_dot(owned_->model, centre);
      room *= 2;
    } while (aim_.kind == DotKind::left && 2 * aim_.farthest > room && room < scene_.setup.z_b());
    // pixels are counted from the window's corner
    Vec2d const at = owned_->model.to_pixel(centre);
    owned_->model.axis_px = owned_->model.axis_px - Vec2d{std::floor(at.x) - side / 2, std::floor(at.y) - side / 2};
    integrator_ = std::make_unique<DotIntegrator>(owned_->model);
    std::visit([&](auto const& medium) { seen_ = integrator_->see(medium, centre, radiance_); }, scene_.medium.view);
  }

  bool left() const { return seen_.kind == DotKind::left; }

  /// What some rays find beside what they were expected to: of truth [px], and added, times `share`, to the light of
  /// both frames.
  Sampled sample(int scrambling, double share) {
    LightImage frames[frame_count] = {{side_, side_}, {side_, side_}};
    LightImage* const images[frame_count] = {&frames[0], &frames[1]};
    integrator_->lay_down(images);
    Vec2d const off = std::visit(
        [&](auto const& medium) {
          return seen_.kind == DotKind::still ? Vec2d{} : trace(medium, scrambling, share, frames[1]);
        },
        scene_.medium.view);
    Sampled sampled;
    sampled.displacement = share * off;
    for (LightImage const& frame : frames) {
      Image<double> const light = frame.to_light();
      sampled.light.insert(sampled.light.end(), light.begin(), light.end());
    }
    return sampled;
  }

 private:
  static Scene alone(Scene const& scene, std::size_t dot) {
    Scene copy = scene;
    copy.dots.centre = {scene.dots.centre[dot]};
    copy.dots.radiance.clear();
    return copy;
  }

  template <class Medium>
  Vec2d trace(Medium const& medium, int scrambling, double share, LightImage& image) {
    DotModel const& model = owned_->model;
    CorrectedCone const cone = integrator_->cone();
    SpotView spot;
    spot.model = SpotModel::gaussian;
    spot.gaussian = model.spot;
    LightPatch patch(spot);
    BundleView<double> choice;
    choice.seed = repeat_seed(scene_.setup.render.seed, 1000003u + static_cast<std::uint64_t>(scrambling));
    double const weight = CorrectedCone::reach * CorrectedCone::reach / static_cast<double>(rays_a_scrambling);
    Vec2d sum[2]{};
    double passing[2]{};
    for (std::uint64_t ray = 0; ray < rays_a_scrambling; ++ray) {
      throw_if_interrupted();
      double u[sobol_dimensions];
      sample_coordinates(choice, 0, ray, u);
      Vec2d const place = scene_.dots.shape == SourceShape::disc ? point_of_circle(std::sqrt(u[2]), u[3])
                                                                : Vec2d{2 * u[2] - 1, 2 * u[3] - 1};
      Vec2d const from_aim = point_of_circle(CorrectedCone::reach * model.stop_radius * std::sqrt(u[0]), u[1]);
      Vec2d const offset = model.offset(place), pupil = cone.pupil(from_aim);
      Vec2d const start = seen_.truth.origin + model.half_size_px() * place;
      Deflection found[1];
      deflect(model.bench, medium, {seen_.centre + offset}, {pupil}, found);
      Vec2d const moved[2] = {cone.origin() + cone.displacement(offset, from_aim), found[0].displacement};
      Vec2d const arrival[2] = {cone.arrival(offset, from_aim), pupil + found[0].bend};
      for (int by : {0, 1}) {
        if (!(length(arrival[by]) <= model.stop_radius)) continue;
        passing[by] += 1;
        sum[by] += model.half_size_px() * place + moved[by];
        patch.deposit(start + moved[by], (by == 1 ? share : -share) * weight * seen_.light, &image, 1);
      }
    }
    patch.flush(&image, 1);
    return sum[1] / passing[1] - sum[0] / passing[0];
  }

  double radiance_;
  Scene scene_;
  int side_;
  std::unique_ptr<DeflectionMap> table_;
  std::unique_ptr<OwnedDotModel> owned_;
  std::unique_ptr<DotIntegrator> integrator_;
  DotAim aim_;
  SeenDot seen_;
};

}  // namespace

RaysPlan measure_table_error(FocusedDots const& dots) {
  Scene const& scene = dots.scene();
  RaysPlan plan;
  plan.rays = scene.rays_per_dot;
  std::vector<std::size_t> const in_view = dots_in_view(scene);
  GreyLevels const levels(scene.setup.camera, in_view.size());
  plan.bits = levels.bits;
  std::vector<std::size_t> const sample = choose_sample(in_view, measured_dots);
  double const px = scene.imaging.magnification / scene.setup.camera.pixel_pitch;
  int const side = 2 * GaussianSpot<double>{scene.spot_sigma_px()}.half_width() + 49 +
                   static_cast<int>(std::min(2 * scene.dots.half_size * px, 100.0));
  std::vector<std::unique_ptr<LoneDot>> lone(sample.size());
  parallel_for(sample.size(), [&](std::size_t i) { lone[i] = std::make_unique<LoneDot>(scene, sample[i], side); });
  std::erase_if(lone, [](auto const& dot) { return dot->left(); });
  if (lone.empty()) return plan;
  std::vector<std::size_t> places(lone.size());
  std::iota(places.begin(), places.end(), std::size_t{0});
  // of four samples that lie s e to either side in turn the variance is 4 s^2 e^2 / 3: e^2 with this s
  double const share = std::sqrt(0.75);
  Scatter const scatter = measure_scatter(places, levels, [&](std::size_t dot, int scrambling) {
    return lone[dot]->sample(scrambling, scrambling % 2 == 0 ? share : -share);
  });
  plan.truth_error_px = std::sqrt(mean_variance(scatter.displacements));
  plan.image_error_levels = levels.error(scatter);
  return plan;
}

RaysPlan plan_rays(FocusedDots const& dots) {
  auto const given = given_rays(dots.scene().setup);
  Scene searched = dots.scene();  // at one number of rays after the other
  FocusedDots const here = focused_dots(searched).value();
  for (searched.rays_per_dot = given ? given->rays : 32;; searched.rays_per_dot *= 4) {
    RaysPlan plan = measure_table_error(here);
    plan.converged = plan.excess() <= 1;
    plan.rays_wanted = static_cast<double>(plan.rays);
    plan.seconds = rays_seconds(searched) * static_cast<double>(plan.rays);
    if (given || plan.converged || searched.rays_per_dot >= 512) return plan;
  }
}

}  // namespace gladstone
