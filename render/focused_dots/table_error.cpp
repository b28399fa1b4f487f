#include "render/focused_dots/table_error.h"

#include <cmath>
#include <limits>
#include <memory>
#include <numeric>

#include "render/base/parallel.h"
#include "render/base/progress.h"
#include "render/base/random.h"
#include "render/focused_dots/deflection_map.h"
#include "render/focused_dots/dot_integrator.h"
#include "render/focused_dots/owned_dot_model.h"
#include "render/scene/ray_scatter.h"

namespace gladstone {
namespace {

constexpr std::size_t place_count = 16;
constexpr int largest_sample = 65536;    ///< maximum number of rays per scrambling whose landing the table predicts
constexpr int predicted_per_traced = 8;  ///< of these rays, one in so many is also traced
/// Rays are added until errors and detection limits are within this fraction of the tolerances.
constexpr double sufficient_excess = 0.75;
constexpr double worth_more_rays = 0.7;  ///< required ratio of errors on quadrupling the rays

/// Returns the van der Corput sequence in base 2 (1935): the bits of i mirrored at the binary point.
double mirrored(std::size_t i) {
  double found = 0;
  for (double digit = 0.5; i > 0; i /= 2, digit /= 2) found += digit * static_cast<double>(i % 2);
  return found;
}

/// Sums over one sample of a lone dot's rays, in the order of a quasi-random sequence.
struct RaySample {
  struct Sum {
    Vec2d first{};
    double count = 0;
    Vec2d mean() const { return first / count; }
  };
  int rays = 0;                           ///< number of rays whose landing the table has predicted
  Sum predicted, also_predicted, traced;  ///< all predicted rays; those that are also traced, both ways
  LightImage light, difference;           ///< sums over the predicted rays; sums of traced minus predicted rays

  explicit RaySample(int side) : light(side, side), difference(side, side) {}
};

/// Rendering of a single white dot in pixel windows around its image in each frame, and the differences of independent
/// samples of traced rays.
class LoneDot {
 public:
  LoneDot(Scene const& scene, Vec2d place, int side) : scene_(alone(scene, place)), side_(side) {
    FocusedDots const dots = focused_dots(scene_).value();
    Vec2d const centre = scene_.dots.centre[0];
    double room = DeflectionTableLayout::default_aim_distance * scene_.imaging.entrance_pupil / 2;
    do {
      table_ = std::make_unique<DeflectionMap>(dots, DeflectionTableLayout(dots, scene_.dots, room));
      owned_ = std::make_unique<OwnedDotModel>(dots, scene_.dots, table_->table(), true);
      aim_ = aim_dot(owned_->model, centre);
      room *= 2;
    } while (aim_.kind == DotKind::left && 2 * aim_.farthest > room && room < scene_.setup.z_b());
    take_frame(0, {});
    if (left()) return;
    Vec2d const moved = seen_.truth.hits[1].mean() - seen_.truth.hits[0].mean();
    take_frame(1, std::isfinite(moved.x) ? moved : Vec2d{});
    // no difference in the reference image, whose light is known in closed form
    for (Sampled& off : off_) off.light.resize(as_seen_.light.size());
    if (seen_.kind == DotKind::still) return;
    for (int scrambling = 0; scrambling < budget_scramblings; ++scrambling) samples_.emplace_back(side);
  }

  bool left() const { return seen_.kind == DotKind::left; }

  /// Adds rays to the four samples until each has the given number, and updates their differences.
  void compare_with_rays(int rays) {
    for (std::size_t scrambling = 0; scrambling < samples_.size(); ++scrambling) {
      RaySample& sample = samples_[scrambling];
      std::visit([&](auto const& medium) { add_rays(medium, scrambling, rays, sample); }, scene_.medium.view);
      Sampled& off = off_[scrambling];
      Vec2d const told = seen_.truth.hits[1].mean() - seen_.truth.hits[0].mean();
      off.displacement = sample.predicted.mean() + sample.traced.mean() - sample.also_predicted.mean() - told;
      Image<double> const light = sample.light.to_light(), difference = sample.difference.to_light();
      double const unit = static_cast<double>(largest_sample) / rays;
      for (std::size_t i = 0; i < light.size(); ++i) {
        double const found = unit * (light.data()[i] + predicted_per_traced * difference.data()[i]);
        off.light[light.size() + i] = found - as_seen_.light[light.size() + i];
      }
    }
  }

  /// Returns one of the four samples of Scatter: the rendered dot plus `share` times the difference of a ray sample.
  Sampled sample(int scrambling, double share) const {
    Sampled sampled = as_seen_;
    Sampled const& off = off_[scrambling];
    sampled.displacement = share * off.displacement;
    for (std::size_t i = 0; i < off.light.size(); ++i) sampled.light[i] += share * off.light[i];
    return sampled;
  }

 private:
  static Scene alone(Scene const& scene, Vec2d place) {
    Scene copy = scene;
    copy.dots.centre = {place};
    copy.dots.radiance.clear();
    return copy;
  }

  /// Renders the dot again in a window centred at the given distance from its undisplaced image, with pixels counted
  /// from the window's corner, and stores one frame.
  void take_frame(std::size_t frame, Vec2d moved) {
    Vec2d const centre = scene_.dots.centre[0], at = owned_->model.to_pixel(centre) + moved;
    int const half = side_ / 2;
    owned_->model.axis_px = owned_->model.axis_px - Vec2d{std::floor(at.x) - half, std::floor(at.y) - half};
    integrator_ = std::make_unique<DotIntegrator>(owned_->model);
    std::visit([&](auto const& medium) { seen_ = integrator_->see(medium, centre, 1); }, scene_.medium.view);
    if (left()) return;
    LightImage frames[frame_count] = {{side_, side_}, {side_, side_}};
    LightImage* const images[frame_count] = {&frames[0], &frames[1]};
    integrator_->accumulate_light(images);
    Image<double> const light = frames[frame].to_light();
    as_seen_.light.insert(as_seen_.light.end(), light.begin(), light.end());
  }

  /// Adds rays to a sample. Many rays land as the table predicts, and some of them are also traced to correct the
  /// prediction (control variate).
  template <class Medium>
  void add_rays(Medium const& medium, std::size_t scrambling, int rays, RaySample& sample) {
    DotModel const& model = owned_->model;
    CorrectedCone const cone = integrator_->cone();
    SpotView spot;
    spot.model = SpotModel::gaussian;
    spot.gaussian = model.spot;
    LightPatch patch(spot);
    BundleView choice;
    choice.seed = repeat_seed(scene_.setup.render.seed, 1000003u + static_cast<std::uint64_t>(scrambling));
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

  Scene scene_;
  int side_;                        ///< of the pixel windows [px]
  std::vector<RaySample> samples_;  ///< one for each scrambling; none for a dot that the medium does not move
  std::unique_ptr<DeflectionMap> table_;
  std::unique_ptr<OwnedDotModel> owned_;
  std::unique_ptr<DotIntegrator> integrator_;
  DotAim aim_;
  RenderedDot seen_;
  Sampled as_seen_, off_[budget_scramblings];
};

/// Sets the errors and detection limits of a plan from lone dots that were compared with rays.
void state_errors(RayBudget& plan, std::vector<std::unique_ptr<LoneDot>> const& lone, GreyLevels const& levels) {
  std::vector<std::size_t> places(lone.size());
  std::iota(places.begin(), places.end(), std::size_t{0});
  // Let the four samples deviate from the rendered dot by s (e + noise), with e the error, s^2 = 3/4 and alternating
  // sign. Their variance is 4 s^2 e^2 / 3 + s^2 noise^2; with equal signs it is that of the noise alone, so the
  // difference is e^2. For e = 0, the two estimates differ by the product of two sums of two samples over 3, with mean
  // 0 and standard deviation 2 s^2 noise^2 / 3, divided by sqrt(n) for n independent values. The squared detection
  // limit is twice this value. The pixels of a dot count as one value.
  double const share = std::sqrt(0.75);
  auto const compute_scatter = [&](double odd) {
    return measure_scatter(places, levels, [&](std::size_t dot, int scrambling) {
      return lone[dot]->sample(scrambling, scrambling % 2 == 0 ? share : odd);
    });
  };
  Scatter off = compute_scatter(-share);
  Scatter const noise = compute_scatter(share);
  auto const less = [](double all, double by_chance) { return std::max(all - by_chance, 0.0); };  // NaN is retained
  auto const resolved = [](double by_chance, double n) { return std::sqrt(4.0 / 3 / std::sqrt(n) * by_chance); };
  auto const dot_count = static_cast<double>(lone.size());
  double const chance = mean_variance(noise.displacements);
  plan.truth_resolution_px = resolved(chance, 2 * dot_count);
  plan.image_resolution_levels = resolved(1, dot_count) * levels.error(noise);
  off.light_variance = less(off.light_variance, noise.light_variance);
  plan.truth_error_px = std::sqrt(less(mean_variance(off.displacements), chance));
  plan.image_error_levels = levels.error(off);
}

}  // namespace

DotPattern measured_places(Scene const& scene) {
  CameraSetup const& camera = scene.setup.camera;
  DotPattern white = scene.dots;
  white.radiance.clear();
  white.centre.clear();
  for (std::size_t i = 0; i < place_count; ++i) {
    double const x = (static_cast<double>(i) + 0.5) / place_count, y = mirrored(i) + 0.5 / place_count;
    white.centre.push_back(scene.to_target({x * camera.columns - 0.5, y * camera.rows - 0.5}));
  }
  return white;
}

RayBudget measure_table_error(FocusedDots const& dots) {
  Scene const& scene = dots.scene();
  RayBudget plan;
  plan.rays = scene.rays_per_dot;
  plan.fineness = scene.fineness;
  double const px = scene.imaging.magnification / scene.setup.camera.pixel_pitch;
  double const pitch_px = 2 * scene.dots.half_size * px;  // pitch of an image target's pixels, which are adjacent
  GreyLevels const levels(scene.setup.camera, scene.dots.shape == SourceShape::square ? 1 / (pitch_px * pitch_px) : 0);
  plan.bits = levels.bits;
  int const side =
      2 * GaussianSpot<double>{scene.spot_sigma_px()}.half_width() + 49 + static_cast<int>(std::min(pitch_px, 100.0));
  std::vector<Vec2d> const in_view = measured_places(scene).centre;
  std::vector<std::unique_ptr<LoneDot>> lone(in_view.size());
  Progress progress("measuring the table", lone.size());
  parallel_for(lone.size(), [&](std::size_t i) {
    lone[i] = std::make_unique<LoneDot>(scene, in_view[i], side);
    progress.advance();
  });
  std::erase_if(lone, [](auto const& dot) { return dot->left(); });
  if (lone.empty()) return plan;
  for (int const rays : {largest_sample / 4, largest_sample / 2, largest_sample}) {
    parallel_for(lone.size(), [&](std::size_t i) { lone[i]->compare_with_rays(rays); });
    state_errors(plan, lone, levels);
    if (plan.excess() <= sufficient_excess) break;
  }
  return plan;
}

double table_seconds(FocusedDots const& dots) {
  Scene const& scene = dots.scene();
  DeflectionTableLayout const plan(dots, scene.dots,
                                   DeflectionTableLayout::default_aim_distance * scene.imaging.entrance_pupil / 2);
  if (!plan.wanted()) return 0;
  double const of_table = 4.0 * static_cast<double>(plan.table.fours());
  double const measured = static_cast<double>(place_count) * budget_scramblings * largest_sample / predicted_per_traced;
  return (of_table + measured) * ray_seconds(scene);
}

double dots_seconds(FocusedDots const& dots, RenderTheory theory) {
  constexpr double a_node = 0.1e-6;  // look-ups at a node of the cone [s]
  Scene const& scene = dots.scene();
  DeflectionTableLayout const plan(dots, scene.dots,
                                   DeflectionTableLayout::default_aim_distance * scene.imaging.entrance_pupil / 2);
  if (plan.state == TableState::no_medium) return 0;
  OwnedDotModel const owned(dots, scene.dots, plan.table, false);
  double const nodes = static_cast<double>(owned.model.cone.count) * owned.model.places.count;
  double const of_node = (plan.wanted() ? a_node : 0) + (theory == RenderTheory::yes ? theory_ray_seconds(scene) : 0);
  double const of_dot = static_cast<double>(scene.rays_per_dot) * ray_seconds(scene) + nodes * of_node;
  return table_seconds(dots) + static_cast<double>(scene.source_count()) * of_dot;
}

RayBudget determine_ray_budget(FocusedDots const& dots) {
  if (auto const given = configured_ray_budget(dots.scene().setup)) return *given;
  Scene searched = dots.scene();  // copy in which fineness and number of rays are varied
  FocusedDots const here = focused_dots(searched).value();
  searched.rays_per_dot = initial_table_rays;
  searched.fineness = 1;
  RayBudget plan;
  double last = std::numeric_limits<double>::infinity();
  while (true) {
    plan = measure_table_error(here);
    plan.converged = plan.excess() <= 1;
    plan.seconds = rays_seconds(searched) * static_cast<double>(plan.rays);
    if (plan.converged) {
      plan.rays_wanted = static_cast<double>(plan.rays);
      return plan;
    }
    if (searched.fineness == 1) {
      searched.fineness = 2;
    } else {  // More rays do not reduce the error of the table itself.
      if (searched.rays_per_dot >= 512 || plan.excess() > worth_more_rays * last) return plan;
      last = plan.excess();
      searched.rays_per_dot *= 4;
    }
  }
}

}  // namespace gladstone
