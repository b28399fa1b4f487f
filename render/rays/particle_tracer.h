#pragma once

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "render/rays/aimed_sources.h"
#include "render/rays/filled_stop.h"
#include "render/rays/particle_sources.h"
#include "render/rays/source_tracer.h"

namespace gladstone::inline rays {

/// Parameters of all particles of a scene: with a sharp edge of the stop for rays that fill it, and with smoothed
/// edges, whose width depends on the ray number, for rays that are vignetted there.
struct ParticleLaunches {
  RaysLaunch sharp;
  RaysLadder ladder;

  /// @param spot  point spread function; a default SpotView if no images are rendered
  ParticleLaunches(Scene const& scene, RenderPlan const& plan, SpotView const& spot, RenderImages images)
      : sharp(scene, plan, spot, StopRim::sharp),
        ladder(RaysLadder::of_rules(scene, plan, RaysLaunch(scene, plan, spot, StopRim::smooth), images)) {}

  /// Returns the first step in the sequence of ray numbers (RaysLadder) for a particle whose rays fill the stop.
  /// @param light  light of the particle's image
  /// @param spread2  as FilledStop::spread2 [px^2]
  std::size_t step_filled(double light, double spread2) const {
    RaysLaunch const& least = ladder[0];
    RayPlacement const sent = least.rule.view() ? RayPlacement::by_rule : RayPlacement::clipped;
    return ladder.at_least(
        estimate_rays_for_spread(ladder.goal(), sent, light, spread2, static_cast<double>(least.rays)));
  }
  /// Returns the first step in the sequence of ray numbers for a particle whose rays are vignetted at the stop.
  std::size_t step_clipped() const { return ladder.at_least(least_clipped); }
  static constexpr double least_clipped = 32;  ///< minimum number of rays that are vignetted at the stop; with fewer,
                                               ///< the smoothed zone at the edge of the stop is too wide
};

/// Traces the rays of particles, one particle at a time, with the medium in both frames and a particle position and
/// light for each frame. Both frames use the same random keys, so that a particle that has hardly moved sends its rays
/// to the same points of the lens.
///
/// If the rays that fill the stop can be determined beforehand (filled_stop.h), only these are sent: their total light
/// is known, and their positions depend on medium and lens alone, so few rays suffice. Otherwise rays are sent to a
/// larger disc and vignetted at the stop, as for dots. If more rays are required, the deposited light is subtracted and
/// the particle is traced again.
/// @tparam Sources  ParticleSources of one pulse
template <class Sources, class Medium>
class ParticleTracer {
 public:
  ParticleTracer(ParticleLaunches const& launches, Sources const (&pulses)[frame_count], Medium const& medium,
                 bool with_images)
      : launches_(launches),
        pulses_{pulses[0], pulses[1]},
        medium_(medium),
        stop_(launches.sharp.camera),
        with_images_(with_images) {
    use(0);
    view_ = launch_->camera.view();
    for (auto& light : light_) light.emplace(launch_->spot);
  }

  /// Traces a particle with an adaptive number of rays.
  /// @param images  image of each frame; null: light is not deposited
  /// @param light_per_photon  light of an image per photon
  /// @param least  minimum step in the sequence of ray numbers
  /// @return truth of the particle; NaN at a pulse that does not illuminate it or if no ray passes
  TracedParticleTruth trace(std::uint64_t particle, LightImage* const (&images)[frame_count], double light_per_photon,
                            std::size_t least = 0) {
    key_ = pulses_[0].key(particle);
    light_per_photon_ = light_per_photon;
    origin_ = {};
    std::size_t step = std::min(std::max(least, aim(particle)), launches_.ladder.size() - 1);
    while (true) {
      use(step);
      StatusCounts const before = statuses_;
      trace_all(particle, images, 1);
      bool const clipped = aims_[0].sent == Aim::Sent::wide || aims_[1].sent == Aim::Sent::wide;
      EdgeRaySpread const rim{{aims_[0].bent.spread2, aims_[1].bent.spread2},
                              {aims_[0].sent == Aim::Sent::wide, aims_[1].sent == Aim::Sent::wide}};
      RayPlacement const sent = clipped || !launch_->rule.view() ? RayPlacement::clipped : RayPlacement::by_rule;
      std::size_t const next = launches_.ladder.next(step, sent, rim, seen_, light_per_weight());
      if (next == step) break;
      if (with_images_) trace_all(particle, images, -1);
      statuses_ = before;
      step = next;
    }
    for (Aim const& aim : aims_) {
      if (aim.sent == Aim::Sent::wide) largest_margin_ = std::max(largest_margin_, aim.wide.margin);
    }
    int const scramblings = 1 << launch_->choice.scrambling_bits;
    return {source_truth(seen_, scramblings, origin_), source_truth(ambient_, scramblings, origin_)};
  }

  /// Returns the step in the sequence of ray numbers (RaysLadder) at which the last particle was traced; rays() is its
  /// number of rays.
  std::size_t step() const { return static_cast<std::size_t>(launch_ - &launches_.ladder[0]); }
  std::uint64_t rays() const { return launch_->rays; }
  StatusCounts const& statuses() const { return statuses_; }
  /// Largest margin by which a particle's rays were aimed beyond the stop [m].
  double largest_margin() const { return largest_margin_; }

 private:
  static constexpr bool bends = !std::is_same_v<Medium, NoMedium<double>>;
  /// Number of rays traced together, as in SourceTracer.
  static constexpr int rays_traced_together = bends ? 2 : 4;

  /// Target area of a particle's rays at one pulse.
  struct Aim {
    enum class Sent { not_at_all, filled, wide };
    Sent sent = Sent::not_at_all;
    FilledStop straight, bent;  ///< rays that fill the stop exactly, without and with the medium
    SourceAim wide;
  };

  void use(std::size_t step) {
    launch_ = &launches_.ladder[step];
    view_.elements = launch_->camera.elements.data();
  }
  double light_per_weight() const { return light_per_photon_ / static_cast<double>(launch_->rays); }

  /// Aims at both pulses.
  /// @return the first step in the sequence of ray numbers
  std::size_t aim(std::uint64_t particle) {
    bool placed = false;  // whether the origin is set, by the first pulse that illuminates the particle
    std::size_t step = 0;
    for (int frame = 0; frame < frame_count; ++frame) {
      Aim& aim = aims_[frame];
      aim.sent = Aim::Sent::not_at_all;
      auto const& pulse = pulses_[frame];
      if (!(pulse.photons[particle] > 0)) continue;
      Vec3d const place = pulse.middle(particle);
      if (fill(place, aim)) {
        aim.sent = Aim::Sent::filled;
        if (!placed) origin_ = sum_origin(aim.straight);
        double const weight = ray_to(pulse, stop_.camera.aim_plane, aim.bent.map, particle, {}).weight;
        step = std::max(step, launches_.step_filled(weight * light_per_photon_, aim.bent.spread2));
      } else {
        aim.wide = aim_at_stop(*launch_, view_, medium_, place, 0);
        if (!aim.wide.disc) continue;
        aim.sent = Aim::Sent::wide;
        if (!placed) origin_ = aim.wide.origin;
        step = std::max(step, launches_.step_clipped());
      }
      placed = true;
    }
    return step;
  }

  /// Aims exactly at the stop, with and without the medium.
  /// @return false if this fails, or for chief rays
  bool fill(Vec3d place, Aim& aim) const {
    if (launch_->camera.chief_rays_only()) return false;
    aim.straight.map = paraxial_aim(stop_, place);
    if (!fill_stop(stop_, NoMedium<double>{}, launch_->tracing, place, aim.straight)) return false;
    aim.bent = aim.straight;
    if constexpr (bends) {
      if (!fill_stop(stop_, medium_, launch_->tracing, place, aim.bent)) return false;
    }
    return true;
  }

  /// Traces all rays of a particle.
  /// @param sign  sign of the deposited light; -1 subtracts it
  void trace_all(std::uint64_t particle, LightImage* const (&images)[frame_count], double sign) {
    std::fill_n(seen_, most_scramblings, RaySums{});
    std::fill_n(ambient_, most_scramblings, RaySums{});
    for (int frame = 0; frame < frame_count; ++frame) {
      if (aims_[frame].sent == Aim::Sent::filled) trace_filled(frame, particle, images[frame], sign);
      if (aims_[frame].sent == Aim::Sent::wide) trace_wide(frame, particle, images[frame], sign);
    }
  }

  void trace_filled(int frame, std::uint64_t particle, LightImage* image, double sign) {
    Aim const& aim = aims_[frame];
    auto const aimed_by = [&](AimMap const& map) {
      return [&](Vec2d at) { return ray_to(pulses_[frame], stop_.camera.aim_plane, map, particle, at); };
    };
    if (with_images_) light_[frame]->begin(image, sign * light_per_weight(), launch_->rays);
    largest_shift2_ = 0;
    all_rays(launch_->rule.view(), [&]<int N>(std::uint64_t const(&ray)[N], StopSamplePoint const(&to)[N]) {
      RayHit<double> seen[N], ambient[N];
      trace_through(aimed_by(aim.bent.map), to, stop_.camera, medium_, seen);
      if constexpr (bends) {
        trace_through(aimed_by(aim.straight.map), to, stop_.camera, NoMedium<double>{}, ambient);
      } else {
        std::copy_n(seen, N, ambient);
      }
      enter(frame, ray, seen, ambient);
    });
    if (with_images_) light_[frame]->finish();
  }

  /// Sends rays to a disc larger than the stop, the same with and without the medium. If a ray is deflected by more
  /// than the margin of the disc, its light is subtracted and all rays are traced again with a larger margin.
  void trace_wide(int frame, std::uint64_t particle, LightImage* image, double sign) {
    SourceAim& aim = aims_[frame].wide;
    auto const trace = [&](double of_light) {
      AimedBundle<double> const bundle = launch_->bundle(*aim.disc, {}, aim.margin);
      auto const aimed = [&](Vec2d at) { return ray_to(pulses_[frame], bundle, particle, {}, at); };
      if (with_images_) light_[frame]->begin(image, of_light * light_per_weight(), launch_->rays);
      largest_shift2_ = 0;
      all_rays(StopRuleView{}, [&]<int N>(std::uint64_t const(&ray)[N], StopSamplePoint const(&to)[N]) {
        RayHit<double> seen[N], ambient[N];
        trace_through(aimed, to, view_, NoMedium<double>{}, ambient);
        if constexpr (bends) {
          trace_through(aimed, to, view_, medium_, seen);
        } else {
          std::copy_n(ambient, N, seen);
        }
        enter(frame, ray, seen, ambient);
      });
      if (with_images_) light_[frame]->finish();
      return std::sqrt(largest_shift2_);
    };
    while (true) {
      auto const before = statuses_[static_cast<std::size_t>(frame)];
      double const shift = trace(sign);
      if (launch_->camera.chief_rays_only() || !(shift > aim.margin)) break;
      if (with_images_) trace(-sign);
      statuses_[static_cast<std::size_t>(frame)] = before;
      for (int i = 0; i < most_scramblings; ++i) seen_[i].hits[frame] = ambient_[i].hits[frame] = {};
      aim.margin = launch_->wider_margin(shift);
    }
  }

  /// Calls some(rays, points of the unit disc) for groups of all rays.
  /// @param rule  cubature rule; empty: points of a Sobol or random sequence
  template <class Some>
  void all_rays(StopRuleView const& rule, Some&& some) {
    std::uint64_t ray = 0;
    for (; ray + rays_traced_together <= launch_->rays; ray += rays_traced_together)
      these_rays<rays_traced_together>(rule, ray, some);
    for (; ray < launch_->rays; ++ray) these_rays<1>(rule, ray, some);
  }
  template <int N, class Some>
  void these_rays(StopRuleView const& rule, std::uint64_t first, Some&& some) {
    throw_if_interrupted();
    std::uint64_t ray[N];
    StopSamplePoint to[N];
    for (int i = 0; i < N; ++i) {
      ray[i] = first + static_cast<std::uint64_t>(i);
      to[i] = sample_stop_point(rule, launch_->choice, key_, ray[i]);
    }
    some(ray, to);
  }

  /// Traces N rays through a medium and the camera.
  /// @param aimed  returns the AimedRay to a point of the unit disc
  template <int N, class Aimed, class Through>
  void trace_through(Aimed const& aimed, StopSamplePoint const (&to)[N], CameraView<double> const& view,
                     Through const& medium, RayHit<double> (&hit)[N]) const {
    Ray<double> start[N];
    double weight[N];
    for (int i = 0; i < N; ++i) {
      AimedRay<double> const one = aimed(to[i].at);
      start[i] = one.ray;
      weight[i] = to[i].share * one.weight;
    }
    trace_rays(view, medium, launch_->tracing, start, weight, hit);
  }

  template <int N>
  void enter(int frame, std::uint64_t const (&ray)[N], RayHit<double> const (&seen)[N],
             RayHit<double> const (&ambient)[N]) {
    auto const mask = (std::uint64_t{1} << launch_->choice.scrambling_bits) - 1;
    for (int i = 0; i < N; ++i) {
      add(ambient[i], ambient_[ray[i] & mask].hits[frame]);
      add(seen[i], seen_[ray[i] & mask].hits[frame]);
      ++statuses_[static_cast<std::size_t>(frame)][static_cast<std::size_t>(seen[i].status)];
      if (with_images_ && seen[i].weight != 0) light_[frame]->deposit(seen[i].pixel, seen[i].weight);
      if (std::max(ambient[i].status, seen[i].status) > RayStatus::vignetted) continue;
      Vec2d const shift = seen[i].at_lens - ambient[i].at_lens;
      largest_shift2_ = std::max(largest_shift2_, dot(shift, shift));
    }
  }
  void add(RayHit<double> const& hit, CentroidSum<double>& sum) const {
    if (hit.weight != 0) sum.add(hit.pixel - origin_, hit.weight, reaches_sensor_plane(hit.status));
  }

  ParticleLaunches const& launches_;
  RaysLaunch const* launch_ = nullptr;  ///< launch of the current step
  Sources pulses_[frame_count];
  Medium const& medium_;
  CameraView<double> view_;
  StopView stop_;
  bool with_images_;
  std::optional<RayLight> light_[frame_count];
  RaySums seen_[most_scramblings], ambient_[most_scramblings];
  Aim aims_[frame_count];
  std::uint64_t key_ = 0;  ///< key of the particle's random numbers
  double light_per_photon_ = 0;
  Vec2d origin_{};  ///< whole-pixel position to which sums are relative [px]
  StatusCounts statuses_{};
  double largest_shift2_ = 0, largest_margin_ = 0;
};

}  // namespace gladstone::inline rays
