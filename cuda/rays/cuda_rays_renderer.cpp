#include "cuda/rays/cuda_rays_renderer.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "cuda/device/device_images.h"
#include "cuda/device/launch.h"
#include "cuda/rays/cuda_particle_tracer.h"
#include "cuda/rays/trace_sources.h"
#include "render/base/freed_memory.h"
#include "render/base/interrupt.h"
#include "render/base/parallel.h"
#include "render/base/progress.h"
#include "render/rays/ray_theory.h"
#include "render/rays/rays_ladder.h"
#include "render/rays/rays_renderer.h"
#include "render/rays/source_tracer.h"
#include "render/scene/spot.h"

namespace gladstone::cuda::inline rays {
namespace {

/// Maximum memory for the ray sums of one batch of sources [bytes].
constexpr std::size_t most_sum_bytes = std::size_t{256} << 20;

/// Sources of a scene, on the host and on the device.
struct PatternOnDevice {
  LambertSources<double> host;
  DeviceArray<Vec2d> centres;
  DeviceArray<double> radiances;

  PatternOnDevice(DotPattern const& pattern, double plane_z)
      : host{pattern.view(plane_z)},
        centres(pattern.centre.data(), pattern.centre.size(), "the sources"),
        radiances(pattern.radiance.data(), pattern.radiance.size(), "the sources") {}
};

/// Data common to all sources with the same number of rays, on the host and on the device.
class LaunchOnDevice {
 public:
  /// @param images  receive the light; null: only the truth is computed
  LaunchOnDevice(RaysLaunch const& host, PatternOnDevice const& pattern, DeviceMedium const& medium,
                 ImagePairOnDevice* images)
      : host_(host),
        pattern_(pattern.host),
        source_px_(pattern_.reach() / std::sqrt(host.point_area)),
        elements_(host.camera.elements.data(), host.camera.elements.size(), "the camera") {
    launch_.camera = host.camera.view();
    launch_.camera.elements = elements_.data();
    launch_.tracing = host.tracing;
    launch_.sources = pattern_;
    launch_.sources.dots.centre = pattern.centres.data();
    launch_.sources.dots.radiance = pattern.radiances.data();
    launch_.choice = host.choice;
    launch_.rays = host.rays;
    if (!images) return;
    launch_.images = images->view(host.light_per_weight(pattern_.area()));
    launch_.spot = host.spot;
    if (host.spot.model == SpotModel::airy) {
      airy_ = DeviceArray<double>(host.spot.airy.shares, host.spot.airy.count(), "the Airy table");
      launch_.spot.airy.shares = airy_.data();
    } else if (host.spot.model != SpotModel::none &&
               HitGrid::is_faster_than_psfs(host.spot.gaussian.sigma, host.rays)) {
      HitSpline const spline(host.spot.gaussian);
      launch_.spline = spline.view();
      share_ = DeviceArray<double>(launch_.spline.share, static_cast<std::size_t>(launch_.spline.count()), "a spline");
      launch_.spline.share = share_.data();
    }
    widest_window_px_ = widest_window_px(launch_, medium);
  }

  double light_per_weight() const { return host_.light_per_weight(pattern_.area()); }
  std::size_t sums_a_source() const { return launch_.shares() * static_cast<std::size_t>(launch_.scramblings()); }
  int scramblings() const { return launch_.scramblings(); }

  SourceOnDevice place(std::uint64_t source, SourceAim const& aim) const {
    AimedBundle<double> const bundle = host_.bundle(*aim.disc, aim.shift, aim.margin);
    SourceOnDevice placed{source,        bundle.centre, bundle.a,    bundle.b,
                          bundle.across, bundle.by_x,   bundle.by_y, aim.origin};
    // Four times the weight of the central ray: the weights of rays through a wide disc differ, but by less than this
    // factor.
    placed.most_weight = 4 * std::abs(ray_to(pattern_, bundle, source, {}, {}).weight);
    if (widest_window_px_ == 0) return placed;
    double wide = 0, far = 0;
    for (int frame = 0; frame < frame_count; ++frame) {
      Vec2d const extent = aim.high[frame] - aim.low[frame];
      wide = std::max({wide, extent.x, extent.y});
      far = std::max({far, length(aim.high[frame]), length(aim.low[frame])});
    }
    if (!(far < 1e7)) return placed;
    // A margin of a tenth allows for rays at the rim beyond the estimated extent, and one pixel on either side for the
    // spline nodes around a ray.
    double const wanted = std::ceil(1.1 * wide + 2 * source_px_) + 4;
    placed.window_px = static_cast<int>(std::min<double>(wanted, widest_window_px_));
    for (int frame = 0; frame < frame_count; ++frame) {
      Vec2d const middle = 0.5 * (aim.low[frame] + aim.high[frame]);
      placed.left[frame] = static_cast<int>(std::lround(middle.x)) - placed.window_px / 2;
      placed.top[frame] = static_cast<int>(std::lround(middle.y)) - placed.window_px / 2;
    }
    return placed;
  }

  /// Estimates the operations of all rays of a source, in units of integration steps, to limit the duration of a
  /// launch.
  double steps_a_source(double across_medium) const {
    int const wide = 2 * launch_.spot.half_width() + 1;
    double const light = !launch_.images.light[0] ? 0 : (widest_window_px_ > 0 ? 2 : wide * wide / 16.0);
    return static_cast<double>(launch_.rays) * (across_medium + 2.0 * launch_.camera.count + light);
  }

  /// @param sign  -1 removes the light of an earlier launch
  SourcesLaunch launch(std::vector<SourceOnDevice> const& sources, double sign) const {
    SourcesLaunch launch = launch_;
    launch.sign = sign;
    for (SourceOnDevice const& source : sources) {
      launch.most_window_px = std::max(launch.most_window_px, source.window_px);
    }
    return launch;
  }

 private:
  RaysLaunch const& host_;
  LambertSources<double> pattern_;
  double source_px_;  ///< half size of a source's image on the axis [px]
  int widest_window_px_ = 0;
  DeviceArray<CameraElement<double>> elements_;
  DeviceArray<double> airy_, share_;
  SourcesLaunch launch_;
};

/// Sources, with the target areas of their rays.
struct AimedSources {
  std::vector<SourceOnDevice> placed;
  std::vector<SourceAim> aims;

  void add(SourceOnDevice const& source, SourceAim const& aim) {
    placed.push_back(source);
    aims.push_back(aim);
  }
};

/// Batch of sources being traced on the device.
class Batch {
 public:
  Batch(LaunchOnDevice const& scene, DeviceMedium const& medium, AimedSources sources, double sign)
      : scene_(scene),
        sources_(std::move(sources)),
        on_device_(sources_.placed.data(), sources_.placed.size(), "the sources"),
        sums_(sources_.placed.size() * scene.sums_a_source(), "the sums over a batch's rays"),
        moved2_(sources_.placed.size(), "the sums over a batch's rays"),
        ends_(frame_count * ray_status_count, "the sums over a batch's rays") {
    moved2_.zero();
    ends_.zero();
    if (sources_.placed.empty()) return;
    trace_sources(scene.launch(sources_.placed, sign), medium, on_device_.data(), sources_.placed.size(),
                  {sums_.data(), moved2_.data(), ends_.data()});
  }

  /// Waits for the results. @param sign  sign with which the batch's ray counts are added
  void finish(std::int64_t sign, StatusCounts& statuses) {
    unsigned long long ends[frame_count * ray_status_count] = {};
    ends_.download(ends, frame_count * ray_status_count);
    for (std::size_t i = 0; i < frame_count * ray_status_count; ++i) {
      statuses[i / ray_status_count][i % ray_status_count] += sign * static_cast<std::int64_t>(ends[i]);
    }
    moved_.resize(sources_.placed.size());
    moved2_.download(moved_.data(), moved_.size());
    found_.resize(sums_.size());
    sums_.download(found_.data(), found_.size());
  }

  AimedSources const& sources() const { return sources_; }
  /// Returns the largest displacement of a source's rays by the medium in the aim plane [m].
  double moved(std::size_t at) const { return std::sqrt(moved_[at]); }
  /// Adds the sums over the rays of a source, separately for each scrambling.
  void sum(std::size_t at, RaySums (&of_scramblings)[most_scramblings]) const {
    auto const scramblings = static_cast<std::size_t>(scene_.scramblings());
    for (std::size_t i = 0; i < scene_.sums_a_source(); ++i) {
      of_scramblings[i % scramblings] += found_[at * scene_.sums_a_source() + i];
    }
  }

 private:
  LaunchOnDevice const& scene_;
  AimedSources sources_;
  DeviceArray<SourceOnDevice> on_device_;
  DeviceArray<RaySums> sums_;
  DeviceArray<double> moved2_;
  DeviceArray<unsigned long long> ends_;
  std::vector<double> moved_;
  std::vector<RaySums> found_;
};

/// Traces all sources of a scene. The medium is also needed on the host, which aims and computes the theory.
template <class Medium>
class SceneTracer {
 public:
  /// @param steps_across  number of integration steps of an axial ray across the medium
  SceneTracer(double steps_across, RaysLadder const& ladder, PatternOnDevice const& pattern, Medium const& medium,
              DeviceMedium const& mirrored, ImagePairOnDevice* images, TracingPass& pass)
      : steps_across_(steps_across),
        ladder_(ladder),
        pattern_(pattern),
        medium_(medium),
        mirrored_(mirrored),
        images_(images),
        truth_(pass.rendering.truth),
        statuses_(pass.rendering.statuses),
        steps_(ladder.size()) {}

  /// Traces all sources. @return largest margin by which any source was aimed beyond the stop [m]
  double trace(char const* what) {
    std::size_t const count = truth_.size(), most = at_once(0);
    Progress progress(what, count);
    AimedSources next = aim(0, std::min(most, count));
    for (std::size_t first = 0; first < count; first += most) {
      throw_if_interrupted();
      auto batch = std::make_unique<Batch>(on_device(0), mirrored_, std::move(next), 1);
      // Determine the target areas of the next batch's rays while the device is working.
      std::size_t const after = std::min(first + most, count);
      next = aim(after, std::min(after + most, count));
      finish(std::move(batch));
      progress.advance(after - first);
    }
    return largest_margin_;
  }

 private:
  LaunchOnDevice const& on_device(std::size_t step) {
    if (!steps_[step]) steps_[step] = std::make_unique<LaunchOnDevice>(ladder_[step], pattern_, mirrored_, images_);
    return *steps_[step];
  }
  /// Returns the number of sources per batch, limited by the memory for sums, the duration of a launch, and the waiting
  /// time for the first aims.
  std::size_t at_once(std::size_t step) {
    LaunchOnDevice const& launch = on_device(step);
    double const launches_at_once = max_steps_per_launch / launch.steps_a_source(steps_across_);
    return std::clamp<std::size_t>(std::min(most_sum_bytes / (launch.sums_a_source() * sizeof(RaySums)),
                                            static_cast<std::size_t>(std::min(launches_at_once, 1e9))),
                                   1, 1 << 14);
  }

  AimedSources aim(std::size_t begin, std::size_t end) {
    RaysLaunch const& launch = ladder_[0];
    std::vector<SourceAim> aims(end - begin);
    parallel_chunks(aims.size(), 8, [&](std::size_t low, std::size_t high) {
      for (std::size_t i = low; i < high; ++i) {
        throw_if_interrupted();
        aims[i] =
            aim_at_stop(launch, launch.camera.view(), medium_, pattern_.host.middle(begin + i), pattern_.host.reach());
      }
    });
    AimedSources aimed;
    for (std::size_t i = 0; i < aims.size(); ++i) {
      if (aims[i].disc) {
        aimed.add(on_device(0).place(begin + i, aims[i]), aims[i]);
      } else {
        truth_.set_hits(begin + i, source_truth(nullptr, 0, {}), 0);
        truth_.rays_planned[begin + i] = static_cast<std::int64_t>(launch.rays);
      }
    }
    return aimed;
  }

  /// Processes the results of a batch with the first number of rays. Sources with a ray deflected beyond their margin,
  /// and those that need more rays, are removed and traced again.
  void finish(std::unique_ptr<Batch> batch) {
    std::vector<AimedSources> waiting(ladder_.size());
    take_in(*batch, 0, waiting);
    batch.reset();
    for (std::size_t step = 0; step < waiting.size(); ++step) {
      std::size_t const most = at_once(step);
      while (!waiting[step].placed.empty()) {
        throw_if_interrupted();
        AimedSources all = std::exchange(waiting[step], {});
        for (std::size_t first = 0; first < all.placed.size(); first += most) {
          AimedSources some;
          for (std::size_t i = first; i < std::min(first + most, all.placed.size()); ++i) {
            some.add(all.placed[i], all.aims[i]);
          }
          Batch here(on_device(step), mirrored_, std::move(some), 1);
          take_in(here, step, waiting);
        }
      }
    }
  }

  /// Stores the results of a batch. @param waiting  output: sources to be traced again, by number of rays
  void take_in(Batch& batch, std::size_t step, std::vector<AimedSources>& waiting) {
    batch.finish(1, statuses_);
    RaysLaunch const& launch = ladder_[step];
    LaunchOnDevice const& here = on_device(step);
    AimedSources missed;
    AimedSources const& sources = batch.sources();
    for (std::size_t at = 0; at < sources.placed.size(); ++at) {
      SourceOnDevice const& placed = sources.placed[at];
      SourceAim aim = sources.aims[at];
      RaySums sums[most_scramblings];
      batch.sum(at, sums);
      auto const retry =
          find_retry(ladder_, static_cast<int>(step), aim.margin, batch.moved(at), sums, here.light_per_weight());
      if (!retry) {
        largest_margin_ = std::max(largest_margin_, aim.margin);
        truth_.set_hits(placed.source, source_truth(sums, here.scramblings(), placed.origin), here.light_per_weight());
        truth_.rays_planned[placed.source] = static_cast<std::int64_t>(launch.rays);
        continue;
      }
      missed.add(placed, aim);
      aim.margin = retry->margin;
      waiting[retry->step].add(on_device(retry->step).place(placed.source, aim), aim);
    }
    if (!missed.placed.empty()) Batch(here, mirrored_, std::move(missed), -1).finish(-1, statuses_);
  }

  double steps_across_;
  RaysLadder const& ladder_;
  PatternOnDevice const& pattern_;
  Medium const& medium_;
  DeviceMedium const& mirrored_;
  ImagePairOnDevice* images_;
  GroundTruth& truth_;
  StatusCounts& statuses_;
  std::vector<std::unique_ptr<LaunchOnDevice>> steps_;  ///< created on first use
  double largest_margin_ = 0;
};

}  // namespace

struct CudaRaysRenderer::Uploads {
  MediumCache medium;
  ScatteringCache scattering;
  PinnedBuffer staging;

  /// Returns the scene's medium on the device; uploads it if necessary.
  DeviceMedium medium_of(Scene const& scene) {
    if (!medium.serves(scene)) medium.upload(scene);
    return medium.medium().view();
  }
};

CudaRaysRenderer::CudaRaysRenderer() : uploads_(std::make_unique<Uploads>()) {
  keep_freed_memory();
  keep_freed_device_memory();
}
CudaRaysRenderer::~CudaRaysRenderer() = default;

Rendering CudaRaysRenderer::render(Scene const& scene, RenderPlan const& plan, DotPattern const& sources,
                                   RenderImages images, RenderTheory theory) {
  bool const lit = images != RenderImages::no;
  std::optional<AiryTable> airy;
  RaysLaunch const launch(scene, plan, lit ? make_spot(scene, airy) : SpotView{}, StopRim::smooth,
                          RayOrder::neighbours);
  DeviceMedium const mirrored = uploads_->medium_of(scene);
  CameraSetup const& camera = scene.setup.camera;
  std::optional<ImagePairOnDevice> frames;
  if (lit) frames.emplace(camera.columns, camera.rows);
  RaysLadder const ladder = RaysLadder::of_points(scene, plan, launch, images);
  PatternOnDevice const pattern(sources, -scene.setup.z_d);
  TracingPass pass(scene, plan, sources);
  Rendering& rendering = pass.rendering;
  RayTheory const model(scene, launch, sources.shape, sources.half_size > 0);
  std::visit(
      [&](auto const& medium) {
        SceneTracer tracer(scene.steps_across(plan.step), ladder, pattern, medium, mirrored,
                           frames ? &*frames : nullptr, pass);
        rendering.pupil_margin = tracer.trace(lit ? "tracing rays" : "tracing truth");
        if (theory == RenderTheory::no) return;
        parallel_chunks(rendering.truth.size(), 8, [&](std::size_t begin, std::size_t end) {
          for (std::size_t dot = begin; dot < end; ++dot) {
            model.record(launch, pattern.host, medium, dot, rendering.truth);
          }
        });
      },
      scene.medium.view);
  rendering.table = TableState::by_rays;
  if (!lit) return pass.finish();
  auto light = std::make_shared<DeviceLight>(camera.columns, camera.rows);
  frames->to_light(*light);
  if (plan.polarity == Polarity::dark) light->take_from(render_white_target(scene, plan.seed));
  if (images == RenderImages::yes) rendering.light = light->to_host(uploads_->staging);
  if (images == RenderImages::in_place) rendering.in_place = std::move(light);
  return pass.finish();
}

Rendering CudaRaysRenderer::render_particles(Scene const& scene, RenderPlan const& plan, Particles const& particles,
                                             ParticleLight light, RenderImages images) {
  return trace_particles_on_device(scene, plan, particles, light, images, uploads_->medium_of(scene),
                                   uploads_->scattering, uploads_->staging);
}

}  // namespace gladstone::cuda::inline rays
