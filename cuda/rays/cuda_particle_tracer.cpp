#include "cuda/rays/cuda_particle_tracer.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "cuda/device/launch.h"
#include "cuda/rays/particles_on_device.h"
#include "render/base/interrupt.h"
#include "render/base/parallel.h"
#include "render/base/progress.h"
#include "render/rays/trace_particles.h"
#include "render/scene/particle_scene.h"

namespace gladstone::cuda {
namespace {

/// Memory of one batch of particles [bytes], and the most particles that it has.
constexpr std::size_t most_batch_bytes = std::size_t{256} << 20, most_of_batch = std::size_t{1} << 20;

/// Particles at both pulses, in the host's memory.
using HostPulses = ParticleSources<double, AnyScattering>[frame_count];

/// Takes particles through the device, batch by batch. The medium is there twice, for the host aims those that do not
/// fill the stop.
template <class Medium>
class ParticlePasses {
 public:
  ParticlePasses(ParticleLaunch const& host, LaunchesOnDevice const& launches, HostPulses const& pulses,
                 Medium const& medium, DeviceMedium<double> const& mirrored, PinnedBuffer& staging)
      : host_(host),
        launches_(launches),
        pulses_(pulses),
        medium_(medium),
        mirrored_(mirrored),
        staging_(staging),
        ends_(frame_count * ray_status_count, "the sums over a batch's rays"),
        unknown_(1, "the particles") {
    ends_.zero();
  }

  /// Sets the device to work on a batch. @param launch of the batch's particles
  void start(ParticleBatch& batch, ParticlesLaunch const& launch) {
    unknown_.zero();
    aim_particles(launches_.stop(), launch, mirrored_, batch.count(), batch.aims().data(), batch.origins().data(),
                  unknown_.data());
    trace(batch, launch, AimState::filled, nullptr, frame_count * batch.count());
  }

  /// Waits for it, traces what the host has to aim, and enters the truth.
  void finish(ParticleBatch& batch, ParticlesLaunch const& launch, double photons_per_weight, GroundTruth& truth) {
    unsigned long long unknown = 0;
    unknown_.download(&unknown, 1);
    if (unknown > 0) trace_wide(batch, launch);
    constexpr bool bends = !std::is_same_v<Medium, NoMedium<double>>;
    std::size_t const count = batch.count();
    DotTruth* const ambient_there = bends ? batch.ambient().data() : nullptr;
    see_particles(launch, batch.aims().data(), batch.origins().data(), batch.sums().data(), count, batch.truth().data(),
                  ambient_there);
    auto* const seen = static_cast<DotTruth*>(staging_.reserve(2 * count * sizeof(DotTruth)));
    batch.truth().download(seen, count);
    DotTruth* const ambient = bends ? seen + count : seen;
    if (bends) batch.ambient().download(ambient, count);
    parallel_chunks(count, 1024, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        set_particle(truth, launch.first + i, {seen[i], ambient[i]}, photons_per_weight);
      }
    });
  }

  /// Adds what became of all rays.
  void count(StatusCounts& statuses) const {
    unsigned long long ends[frame_count * ray_status_count] = {};
    ends_.download(ends, frame_count * ray_status_count);
    for (std::size_t i = 0; i < frame_count * ray_status_count; ++i) {
      statuses[i / ray_status_count][i % ray_status_count] += static_cast<std::int64_t>(ends[i]);
    }
  }
  /// The widest that any particle was aimed beyond the stop [m].
  double largest_margin() const { return largest_margin_; }

 private:
  void trace(ParticleBatch& batch, ParticlesLaunch const& launch, AimState state, std::uint32_t const* listed,
             std::size_t count) {
    trace_particles(launch, mirrored_, state, batch.aims().data(), batch.origins().data(), listed, count,
                    {batch.sums().data(), batch.bend2().data(), ends_.data()});
  }
  void trace_listed(ParticleBatch& batch, ParticlesLaunch const& launch, std::vector<std::uint32_t> const& listed,
                    double sign) {
    DeviceArray<std::uint32_t> const on_device(listed.data(), listed.size(), "the particles");
    trace(batch, launches_.wide(launch, sign), AimState::wide, on_device.data(), listed.size());
  }

  /// Aims at the host what the device could not, and traces it; what is bent beyond its margin is taken back and traced
  /// again, wider.
  void trace_wide(ParticleBatch& batch, ParticlesLaunch const& launch) {
    std::vector<PulseAim> aims(batch.aims().size());
    std::vector<Vec2d> origins(batch.count());
    batch.aims().download(aims.data(), aims.size());
    batch.origins().download(origins.data(), origins.size());
    std::vector<SourceAim> found(aims.size());
    parallel_chunks(batch.count(), 8, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) aim_at_host(i, launch, &aims[frame_count * i], origins[i], found);
    });
    std::vector<std::uint32_t> listed;
    for (std::size_t at = 0; at < aims.size(); ++at) {
      if (aims[at].state == AimState::wide) listed.push_back(static_cast<std::uint32_t>(at));
    }
    batch.origins().upload(origins.data());
    while (!listed.empty()) {
      throw_if_interrupted();
      batch.aims().upload(aims.data());
      batch.bend2().zero();
      trace_listed(batch, launch, listed, 1);
      std::vector<double> bend2(aims.size());
      batch.bend2().download(bend2.data(), bend2.size());
      std::vector<std::uint32_t> missed;
      for (std::uint32_t const at : listed) {
        double const bend = std::sqrt(bend2[at]);
        if (host_.smooth.camera.chief_rays_only() || !(bend > found[at].margin)) {
          largest_margin_ = std::max(largest_margin_, found[at].margin);
          continue;
        }
        missed.push_back(at);
        found[at].margin = host_.smooth.wider_margin(bend);
        aim_wide(at, launch, found[at], aims[at]);
      }
      if (!missed.empty()) trace_listed(batch, launch, missed, -1);  // with the aims that are there still
      listed = std::move(missed);
    }
    batch.aims().upload(aims.data());
  }

  /// Aims at both pulses of a particle what is not known yet.
  void aim_at_host(std::size_t i, ParticlesLaunch const& launch, PulseAim* aims, Vec2d& origin,
                   std::vector<SourceAim>& found) const {
    bool placed = aims[0].state == AimState::filled || aims[1].state == AimState::filled;
    for (std::size_t pulse = 0; pulse < frame_count; ++pulse) {
      if (aims[pulse].state != AimState::unknown) continue;
      throw_if_interrupted();
      std::size_t const at = frame_count * i + pulse;
      aims[pulse] = {};
      found[at] =
          aim_at_stop(host_.smooth, host_.smooth.camera.view(), medium_, pulses_[pulse].middle(launch.first + i));
      if (!found[at].disc) continue;
      aim_wide(at, launch, found[at], aims[pulse]);
      if (!placed) origin = found[at].origin;
      placed = true;
    }
  }
  void aim_wide(std::size_t at, ParticlesLaunch const& launch, SourceAim const& found, PulseAim& aim) const {
    std::size_t const pulse = at % frame_count;
    AimedBundle<double> const bundle = host_.smooth.bundle(*found.disc, 0, found.margin);
    aim.state = AimState::wide;
    Pose<double> const& plane = launch.camera.aim_plane;
    auto const along = [&plane](Vec3d v) {
      Vec3d const there = plane.direction_inwards(v);
      return Vec2d{there.x, there.y};
    };
    Vec3d const centre = plane.point_inwards(bundle.centre);
    aim.seen = {};
    aim.seen.centre = {centre.x, centre.y};
    aim.seen.a[0] = along(bundle.a);
    aim.seen.b[0] = along(bundle.b);
    aim.ambient = aim.seen;
    if (launch.most_window_px > 0) {
      aim.most_weight = weight_expected(launch, pulses_[pulse], aim.seen, launch.first + at / frame_count);
    }
    place_window(launch, found.low[1], found.high[1], aim);
  }

  ParticleLaunch const& host_;
  LaunchesOnDevice const& launches_;
  HostPulses const& pulses_;
  Medium const& medium_;
  DeviceMedium<double> const& mirrored_;
  PinnedBuffer& staging_;
  DeviceArray<unsigned long long> ends_, unknown_;
  double largest_margin_ = 0;
};

/// Particles of a batch: so many that they fit, and that one launch does not take long.
std::size_t batch_size(Scene const& scene, LaunchesOnDevice const& launches) {
  double const at_once = most_steps_a_launch / launches.steps_a_particle(scene.steps_across());
  return std::clamp<std::size_t>(std::min(most_batch_bytes / ParticleBatch::bytes_a_particle(launches.sums_a_pulse()),
                                          static_cast<std::size_t>(std::min(at_once, 1e9))),
                                 1, most_of_batch);
}

}  // namespace

Rendering trace_particles_on_device(Scene& scene, Particles const& particles, ParticleLight light, RenderImages images,
                                    DeviceMedium<double> const& medium, KeptScattering& kept, PinnedBuffer& staging) {
  std::optional<AiryTable> airy;
  bool const lit = images != RenderImages::no;
  ParticleLaunch const host(scene, lit ? make_spot(scene, airy) : SpotView{});
  CameraSetup const& camera = scene.setup.camera;
  std::optional<ImagePairOnDevice> frames;
  if (lit) frames.emplace(camera.columns, camera.rows);
  LaunchesOnDevice const launches(host, medium, frames ? &*frames : nullptr,
                                  lit ? photon_unit(scene, particles, light) : 1);
  LaserSheet<double> const sheet = laser_sheet<double>(scene.setup.piv->laser);
  AnyScattering scattering;
  scattering.lambert.diameter = particles.diameter.data();
  if (light == ParticleLight::scattered) {
    scattering.kind = scene.mie ? AnyScattering::Kind::mie : AnyScattering::Kind::lambert;
    if (scene.mie) scattering.mie = scene.mie->view<double>();
    kept.upload(scene.mie);
  }
  HostPulses pulses;
  for (int pulse = 0; pulse < frame_count; ++pulse) {
    pulses[pulse] = {particles.place[pulse].data(), particles.photons[pulse].data(), scattering, sheet, pulse};
  }
  Rendering rendering;
  double const photons_per_weight = 1 / static_cast<double>(host.smooth.rays);
  std::size_t const most = batch_size(scene, launches);
  Progress progress(lit ? "tracing particles" : "tracing truth", particles.size());
  auto const trace_all = [&](auto const& host_medium) {
    ParticlePasses passes(host, launches, pulses, host_medium, medium, staging);
    for (std::size_t first = 0; first < particles.size(); first += most) {
      throw_if_interrupted();
      std::size_t const count = std::min(most, particles.size() - first);
      ParticleBatch batch(particles, first, count, launches.sums_a_pulse());
      if (scattering.kind == AnyScattering::Kind::mie) scattering.mie = kept.view(first);
      ParticlesLaunch const launch = batch.launch(launches.filled(), first, scattering, sheet);
      passes.start(batch, launch);
      if (first == 0) rendering = empty_rendering(particles, host.smooth.rays);  // meanwhile
      passes.finish(batch, launch, photons_per_weight, rendering.truth);
      progress.advance(count);
    }
    passes.count(rendering.statuses);
    scene.pupil_margin = passes.largest_margin();
  };
  if (particles.size() > 0) {
    std::visit(trace_all, scene.medium.view);
  } else {
    rendering = empty_rendering(particles, host.smooth.rays);
  }
  if (!lit) return rendering;
  auto made = std::make_shared<DeviceLight>(camera.columns, camera.rows);
  frames->to_light(*made);
  if (images == RenderImages::yes) rendering.light = made->to_host(staging);
  if (images == RenderImages::kept) rendering.kept = std::move(made);
  return rendering;
}

}  // namespace gladstone::cuda
