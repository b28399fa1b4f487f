#include "render/focused_dots/lone_dot.h"

#include <cmath>

#include "render/base/interrupt.h"
#include "render/base/random.h"
#include "render/scene/light_patch.h"

namespace gladstone::inline focused_dots {
namespace {

/// Returns a pattern of a single white dot.
DotPattern select_place(DotPattern const& dots, Vec2d place) {
  DotPattern one;
  one.half_size = dots.half_size;
  one.shape = dots.shape;
  one.centre = {place};
  return one;
}

}  // namespace

LoneDot::LoneDot(FocusedDots const& all, Vec2d place, int side)
    : dot_(select_place(all.dots(), place)), dots_(all.with_dots(dot_)), side_(side) {
  Scene const& scene = dots_.scene();
  Vec2d const centre = dot_.centre[0];
  double room = DeflectionTableLayout::default_aim_distance(scene.imaging);
  do {
    table_ = std::make_unique<DeflectionMap>(dots_, DeflectionTableLayout(dots_, dot_, room));
    owned_ = std::make_unique<OwnedDotModel>(dots_, dot_, table_->table(), true);
    aim_ = aim_dot(owned_->model, centre);
    room *= 2;
  } while (aim_.kind == DotKind::left && 2 * aim_.farthest > room && room < scene.setup.z_b());
  render_frame(0, {});
  if (is_uncovered()) return;
  Vec2d const moved = seen_.truth.hits[1].mean() - seen_.truth.hits[0].mean();
  render_frame(1, std::isfinite(moved.x) ? moved : Vec2d{});
  // no difference in the reference image, whose light is known in closed form
  for (Difference& difference : difference_) difference.light.resize(light_.size());
  if (seen_.kind == DotKind::still) return;
  for (int scrambling = 0; scrambling < sample_count; ++scrambling) samples_.emplace_back(side);
}

void LoneDot::compare_with_rays(int rays) {
  for (std::size_t scrambling = 0; scrambling < samples_.size(); ++scrambling) {
    RaySample& sample = samples_[scrambling];
    std::visit([&](auto const& medium) { add_rays(medium, scrambling, rays, sample); }, dots_.scene().medium.view);
    Difference& difference = difference_[scrambling];
    Vec2d const rendered = seen_.truth.hits[1].mean() - seen_.truth.hits[0].mean();
    difference.displacement = sample.predicted.mean() + sample.traced.mean() - sample.also_predicted.mean() - rendered;
    Image<double> const light = sample.light.to_light(), correction = sample.difference.to_light();
    double const unit = static_cast<double>(largest_sample) / rays;
    for (std::size_t i = 0; i < light.size(); ++i) {
      double const found = unit * (light.data()[i] + predicted_per_traced * correction.data()[i]);
      difference.light[light.size() + i] = found - light_[light.size() + i];
    }
  }
}

void LoneDot::render_frame(std::size_t frame, Vec2d moved) {
  Vec2d const centre = dot_.centre[0], at = owned_->model.to_pixel(centre) + moved;
  int const half = side_ / 2;
  owned_->model.axis_px = owned_->model.axis_px - Vec2d{std::floor(at.x) - half, std::floor(at.y) - half};
  integrator_ = std::make_unique<DotIntegrator>(owned_->model);
  std::visit([&](auto const& medium) { seen_ = integrator_->see(medium, centre, 1); }, dots_.scene().medium.view);
  if (is_uncovered()) return;
  LightImage frames[frame_count] = {{side_, side_}, {side_, side_}};
  LightImage* const images[frame_count] = {&frames[0], &frames[1]};
  integrator_->accumulate_light(images);
  Image<double> const light = frames[frame].to_light();
  light_.insert(light_.end(), light.begin(), light.end());
}

template <class Medium>
void LoneDot::add_rays(Medium const& medium, std::size_t scrambling, int rays, RaySample& sample) {
  DotModel const& model = owned_->model;
  CorrectedCone const cone = integrator_->cone();
  SpotView spot;
  spot.model = SpotModel::gaussian;
  spot.gaussian = model.spot;
  LightPatch patch(spot);
  BundleView choice;
  choice.seed = repeat_seed(dots_.plan().seed, 1000003u + static_cast<std::uint64_t>(scrambling));
  constexpr double wide = CorrectedCone::reach;
  auto const enter = [&](Vec2d on_dot, Vec2d moved, Vec2d arrival, double sign, LightImage& image,
                         RaySample::Sum& sum) {
    if (!(length(arrival) <= model.stop_radius)) return;
    sum.first += on_dot + moved;
    sum.count += 1;
    patch.deposit(seen_.truth.origin + on_dot + moved, sign * wide * wide / largest_sample * seen_.light, &image, 1);
  };
  /// Predicts ray number `ray`, and traces it if `traced`.
  auto const add = [&](int ray, bool traced) {
    throw_if_interrupted();
    auto const [place, at] = DotRay::choose(choice, model.shape, seen_.centre, ray);
    Vec2d const from_aim = (wide * model.stop_radius) * at, offset = model.offset(place);
    Vec2d const on_dot = model.half_size_px() * place;
    Vec2d const moved = cone.origin() + cone.displacement(offset, from_aim), arrival = cone.arrival(offset, from_aim);
    if (!traced) return enter(on_dot, moved, arrival, 1, sample.light, sample.predicted);
    Vec2d const pupil = cone.pupil(from_aim);
    Deflection found[1];
    deflect(model.bench, medium, {seen_.centre + offset}, {pupil}, found);
    enter(on_dot, moved, arrival, -1, sample.difference, sample.also_predicted);
    enter(on_dot, found[0].displacement, pupil + found[0].shift, 1, sample.difference, sample.traced);
  };
  for (int ray = sample.rays; ray < rays; ++ray) add(ray, false);
  patch.flush(&sample.light, 1);
  for (int ray = sample.rays / predicted_per_traced; ray < rays / predicted_per_traced; ++ray) add(ray, true);
  patch.flush(&sample.difference, 1);
  sample.rays = rays;
}

}  // namespace gladstone::inline focused_dots
