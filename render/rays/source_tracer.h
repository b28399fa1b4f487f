#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "render/base/interrupt.h"
#include "render/base/units.h"
#include "render/rays/aimed_sources.h"
#include "render/rays/hit_grid.h"
#include "render/scene/bend_limit.h"
#include "render/scene/camera.h"
#include "render/scene/light_patch.h"
#include "render/scene/scene.h"
#include "render/scene/truth_error.h"

namespace gladstone {

/// What all sources of a launch share.
struct RaysLaunch {
  Camera camera;  ///< its stop with a rim for this number of rays
  TracingOptions<double> tracing;
  BundleView<double> choice;
  SpotView spot;
  std::uint64_t rays = 1;
  double z_b = 0;         ///< from the dots to the lens [m]
  double light_unit = 1;  ///< of weight times source area: a fully lit pixel on the axis [m^2]
  double point_area = 0;  ///< that a source of no size counts as: what a pixel on the axis sees [m^2]

  RaysLaunch(Scene const& scene, SpotView const& spot);

  /// Light of one unit of a ray's weight [fully lit px].
  double light_per_weight(double source_area) const {
    return (source_area > 0 ? source_area : point_area) / (static_cast<double>(rays) * light_unit);
  }
  /// What a source at a point sees of the stop.
  std::optional<WorldAimDisc> sight(Vec3d middle) const { return camera.aim_disc(middle); }
  /// Where its rays go, if it reaches so far about the point, and the medium bends rays aside by `margin` at most [m].
  AimedBundle<double> bundle(WorldAimDisc const& disc, double reach, double margin) const;
};

/// Lays down the light of one frame of one source at a time.
class RayLight {
 public:
  explicit RayLight(RaysLaunch const& launch);
  void begin(LightImage* image, double light_per_weight);
  void deposit(Vec2d p, double weight);
  void finish();

 private:
  LightPatch patch_;
  std::optional<HitGrid> grid_;
  LightImage* image_ = nullptr;
  double light_per_weight_ = 0;
};

/// Traces the rays of sources, both frames by the same, one source at a time: its light and its truth.
/// @tparam View CameraView, or another that says where rays land
template <class View, class Sources, class Medium>
class SourceTracer {
 public:
  SourceTracer(RaysLaunch const& launch, View const& view, Sources const& sources, Medium const& medium,
               bool with_images)
      : launch_(launch), sources_(sources), medium_(medium), view_(view), with_images_(with_images) {
    for (auto& light : light_) light.emplace(launch);
  }

  /// Aims a little wide at first, by what its chief and rim rays are bent; where a ray turns out to be bent further,
  /// its light is taken back and it begins again. So what it gives hangs on nothing but itself.
  /// @param images null: its light is not sent anywhere @return its truth; NaN where no ray of it gets through
  DotTruth trace(std::uint64_t source, LightImage* const (&images)[frame_count]) {
    DotTruth truth;
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    truth.error = {nan, nan};
    Vec3d const middle = sources_.middle(source);
    auto const disc = launch_.sight(middle);
    if (!disc) return truth;
    if (auto const pixel = launch_.camera.project(middle)) {
      truth.origin = {std::round(pixel->x), std::round(pixel->y)};
    }
    double margin = probe_bend(middle, *disc);
    while (true) {
      StatusCounts const before = statuses_;
      double const bend = trace_all(source, *disc, margin, truth.origin, images, 1);
      if (launch_.camera.chief_rays_only() || !(bend > margin)) break;
      if (with_images_) trace_all(source, *disc, margin, truth.origin, images, -1);
      statuses_ = before;
      margin = 1.02 * bend;
      refuse_bend_beyond_any_bench(margin, launch_.z_b);
    }
    largest_margin_ = std::max(largest_margin_, margin);
    int const scramblings = 1 << launch_.choice.scrambling_bits;
    RaySums all;
    for (int i = 0; i < scramblings; ++i) all += of_scramblings_[i];
    for (int frame = 0; frame < frame_count; ++frame) truth.hits[frame] = all.hits[frame];
    if (scramblings > 1) {
      Vec2d const squares = truth_errors(of_scramblings_, scramblings, all).rays2;
      truth.error = {std::sqrt(squares.x), std::sqrt(squares.y)};
    }
    return truth;
  }

  StatusCounts const& statuses() const { return statuses_; }
  /// The widest that any source was aimed beyond the stop [m].
  double largest_margin() const { return largest_margin_; }

 private:
  /// A fourth more than chief and rim rays are moved on the aim plane [m].
  double probe_bend(Vec3d middle, WorldAimDisc const& disc) const {
    double bend = 0;
    for (Vec3d const off : {Vec3d{}, disc.a, disc.b, -disc.a, -disc.b}) {
      Ray<double> const start[1] = {{middle, normalized(disc.centre + off - middle)}};
      bend = std::max(bend, bend_of(start[0]));
    }
    return 1.25 * bend;
  }
  double bend_of(Ray<double> const& start) const {
    RayHit<double> const reference = trace_ray(view_, NoMedium<double>{}, launch_.tracing, start, 1.0);
    RayHit<double> const flow = trace_ray(view_, medium_, launch_.tracing, start, 1.0);
    bool const known = std::max(reference.status, flow.status) <= RayStatus::vignetted;
    return known ? length(flow.at_lens - reference.at_lens) : 0;
  }

  /// @param sign of the light that is laid down @return furthest that a ray was moved on the aim plane [m]
  double trace_all(std::uint64_t source, WorldAimDisc const& disc, double margin, Vec2d origin,
                   LightImage* const (&images)[frame_count], double sign) {
    AimedBundle<double> const bundle = launch_.bundle(disc, sources_.reach(), margin);
    double const light_per_weight = sign * launch_.light_per_weight(sources_.area());
    for (int frame = 0; with_images_ && frame < frame_count; ++frame) {
      light_[frame]->begin(images[frame], light_per_weight);
    }
    std::fill_n(of_scramblings_, most_scramblings, RaySums{});
    largest_bend2_ = 0;
    std::uint64_t ray = 0;
    for (; ray + 2 <= launch_.rays; ray += 2) trace_some<2>(bundle, source, ray, origin);
    if (ray < launch_.rays) trace_some<1>(bundle, source, ray, origin);
    for (int frame = 0; with_images_ && frame < frame_count; ++frame) light_[frame]->finish();
    return std::sqrt(largest_bend2_);
  }

  template <int N>
  void trace_some(AimedBundle<double> const& bundle, std::uint64_t source, std::uint64_t first, Vec2d origin) {
    throw_if_interrupted();  // each of them may take a million steps
    Ray<double> start[N];
    double weight[N];
    for (int i = 0; i < N; ++i) {
      AimedRay<double> const aimed = aim_ray(sources_, bundle, source, first + static_cast<std::uint64_t>(i));
      start[i] = aimed.ray;
      weight[i] = aimed.weight;
    }
    RayHit<double> hit[frame_count][N];
    trace_rays(view_, NoMedium<double>{}, launch_.tracing, start, weight, hit[0]);
    trace_rays(view_, medium_, launch_.tracing, start, weight, hit[1]);
    for (int i = 0; i < N; ++i) {
      auto const mask = (std::uint64_t{1} << launch_.choice.scrambling_bits) - 1;
      RaySums& sums = of_scramblings_[(first + static_cast<std::uint64_t>(i)) & mask];
      for (int frame = 0; frame < frame_count; ++frame) {
        RayHit<double> const& here = hit[frame][i];
        ++statuses_[static_cast<std::size_t>(frame)][static_cast<std::size_t>(here.status)];
        if (here.weight == 0) continue;
        sums.hits[frame].add(here.pixel - origin, here.weight, reaches_sensor_plane(here.status));
        if (with_images_) light_[frame]->deposit(here.pixel, here.weight);
      }
      RayStatus const worse = std::max(hit[0][i].status, hit[1][i].status);
      if (worse <= RayStatus::vignetted) {
        Vec2d const bend = hit[1][i].at_lens - hit[0][i].at_lens;
        largest_bend2_ = std::max(largest_bend2_, dot(bend, bend));
      }
    }
  }

  RaysLaunch const& launch_;
  Sources sources_;
  Medium const& medium_;
  View view_;
  bool with_images_;
  std::optional<RayLight> light_[frame_count];
  RaySums of_scramblings_[most_scramblings];
  StatusCounts statuses_{};
  double largest_bend2_ = 0, largest_margin_ = 0;
};

}  // namespace gladstone
