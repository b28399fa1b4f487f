#pragma once

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "render/rays/aimed_sources.h"
#include "render/rays/filled_stop.h"
#include "render/rays/particle_sources.h"
#include "render/rays/source_tracer.h"

namespace gladstone {

/// What all particles of a launch share: with a smooth rim of the stop, and with a sharp one.
struct ParticleLaunch {
  RaysLaunch smooth, sharp;

  ParticleLaunch(Scene const& scene, SpotView const& spot) : smooth(scene, spot), sharp(scene, spot, StopRim::sharp) {}
};

/// Traces the rays of particles, one particle at a time: the medium stands before both frames, and each frame has a
/// place and light of its own. Both frames share random keys, so that a particle that has hardly moved has sent its
/// rays to the same places of the lens.
///
/// Where the rays that fill the stop can be told beforehand (filled_stop.h), just these are sent: their light is known
/// without any, and they differ by what medium and lens do to them alone, so that few are enough. Elsewhere rays go to
/// a wider disc and are clipped at the stop, as a dot's.
/// @tparam Sources ParticleSources of one pulse
template <class Sources, class Medium>
class ParticleTracer {
 public:
  ParticleTracer(ParticleLaunch const& launch, Sources const (&pulses)[frame_count], Medium const& medium,
                 bool with_images)
      : launch_(launch.smooth),
        pulses_{pulses[0], pulses[1]},
        medium_(medium),
        view_(launch.smooth.camera.view()),
        stop_(launch.sharp.camera),
        with_images_(with_images) {
    for (auto& light : light_) light.emplace(launch_);
  }

  /// @param images null: its light is not sent anywhere @param light_per_weight of an image, for one ray's weight
  /// @return its truth; NaN at a pulse that does not light it, or where no ray of it gets through
  ParticleSeen trace(std::uint64_t particle, LightImage* const (&images)[frame_count], double light_per_weight) {
    std::fill_n(seen_, most_scramblings, RaySums{});
    std::fill_n(ambient_, most_scramblings, RaySums{});
    origin_ = {};
    placed_ = false;
    for (int frame = 0; frame < frame_count; ++frame) {
      if (!(pulses_[frame].photons[particle] > 0)) continue;
      if (!trace_filled(frame, particle, images[frame], light_per_weight)) {
        trace_wide(frame, particle, images[frame], light_per_weight);
      }
      placed_ = true;
    }
    int const scramblings = 1 << launch_.choice.scrambling_bits;
    return {source_truth(seen_, scramblings, origin_), source_truth(ambient_, scramblings, origin_)};
  }

  StatusCounts const& statuses() const { return statuses_; }
  /// The widest that any particle was aimed beyond the stop [m].
  double largest_margin() const { return largest_margin_; }

 private:
  static constexpr bool bends = !std::is_same_v<Medium, NoMedium<double>>;
  /// Rays that go side by side, as SourceTracer's.
  static constexpr int side_by_side = bends ? 2 : 4;

  /// Sends rays to the very stop, with and without the medium. @return false: it is not known where they go
  bool trace_filled(int frame, std::uint64_t particle, LightImage* image, double light_per_weight) {
    if (launch_.camera.chief_rays_only()) return false;
    Vec3d const place = pulses_[frame].middle(particle);
    FilledStop straight;
    straight.map = paraxial_aim(stop_, place);
    if (!fill_stop(stop_, NoMedium<double>{}, launch_.tracing, place, straight)) return false;
    FilledStop bent = straight;
    if constexpr (bends) {
      if (!fill_stop(stop_, medium_, launch_.tracing, place, bent)) return false;
    }
    if (!placed_) origin_ = origin_of(straight);
    auto const aimed_by = [&](AimMap const& map) {
      return [&](Vec2d at) { return ray_to(pulses_[frame], stop_.camera.aim_plane, map, particle, at); };
    };
    if (with_images_) light_[frame]->begin(image, light_per_weight);
    largest_bend2_ = 0;
    all_rays(particle, [&]<int N>(std::uint64_t const(&ray)[N], Vec2d const(&at)[N]) {
      RayHit<double> seen[N], ambient[N];
      trace_through(aimed_by(bent.map), at, stop_.camera, medium_, seen);
      if constexpr (bends) {
        trace_through(aimed_by(straight.map), at, stop_.camera, NoMedium<double>{}, ambient);
      } else {
        std::copy_n(seen, N, ambient);
      }
      enter(frame, ray, seen, ambient);
    });
    if (with_images_) light_[frame]->finish();
    return true;
  }

  /// Sends rays to a disc about the stop, the same with and without the medium; where a ray is bent further than the
  /// disc is wide, its light is taken back and all begin again, wider.
  void trace_wide(int frame, std::uint64_t particle, LightImage* image, double light_per_weight) {
    SourceAim aim = aim_at_stop(launch_, view_, medium_, pulses_[frame].middle(particle));
    if (!aim.disc) return;
    if (!placed_) origin_ = aim.origin;
    auto const trace = [&](double sign) {
      AimedBundle<double> const bundle = launch_.bundle(*aim.disc, 0, aim.margin);
      auto const aimed = [&](Vec2d at) { return ray_to(pulses_[frame], bundle, particle, {}, at); };
      if (with_images_) light_[frame]->begin(image, sign * light_per_weight);
      largest_bend2_ = 0;
      all_rays(particle, [&]<int N>(std::uint64_t const(&ray)[N], Vec2d const(&at)[N]) {
        RayHit<double> seen[N], ambient[N];
        trace_through(aimed, at, view_, NoMedium<double>{}, ambient);
        if constexpr (bends) {
          trace_through(aimed, at, view_, medium_, seen);
        } else {
          std::copy_n(ambient, N, seen);
        }
        enter(frame, ray, seen, ambient);
      });
      if (with_images_) light_[frame]->finish();
      return std::sqrt(largest_bend2_);
    };
    while (true) {
      auto const before = statuses_[static_cast<std::size_t>(frame)];
      double const bend = trace(1);
      if (launch_.camera.chief_rays_only() || !(bend > aim.margin)) break;
      if (with_images_) trace(-1);
      statuses_[static_cast<std::size_t>(frame)] = before;
      for (int i = 0; i < most_scramblings; ++i) seen_[i].hits[frame] = ambient_[i].hits[frame] = {};
      aim.margin = launch_.wider_margin(bend);
    }
    largest_margin_ = std::max(largest_margin_, aim.margin);
  }

  /// Calls some(rays, places on the unit disc) for all rays.
  template <class Some>
  void all_rays(std::uint64_t particle, Some&& some) {
    std::uint64_t ray = 0;
    for (; ray + side_by_side <= launch_.rays; ray += side_by_side) these_rays<side_by_side>(particle, ray, some);
    for (; ray < launch_.rays; ++ray) these_rays<1>(particle, ray, some);
  }
  template <int N, class Some>
  void these_rays(std::uint64_t particle, std::uint64_t first, Some&& some) {
    throw_if_interrupted();
    std::uint64_t ray[N];
    Vec2d at[N];
    for (int i = 0; i < N; ++i) {
      ray[i] = first + static_cast<std::uint64_t>(i);
      at[i] = place_of_ray(launch_.choice, particle, ray[i]);
    }
    some(ray, at);
  }

  /// @param aimed gives the AimedRay to a place of the unit disc
  template <int N, class Aimed, class Through>
  void trace_through(Aimed const& aimed, Vec2d const (&at)[N], CameraView<double> const& view, Through const& medium,
                     RayHit<double> (&hit)[N]) const {
    Ray<double> start[N];
    double weight[N];
    for (int i = 0; i < N; ++i) {
      AimedRay<double> const one = aimed(at[i]);
      start[i] = one.ray;
      weight[i] = one.weight;
    }
    trace_rays(view, medium, launch_.tracing, start, weight, hit);
  }

  template <int N>
  void enter(int frame, std::uint64_t const (&ray)[N], RayHit<double> const (&seen)[N],
             RayHit<double> const (&ambient)[N]) {
    auto const mask = (std::uint64_t{1} << launch_.choice.scrambling_bits) - 1;
    for (int i = 0; i < N; ++i) {
      add(ambient[i], ambient_[ray[i] & mask].hits[frame]);
      add(seen[i], seen_[ray[i] & mask].hits[frame]);
      ++statuses_[static_cast<std::size_t>(frame)][static_cast<std::size_t>(seen[i].status)];
      if (with_images_ && seen[i].weight != 0) light_[frame]->deposit(seen[i].pixel, seen[i].weight);
      if (std::max(ambient[i].status, seen[i].status) > RayStatus::vignetted) continue;
      Vec2d const bend = seen[i].at_lens - ambient[i].at_lens;
      largest_bend2_ = std::max(largest_bend2_, dot(bend, bend));
    }
  }
  void add(RayHit<double> const& hit, CentroidSum<double>& sum) const {
    if (hit.weight != 0) sum.add(hit.pixel - origin_, hit.weight, reaches_sensor_plane(hit.status));
  }

  RaysLaunch const& launch_;
  Sources pulses_[frame_count];
  Medium const& medium_;
  CameraView<double> view_;
  StopView stop_;
  bool with_images_;
  std::optional<RayLight> light_[frame_count];
  RaySums seen_[most_scramblings], ambient_[most_scramblings];
  bool placed_ = false;  ///< the origin is known, from the first pulse that lights it
  Vec2d origin_{};       ///< whole pixel that sums count from [px]
  StatusCounts statuses_{};
  double largest_bend2_ = 0, largest_margin_ = 0;
};

}  // namespace gladstone
