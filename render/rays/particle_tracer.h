#pragma once

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "render/rays/aimed_sources.h"
#include "render/rays/particle_aim.h"
#include "render/rays/particle_rays.h"
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
};

/// Aims the rays of a particle at one pulse at a disc larger than the stop, at which they are vignetted.
/// @param aim  set to the state `wide`, or `none` if no ray passes
/// @param start  updated if a ray passes
template <class Medium>
SourceAim aim_wide_pulse(RaysLadder const& ladder, Medium const& medium, Vec3d place, PulseAim& aim,
                         ParticleStart& start) {
  SourceAim const wide = aim_at_stop(ladder[0], ladder[0].camera.view(), medium, place, 0);
  aim = {};
  if (!wide.disc) return wide;
  aim.state = AimState::wide;
  start.add_pulse(wide.origin, ladder.view().step_clipped());
  return wide;
}

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
                            int least = 0) {
    key_ = pulses_[0].key(particle);
    light_per_photon_ = light_per_photon;
    LadderView const& ladder = launches_.ladder.view();
    ParticleStart const start = aim(particle);
    origin_ = start.origin;
    int step = std::min(std::max(least, start.step), ladder.steps - 1);
    while (true) {
      use(step);
      StatusCounts const before = statuses_;
      trace_all(particle, images, 1);
      int const next = next_particle_step(ladder, step, aims_, seen_, light_per_photon_);
      if (next == step) break;
      if (with_images_) trace_all(particle, images, -1);
      statuses_ = before;
      step = next;
    }
    for (int frame = 0; frame < frame_count; ++frame) {
      if (aims_[frame].state == AimState::wide) largest_margin_ = std::max(largest_margin_, wide_[frame].margin);
    }
    int const scramblings = 1 << launch_->choice.scrambling_bits;
    return {source_truth(seen_, scramblings, origin_), source_truth(ambient_, scramblings, origin_)};
  }

  /// Returns the step in the sequence of ray numbers (RaysLadder) at which the last particle was traced; rays() is its
  /// number of rays.
  int step() const { return static_cast<int>(launch_ - &launches_.ladder[0]); }
  std::uint64_t rays() const { return launch_->rays; }
  StatusCounts const& statuses() const { return statuses_; }
  /// Largest margin by which a particle's rays were aimed beyond the stop [m].
  double largest_margin() const { return largest_margin_; }

 private:
  static constexpr bool bends = !std::is_same_v<Medium, NoMedium<double>>;
  /// Number of rays traced together, as in SourceTracer.
  static constexpr int rays_traced_together = bends ? 2 : 4;

  void use(int step) {
    launch_ = &launches_.ladder[step];
    view_.elements = launch_->camera.elements.data();
  }
  double light_per_weight() const { return light_per_photon_ / static_cast<double>(launch_->rays); }

  /// Aims at both pulses.
  ParticleStart aim(std::uint64_t particle) {
    ParticleStart start;
    for (int frame = 0; frame < frame_count; ++frame) {
      auto const& pulse = pulses_[frame];
      aims_[frame] = aim_pulse(stop_, launch_->tracing, medium_, pulse, particle, launches_.ladder.view(),
                               light_per_photon_, start);
      if (aims_[frame].state != AimState::unknown) continue;
      wide_[frame] = aim_wide_pulse(launches_.ladder, medium_, pulse.middle(particle), aims_[frame], start);
    }
    return start;
  }

  /// Traces all rays of a particle.
  /// @param sign  sign of the deposited light; -1 subtracts it
  void trace_all(std::uint64_t particle, LightImage* const (&images)[frame_count], double sign) {
    std::fill_n(seen_, most_scramblings, RaySums{});
    std::fill_n(ambient_, most_scramblings, RaySums{});
    for (int frame = 0; frame < frame_count; ++frame) {
      if (aims_[frame].state == AimState::filled) trace_filled(frame, particle, images[frame], sign);
      if (aims_[frame].state == AimState::wide) trace_wide(frame, particle, images[frame], sign);
    }
  }

  void trace_filled(int frame, std::uint64_t particle, LightImage* image, double sign) {
    auto const aimed_by = [&](AimMap const& map) {
      return [&](Vec2d at) { return ray_to(pulses_[frame], stop_.camera.aim_plane, map, particle, at); };
    };
    trace_frame(frame, launch_->rule.view(), stop_.camera, aimed_by(aims_[frame].seen), aimed_by(aims_[frame].ambient),
                image, sign);
  }

  /// Sends rays to a disc larger than the stop, the same with and without the medium. If a ray is deflected by more
  /// than the margin of the disc, its light is subtracted and all rays are traced again with a larger margin.
  void trace_wide(int frame, std::uint64_t particle, LightImage* image, double sign) {
    SourceAim& aim = wide_[frame];
    auto const trace = [&](double of_light) {
      AimedBundle<double> const bundle = launch_->bundle(*aim.disc, {}, aim.margin);
      auto const aimed = [&](Vec2d at) { return ray_to(pulses_[frame], bundle, particle, {}, at); };
      return trace_frame(frame, StopRuleView{}, view_, aimed, aimed, image, of_light);
    };
    while (true) {
      auto const before = statuses_[static_cast<std::size_t>(frame)];
      auto const wider = launch_->wider_margin(aim.margin, trace(sign));
      if (!wider) break;
      if (with_images_) trace(-sign);
      statuses_[static_cast<std::size_t>(frame)] = before;
      for (int i = 0; i < most_scramblings; ++i) seen_[i].hits[frame] = ambient_[i].hits[frame] = {};
      aim.margin = *wider;
    }
  }

  /// Traces all rays of a particle in one frame.
  /// @param rule  cubature rule; empty: points of a Sobol or random sequence
  /// @param aim, ambient_aim  as for trace_particle_rays()
  /// @return largest deflection of a ray by the medium on the aim plane [m]
  template <class Aim, class AmbientAim>
  double trace_frame(int frame, StopRuleView const& rule, CameraView<double> const& view, Aim const& aim,
                     AmbientAim const& ambient_aim, LightImage* image, double sign) {
    if (with_images_) light_[frame]->begin(image, sign * light_per_weight(), launch_->rays);
    double largest_shift2 = 0;
    auto const trace_some = [&]<int N>(std::integral_constant<int, N>, std::uint64_t first) {
      throw_if_interrupted();
      StopSamplePoint to[N];
      for (int i = 0; i < N; ++i)
        to[i] = sample_stop_point(rule, launch_->choice, key_, first + static_cast<std::uint64_t>(i));
      ParticleRays<N> const rays = trace_particle_rays(view, medium_, launch_->tracing, to, aim, ambient_aim);
      enter(frame, first, rays);
      for (double const shift2 : rays.deflection2) largest_shift2 = std::max(largest_shift2, shift2);
    };
    std::uint64_t ray = 0;
    for (; ray + rays_traced_together <= launch_->rays; ray += rays_traced_together)
      trace_some(std::integral_constant<int, rays_traced_together>{}, ray);
    for (; ray < launch_->rays; ++ray) trace_some(std::integral_constant<int, 1>{}, ray);
    if (with_images_) light_[frame]->finish();
    return std::sqrt(largest_shift2);
  }

  template <int N>
  void enter(int frame, std::uint64_t first, ParticleRays<N> const& rays) {
    auto const mask = (std::uint64_t{1} << launch_->choice.scrambling_bits) - 1;
    for (int i = 0; i < N; ++i) {
      std::uint64_t const scrambling = (first + static_cast<std::uint64_t>(i)) & mask;
      rays.enter(i, origin_, seen_[scrambling].hits[frame], ambient_[scrambling].hits[frame]);
      RayHit<double> const& seen = rays.seen[i];
      ++statuses_[static_cast<std::size_t>(frame)][static_cast<std::size_t>(seen.status)];
      if (with_images_ && seen.weight != 0) light_[frame]->deposit(seen.pixel, seen.weight);
    }
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
  PulseAim aims_[frame_count];
  SourceAim wide_[frame_count];  ///< target of aims in the state `wide`
  std::uint64_t key_ = 0;        ///< key of the particle's random numbers
  double light_per_photon_ = 0;
  Vec2d origin_{};  ///< whole-pixel position to which sums are relative [px]
  StatusCounts statuses_{};
  double largest_margin_ = 0;
};

}  // namespace gladstone::inline rays
