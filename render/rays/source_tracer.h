#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <type_traits>

#include "render/base/interrupt.h"
#include "render/rays/aimed_sources.h"
#include "render/rays/hit_grid.h"
#include "render/rays/rays_ladder.h"
#include "render/rays/source_truth.h"
#include "render/scene/camera.h"
#include "render/scene/light_patch.h"
#include "render/scene/scene.h"

namespace gladstone::inline rays {

/// Deposits the light of one source in one image, by a HitGrid or PSF by PSF.
class RayLight {
 public:
  explicit RayLight(SpotView const& spot);
  /// Starts a source.
  /// @param rays  number of rays of the source
  void begin(LightImage* image, double light_per_weight, std::uint64_t rays);
  void deposit(Vec2d p, double weight);
  void finish();

 private:
  SpotView spot_;
  LightPatch patch_;
  std::optional<HitGrid> grid_;  ///< created when first needed
  bool by_grid_ = false;
  LightImage* image_ = nullptr;
  double light_per_weight_ = 0;
};

/// Target area of a source's rays, and the position of their light.
struct SourceAim {
  std::optional<WorldApparentPupil> disc;     ///< entrance pupil as seen from the source; empty: no ray passes
  Vec2d origin{};                             ///< whole-pixel position to which sums are relative [px]
  AimShift shift;                             ///< shift of the entrance pupil over the source
  double margin = 0;                          ///< margin by which the target area exceeds the entrance pupil [m]
  Vec2d low[frame_count], high[frame_count];  ///< approximate bounding box of the hits in each image [px]
};

/// Aims at the entrance pupil as seen from a source, with a margin for the deflection of its rays by the medium on the
/// aim plane, estimated from its chief and edge rays (RaysLaunch::first_margin).
/// @param reach  maximum distance of a point of the source from its middle [m]
template <class View, class Medium>
SourceAim aim_at_stop(RaysLaunch const& launch, View const& view, Medium const& medium, Vec3d middle, double reach) {
  SourceAim aim;
  aim.disc = launch.sight(middle);
  if (!aim.disc) return aim;
  aim.shift = launch.aim_shift(*aim.disc, middle, reach);
  if (auto const pixel = launch.camera.project(middle)) aim.origin = {std::round(pixel->x), std::round(pixel->y)};
  for (int frame = 0; frame < frame_count; ++frame) aim.low[frame] = aim.high[frame] = aim.origin;
  Vec3d const a = aim.disc->a, b = aim.disc->b;
  constexpr int count = 5;
  Vec3d const offset[count] = {{}, a, b, -a, -b};
  Ray<double> start[count];
  double weight[count];
  for (int i = 0; i < count; ++i) {
    start[i] = {middle, normalized(aim.disc->centre + offset[i] - middle)};
    weight[i] = 1;
  }
  RayHit<double> hit[frame_count][count];
  trace_rays(view, NoMedium<double>{}, launch.tracing, start, weight, hit[0]);
  trace_rays(view, medium, launch.tracing, start, weight, hit[1]);
  double shift = 0;
  for (int i = 0; i < count; ++i) {
    for (int frame = 0; frame < frame_count; ++frame) {
      RayHit<double> const& here = hit[frame][i];
      if (!reaches_sensor_plane(here.status)) continue;
      aim.low[frame] = {std::min(aim.low[frame].x, here.pixel.x), std::min(aim.low[frame].y, here.pixel.y)};
      aim.high[frame] = {std::max(aim.high[frame].x, here.pixel.x), std::max(aim.high[frame].y, here.pixel.y)};
    }
    bool const known = std::max(hit[0][i].status, hit[1][i].status) <= RayStatus::vignetted;
    if (known) shift = std::max(shift, length(hit[1][i].at_lens - hit[0][i].at_lens));
  }
  aim.margin = launch.first_margin(*aim.disc, shift);
  return aim;
}

/// Parameters with which a source must be traced again.
struct SourceRetry {
  int step;       ///< step of the ladder
  double margin;  ///< as SourceAim::margin [m]
};

/// Decides whether a source must be traced again, after all its rays have been traced: with a larger margin if a ray
/// was deflected beyond it, or with more rays.
/// @param shift  largest deflection of a ray on the aim plane [m]
/// @param light_per_weight  light in the image per unit of ray weight at this step
inline std::optional<SourceRetry> find_retry(RaysLadder const& ladder, int step, double margin, double shift,
                                             RaySums const* of_scramblings, double light_per_weight) {
  if (auto const wider = ladder[step].wider_margin(margin, shift)) return SourceRetry{step, *wider};
  int const next = ladder.view().next(step, RayPlacement::clipped, {}, of_scramblings, light_per_weight);
  if (next == step) return std::nullopt;
  return SourceRetry{next, margin};
}

/// Traces the rays of sources, one source at a time and with the same rays in both images: computes light and truth.
/// @tparam View  CameraView, or another view that determines where rays land
template <class View, class Sources, class Medium>
class SourceTracer {
 public:
  SourceTracer(RaysLadder const& ladder, View const& view, Sources const& sources, Medium const& medium,
               bool with_images)
      : ladder_(ladder), sources_(sources), medium_(medium), view_(view), with_images_(with_images) {
    for (auto& light : light_) light.emplace(ladder[0].spot);
  }

  /// Traces a source with an adaptive number of rays.
  /// The first pass has few rays and a margin estimated from its chief and edge rays. If a ray is deflected by more
  /// than the margin, or more rays are required, the deposited light is subtracted and the source is traced again. The
  /// result is therefore independent of other sources.
  /// @param images  reference and measurement image; null: light is not deposited
  /// @return truth of the source; NaN if no ray passes
  DotTruth trace(std::uint64_t source, LightImage* const (&images)[frame_count]) {
    use(0);
    SourceAim aim = aim_at_stop(*launch_, view_, medium_, sources_.middle(source), sources_.reach());
    if (!aim.disc) return source_truth(nullptr, 0, {});
    while (true) {
      StatusCounts const before = statuses_;
      double const shift = trace_all(source, aim, images, 1);
      auto const retry =
          find_retry(ladder_, step_, aim.margin, shift, of_scramblings_, launch_->light_per_weight(sources_.area()));
      if (!retry) break;
      if (with_images_) trace_all(source, aim, images, -1);
      statuses_ = before;
      aim.margin = retry->margin;
      use(retry->step);
    }
    largest_margin_ = std::max(largest_margin_, aim.margin);
    return source_truth(of_scramblings_, 1 << launch_->choice.scrambling_bits, aim.origin);
  }

  /// Returns the launch with which the last source was traced.
  RaysLaunch const& launch() const { return *launch_; }
  StatusCounts const& statuses() const { return statuses_; }
  /// Largest margin by which a source's rays were aimed beyond the stop [m].
  double largest_margin() const { return largest_margin_; }

 private:
  void use(int step) {
    step_ = step;
    launch_ = &ladder_[step];
    view_.elements = launch_->camera.elements.data();
  }

  /// Traces all rays of a source.
  /// @param sign  sign of the deposited light; -1 subtracts it
  /// @return largest deflection of a ray on the aim plane [m]
  double trace_all(std::uint64_t source, SourceAim const& aim, LightImage* const (&images)[frame_count], double sign) {
    AimedBundle<double> const bundle = launch_->bundle(*aim.disc, aim.shift, aim.margin);
    double const light_per_weight = sign * launch_->light_per_weight(sources_.area());
    for (int frame = 0; with_images_ && frame < frame_count; ++frame) {
      light_[frame]->begin(images[frame], light_per_weight, launch_->rays);
    }
    std::fill_n(of_scramblings_, most_scramblings, RaySums{});
    largest_shift2_ = 0;
    std::uint64_t ray = 0;
    for (; ray + rays_traced_together <= launch_->rays; ray += rays_traced_together) {
      trace_some<rays_traced_together>(bundle, source, ray, aim.origin);
    }
    for (; ray < launch_->rays; ++ray) trace_some<1>(bundle, source, ray, aim.origin);
    for (int frame = 0; with_images_ && frame < frame_count; ++frame) light_[frame]->finish();
    return std::sqrt(largest_shift2_);
  }

  /// Number of rays traced together: through a medium only two, since the state of more would not fit into the
  /// registers.
  static constexpr int rays_traced_together = std::is_same_v<Medium, NoMedium<double>> ? 4 : 2;

  template <int N>
  void trace_some(AimedBundle<double> const& bundle, std::uint64_t source, std::uint64_t first, Vec2d origin) {
    throw_if_interrupted();  // A ray may have a million steps.
    Ray<double> start[N];
    double weight[N];
    for (int i = 0; i < N; ++i) {
      AimedRay<double> const aimed = aim_ray(sources_, bundle, source, first + static_cast<std::uint64_t>(i));
      start[i] = aimed.ray;
      weight[i] = aimed.weight;
    }
    RayHit<double> hit[frame_count][N];
    trace_rays(view_, NoMedium<double>{}, launch_->tracing, start, weight, hit[0]);
    trace_rays(view_, medium_, launch_->tracing, start, weight, hit[1]);
    auto const mask = (std::uint64_t{1} << launch_->choice.scrambling_bits) - 1;
    auto const count = [this](int frame, RayStatus status) {
      ++statuses_[static_cast<std::size_t>(frame)][static_cast<std::size_t>(status)];
    };
    auto const deposit = [this](int frame, RayHit<double> const& here) {
      if (with_images_) light_[frame]->deposit(here.pixel, here.weight);
    };
    for (int i = 0; i < N; ++i) {
      RaySums& sums = of_scramblings_[(first + static_cast<std::uint64_t>(i)) & mask];
      largest_shift2_ = std::max(largest_shift2_, enter_ray(hit[0][i], hit[1][i], origin, sums.hits, count, deposit));
    }
  }

  RaysLadder const& ladder_;
  int step_ = 0;
  RaysLaunch const* launch_ = nullptr;  ///< launch of the current step
  Sources sources_;
  Medium const& medium_;
  View view_;
  bool with_images_;
  std::optional<RayLight> light_[frame_count];
  RaySums of_scramblings_[most_scramblings];
  StatusCounts statuses_{};
  double largest_shift2_ = 0, largest_margin_ = 0;
};

}  // namespace gladstone::inline rays
