#include "cuda/rays/cuda_particle_tracer.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>
#include <vector>

#include "cuda/device/launch.h"
#include "cuda/rays/particles_on_device.h"
#include "render/base/interrupt.h"
#include "render/base/parallel.h"
#include "render/base/progress.h"
#include "render/rays/trace_particles.h"
#include "render/scene/light_through_lens.h"

namespace gladstone::cuda::inline rays {
namespace {

/// Maximum memory [bytes] and maximum number of particles of a batch.
constexpr std::size_t most_batch_bytes = std::size_t{256} << 20, most_of_batch = std::size_t{1} << 20;

/// Particles at both pulses, in host memory.
using HostPulses = ParticleSources<double, AnyScattering>[frame_count];

/// Traces a batch of particles on the device. The medium is also needed on the host, which determines the ray
/// directions of particles whose rays the device cannot restrict to the stop.
template <class Medium>
class BatchPass {
 public:
  /// Starts aiming the particles on the device. @param launches  launches of the batch's particles, one per number of
  /// rays
  BatchPass(ParticleLaunches const& host, LaunchesOnDevice const& on_device, std::vector<ParticlesLaunch> launches,
            HostPulses const& pulses, Medium const& medium, DeviceMedium const& mirrored, ParticleBatch& batch,
            double across_medium, unsigned long long* ends)
      : host_(host),
        on_device_(on_device),
        launches_(std::move(launches)),
        pulses_(pulses),
        medium_(medium),
        mirrored_(mirrored),
        batch_(batch),
        across_medium_(across_medium),
        ends_(ends) {
    batch.counts().zero();
    aim_particles(on_device.stop(), launches_[0], on_device.ladder(), mirrored, batch.count(), batch.aims().data(),
                  batch.origins().data(), batch.steps());
    list(batch.steps().step);
  }

  /// Traces all rays required, and stores the truth.
  void finish(PinnedBuffer& staging, GroundTruth& truth) {
    constexpr bool bends = !std::is_same_v<Medium, NoMedium<double>>;
    std::size_t const count = batch_.count();
    DotTruth* const ambient_there = bends ? batch_.ambient().data() : nullptr;
    trace_listed(1);
    if (counted(LadderView::max_step_count) > 0) aim_wide();
    while (true) {
      batch_.counts().zero();
      see_particles(on_device_.ladder(), batch_.aims().data(), batch_.origins().data(), batch_.sums().data(), count,
                    batch_.steps(), batch_.truth().data(), ambient_there);
      if (launches_.size() == 1) break;
      batch_.counts().download(counts_, LadderView::max_step_count + 1);
      if (counted(LadderView::max_step_count) == 0) break;
      throw_if_interrupted();
      go_on();
    }
    auto* const seen = static_cast<DotTruth*>(staging.reserve(count * (2 * sizeof(DotTruth) + sizeof(int))));
    batch_.truth().download(seen, count);
    DotTruth* const ambient = bends ? seen + count : seen;
    if (bends) batch_.ambient().download(ambient, count);
    auto* const step = reinterpret_cast<int*>(seen + 2 * count);
    batch_.all_steps().download(step, count);
    std::size_t const first = launches_[0].first;
    parallel_chunks(count, 1024, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        set_particle(truth, first + i, {seen[i], ambient[i]}, launches_[static_cast<std::size_t>(step[i])].rays);
      }
    });
  }

  /// Returns the largest margin by which any particle was aimed beyond the stop [m].
  double largest_margin() const {
    double largest = 0;
    for (std::uint32_t const at : wide_) largest = std::max(largest, found_[at].margin);
    return largest;
  }

 private:
  unsigned int counted(std::size_t step) const { return counts_[step]; }

  /// Lists, by number of rays, the chosen particles (with their pulse) whose rays fill the stop.
  void list(int const* at) {
    list_particles(on_device_.ladder(), batch_.aims().data(), at, batch_.steps(), batch_.count(),
                   batch_.listed(launches_.size()));
  }
  /// Traces the listed aims. @param sign  -1 removes the light and the ray counts of an earlier call
  void trace_listed(double sign) {
    batch_.counts().download(counts_, LadderView::max_step_count + 1);
    for (std::size_t step = 0; step < launches_.size(); ++step) {
      trace(AimState::filled, step, batch_.listed(launches_.size()) + step * frame_count * batch_.count(),
            counted(step), sign);
    }
  }
  /// Traces `count` aims with the number of rays of a step of RaysLadder. @param listed  indices of the aims, in device
  /// memory
  void trace(AimState state, std::size_t step, std::uint32_t const* listed, std::size_t count, double sign) {
    ParticlesLaunch launch = launches_[step];
    launch.sign = sign;
    if (state == AimState::wide) launch.camera.elements = on_device_.smooth(step);
    // Limit the number of aims per launch, so that no launch takes long.
    double const at_once = max_steps_per_launch / on_device_.steps_per_particle(across_medium_, step);
    auto const most = static_cast<std::size_t>(std::clamp(frame_count * at_once, 1.0, 1e9));
    for (std::size_t first = 0; first < count; first += most) {
      throw_if_interrupted();
      trace_particles(launch, mirrored_, state, batch_.aims().data(), batch_.origins().data(), listed + first,
                      std::min(most, count - first), {batch_.sums().data(), batch_.moved2().data(), ends_});
    }
  }

  /// Removes the light of particles that need more rays, and traces them again with the next number of rays.
  void go_on() {
    std::size_t const count = batch_.count();
    batch_.counts().zero();
    list(batch_.steps().step);
    trace_listed(-1);
    batch_.counts().zero();
    list(batch_.steps().next);
    trace_listed(1);
    if (wide_.empty()) return;
    std::vector<int> steps(3 * count);
    batch_.all_steps().download(steps.data(), steps.size());
    std::vector<std::uint32_t> chosen;
    for (std::uint32_t const at : wide_) {
      if (steps[2 * count + at / frame_count] != 0) chosen.push_back(at);
    }
    trace_wide(chosen, steps.data(), -1);
    for (std::uint32_t const at : chosen) place_aim(at, static_cast<std::size_t>(steps[count + at / frame_count]));
    batch_.aims().upload(aims_.data());
    trace_wider(chosen, steps.data() + count);
  }

  /// Determines on the host the ray directions that the device did not find, and traces these particles.
  void aim_wide() {
    std::size_t const count = batch_.count();
    aims_.resize(batch_.aims().size());
    found_.resize(aims_.size());
    std::vector<Vec2d> origins(count);
    std::vector<int> steps(3 * count);
    batch_.aims().download(aims_.data(), aims_.size());
    batch_.origins().download(origins.data(), origins.size());
    batch_.all_steps().download(steps.data(), steps.size());
    parallel_chunks(count, 8, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        steps[2 * count + i] = 1 - steps[2 * count + i];  // choose the particles that have not been traced yet
        if (steps[2 * count + i] != 0) steps[i] = aim_at_host(i, origins[i], steps[i]);
        steps[count + i] = steps[i];
      }
    });
    for (std::size_t at = 0; at < aims_.size(); ++at) {
      if (aims_[at].state == AimState::wide) wide_.push_back(static_cast<std::uint32_t>(at));
    }
    batch_.origins().upload(origins.data());
    batch_.aims().upload(aims_.data());
    batch_.all_steps().upload(steps.data());
    batch_.counts().zero();
    list(batch_.steps().step);
    trace_listed(1);
    trace_wider(wide_, steps.data());
  }

  /// Traces particles whose rays are clipped at the stop, in groups of equal number of rays.
  void trace_wide(std::vector<std::uint32_t> const& aims, int const* step, double sign) {
    for (std::size_t here = 0; here < launches_.size(); ++here) {
      std::vector<std::uint32_t> some;
      std::copy_if(aims.begin(), aims.end(), std::back_inserter(some),
                   [&](std::uint32_t at) { return static_cast<std::size_t>(step[at / frame_count]) == here; });
      if (some.empty()) continue;
      DeviceArray<std::uint32_t> const listed(some.data(), some.size(), "the particles");
      trace(AimState::wide, here, listed.data(), some.size(), sign);
    }
  }
  /// Like trace_wide(); aims with a ray that was deflected beyond the margin are removed, and traced again with a
  /// larger margin.
  void trace_wider(std::vector<std::uint32_t> aims, int const* step) {
    while (!aims.empty()) {
      throw_if_interrupted();
      batch_.moved2().zero();
      trace_wide(aims, step, 1);
      std::vector<double> moved2(aims_.size());
      batch_.moved2().download(moved2.data(), moved2.size());
      std::vector<std::uint32_t> missed;
      for (std::uint32_t const at : aims) {
        auto const wider = host_.sharp.wider_margin(found_[at].margin, std::sqrt(moved2[at]));
        if (!wider) continue;
        found_[at].margin = *wider;
        missed.push_back(at);
      }
      trace_wide(missed, step, -1);  // remove the light of the previous aims, which are still on the device
      for (std::uint32_t const at : missed) place_aim(at, static_cast<std::size_t>(step[at / frame_count]));
      if (!missed.empty()) batch_.aims().upload(aims_.data());
      aims = std::move(missed);
    }
  }

  /// Aims at the stop for those pulses of a particle that the device could not aim. @return the particle's first step
  /// of RaysLadder
  int aim_at_host(std::size_t i, Vec2d& origin, int step) {
    PulseAim* const aims = &aims_[frame_count * i];
    ParticleStart start{origin, step, aims[0].state == AimState::filled || aims[1].state == AimState::filled};
    for (std::size_t pulse = 0; pulse < frame_count; ++pulse) {
      if (aims[pulse].state != AimState::unknown) continue;
      throw_if_interrupted();
      found_[frame_count * i + pulse] =
          aim_wide_pulse(host_.ladder, medium_, pulses_[pulse].middle(launches_[0].first + i), aims[pulse], start);
    }
    origin = start.origin;
    for (std::size_t at = frame_count * i; at < frame_count * (i + 1); ++at) {
      if (aims_[at].state == AimState::wide) place_aim(at, static_cast<std::size_t>(start.step));
    }
    return start.step;
  }
  /// Sets the aim point and extent of the rays of an aim set by the host, for the number of rays of a step of
  /// RaysLadder.
  void place_aim(std::size_t at, std::size_t step) {
    PulseAim& aim = aims_[at];
    SourceAim const& found = found_[at];
    AimedBundle<double> const bundle = host_.ladder[step].bundle(*found.disc, {}, found.margin);
    Pose<double> const& plane = launches_[0].camera.aim_plane;
    auto const along = [&plane](Vec3d v) {
      Vec3d const there = plane.direction_to_local(v);
      return Vec2d{there.x, there.y};
    };
    Vec3d const centre = plane.point_to_local(bundle.centre);
    aim.seen = {};
    aim.seen.centre = {centre.x, centre.y};
    aim.seen.a[0] = along(bundle.a);
    aim.seen.b[0] = along(bundle.b);
    aim.ambient = aim.seen;
    aim.low = found.low[1];
    aim.high = found.high[1];
  }

  ParticleLaunches const& host_;
  LaunchesOnDevice const& on_device_;
  std::vector<ParticlesLaunch> launches_;
  HostPulses const& pulses_;
  Medium const& medium_;
  DeviceMedium const& mirrored_;
  ParticleBatch& batch_;
  double across_medium_;
  unsigned long long* ends_;
  unsigned int counts_[LadderView::max_step_count + 1] = {};
  std::vector<PulseAim> aims_;       ///< ray directions of all particles of the batch; empty if the device determines
                                     ///< all of them
  std::vector<SourceAim> found_;     ///< results of aim_at_stop() for the particles whose ray directions the host
                                     ///< determines
  std::vector<std::uint32_t> wide_;  ///< indices in aims_ of these particles
};

/// Returns the number of particles per batch, limited by memory and by the duration of a launch.
std::size_t batch_size(double steps_across, LaunchesOnDevice const& launches) {
  double const at_once = max_steps_per_launch / launches.steps_per_particle(steps_across, 0);
  return std::clamp<std::size_t>(
      std::min(most_batch_bytes / ParticleBatch::device_bytes_per_particle(launches.ladder().sums_per_pulse),
               static_cast<std::size_t>(std::min(at_once, 1e9))),
      1, most_of_batch);
}

}  // namespace

Rendering trace_particles_on_device(Scene const& scene, RenderPlan const& plan, Particles const& particles,
                                    ParticleLight light, RenderImages images, DeviceMedium const& medium,
                                    ScatteringCache& kept, PinnedBuffer& staging) {
  std::optional<AiryTable> airy;
  bool const lit = images != RenderImages::no;
  ParticleLaunches const host(scene, plan, lit ? make_spot(scene, airy) : SpotView{}, images);
  CameraSetup const& camera = scene.setup.camera;
  std::optional<ImagePairOnDevice> frames;
  if (lit) frames.emplace(camera.columns, camera.rows);
  LaunchesOnDevice const launches(host, medium, frames ? &*frames : nullptr,
                                  lit ? 1 / photon_unit(scene, particles, light) : 0);
  LaserSheet<double> const sheet = laser_sheet(scene.setup.piv->laser);
  AnyScattering scattering;
  scattering.lambert.diameter = particles.diameter.data();
  if (light == ParticleLight::scattered) {
    scattering.kind = scene.mie ? AnyScattering::Kind::mie : AnyScattering::Kind::lambert;
    if (scene.mie) scattering.mie = scene.mie->view();
    kept.upload(scene.mie);
  }
  HostPulses pulses;
  for (int pulse = 0; pulse < frame_count; ++pulse) {
    pulses[pulse] = {particles.place[pulse].data(), particles.photons[pulse].data(), scattering, sheet, pulse};
  }
  Rendering rendering;
  double const steps_across = scene.steps_across(plan.step);
  std::size_t const most = batch_size(steps_across, launches);
  DeviceArray<unsigned long long> ends(frame_count * ray_status_count, "the sums over a batch's rays");
  ends.zero();
  double margin = 0;
  Progress progress(lit ? "tracing particles" : "tracing truth", particles.size());
  auto const trace_all = [&](auto const& host_medium) {
    for (std::size_t first = 0; first < particles.size(); first += most) {
      throw_if_interrupted();
      std::size_t const count = std::min(most, particles.size() - first);
      ParticleBatch batch(particles, first, count, launches.ladder().sums_per_pulse, staging);
      if (scattering.kind == AnyScattering::Kind::mie) scattering.mie = kept.view(first);
      std::vector<ParticlesLaunch> of_batch;
      for (std::size_t step = 0; step < launches.steps(); ++step) {
        batch.fill(of_batch.emplace_back(launches.filled(step)), first, scattering, sheet);
      }
      BatchPass pass(host, launches, std::move(of_batch), pulses, host_medium, medium, batch, steps_across,
                     ends.data());
      if (first == 0) rendering = empty_rendering(particles);  // the truth is allocated while the device is working
      pass.finish(staging, rendering.truth);
      margin = std::max(margin, pass.largest_margin());
      progress.advance(count);
    }
  };
  if (particles.size() > 0) {
    std::visit(trace_all, scene.medium.view);
  } else {
    rendering = empty_rendering(particles);
  }
  rendering.pupil_margin = margin;
  unsigned long long ended[frame_count * ray_status_count] = {};
  ends.download(ended, frame_count * ray_status_count);
  for (std::size_t i = 0; i < frame_count * ray_status_count; ++i) {
    rendering.statuses[i / ray_status_count][i % ray_status_count] += static_cast<std::int64_t>(ended[i]);
  }
  count_rays(rendering);
  if (!lit) return rendering;
  auto made = std::make_shared<DeviceLight>(camera.columns, camera.rows);
  frames->to_light(*made);
  if (images == RenderImages::yes) rendering.light = made->to_host(staging);
  if (images == RenderImages::in_place) rendering.in_place = std::move(made);
  return rendering;
}

}  // namespace gladstone::cuda::inline rays
