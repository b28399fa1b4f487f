#include "cuda/focused_dots/cuda_renderer.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>
#include <vector>

#include "cuda/device/cuda_error.h"
#include "cuda/device/device_images.h"
#include "cuda/device/device_light.h"
#include "cuda/device/launch.h"
#include "cuda/focused_dots/device_deflections.h"
#include "cuda/focused_dots/expose_dots.h"
#include "cuda/focused_dots/scene_view_cast.h"
#include "render/base/contracts.h"
#include "render/base/freed_memory.h"
#include "render/base/interrupt.h"
#include "render/base/progress.h"
#include "render/focused_dots/focused_dots_renderer.h"
#include "render/focused_dots/light_model.h"
#include "render/sensor/exposure.h"

namespace gladstone::cuda {
namespace {

/// Memory for the records of one batch of dots [bytes].
constexpr std::size_t most_record_bytes = std::size_t{2} << 30;

/// The sources' arrays on the device, in both scalars where both are needed.
class MirroredSources {
 public:
  explicit MirroredSources(DotPattern const& sources)
      : centre_(sources.centre.data(), sources.centre.size(), "the dots"),
        radiance_(sources.radiance.data(), sources.radiance.size(), "the dots") {}

  void mirror_single(DotPattern const& sources) {
    std::vector<Vec2<float>> centre;
    for (Vec2d const c : sources.centre) centre.push_back(cast<float>(c));
    std::vector<float> const radiance(sources.radiance.begin(), sources.radiance.end());
    single_centre_ = DeviceArray<Vec2<float>>(centre.data(), centre.size(), "the dots");
    single_radiance_ = DeviceArray<float>(radiance.data(), radiance.size(), "the dots");
  }

  SceneView<double> place(SceneView<double> view) const {
    view.sources.centre = centre_.data();
    view.sources.radiance = radiance_.data();
    return view;
  }
  SceneView<float> place(SceneView<float> view) const {
    view.sources.centre = single_centre_.data();
    view.sources.radiance = single_radiance_.data();
    return view;
  }

 private:
  DeviceArray<Vec2d> centre_;
  DeviceArray<double> radiance_;
  DeviceArray<Vec2<float>> single_centre_;
  DeviceArray<float> single_radiance_;
};

/// A light model with its tables on the device.
class MirroredLightModel {
 public:
  explicit MirroredLightModel(LightModel const& host) : model_(host) {
    model_.source = mirrored(host.source, 0);
    for (int rule = 0; rule < pupil_rules; ++rule) model_.pupil[rule] = mirrored(host.pupil[rule], 1 + rule);
    moment_images_ = DeviceArray<double>(host.moment_images.size(), "the images of moments");
    model_.moment_images.values = moment_images_.data();
    if (host.moment_images.exist()) make_moment_images(model_, moment_images_.data());
    cone_points_ = DeviceArray<ConePoint>(host.cone.points, static_cast<std::size_t>(host.cone.count), "a cubature");
    cone_directions_ =
        DeviceArray<Vec2d>(host.cone.directions, static_cast<std::size_t>(host.cone.direction_count), "a cubature");
    cone_scattered_ =
        DeviceArray<Vec2d>(host.cone.scattered, static_cast<std::size_t>(host.cone.scattered_count), "a cubature");
    model_.cone.points = cone_points_.data();
    model_.cone.scattered = cone_scattered_.data();
    model_.cone.directions = cone_directions_.data();
    if (host.spot.model == SpotModel::airy) {
      airy_ = DeviceArray<double>(host.spot.airy.shares, host.spot.airy.count(), "the Airy table");
      model_.spot.airy.shares = airy_.data();
    }
  }
  LightModel const& model() const { return model_; }

 private:
  CubatureView mirrored(CubatureView const& rule, int slot) {
    auto const count = static_cast<std::size_t>(rule.count);
    points_[slot] = DeviceArray<Vec2d>(rule.points, count, "a cubature");
    weights_[slot] = DeviceArray<double>(rule.weights, count, "a cubature");
    return {points_[slot].data(), weights_[slot].data(), rule.count};
  }

  LightModel model_;
  DeviceArray<Vec2d> points_[1 + pupil_rules];
  DeviceArray<double> weights_[1 + pupil_rules];
  DeviceArray<double> moment_images_;
  DeviceArray<ConePoint> cone_points_;
  DeviceArray<Vec2d> cone_directions_, cone_scattered_;
  DeviceArray<double> airy_;
};

/// One try at a scene. @param dots_a_batch traced at a time @param spot null: truth only @param light_out of the
/// images, for bright dots
template <class T>
TracingPass trace_all(std::uint64_t dots_a_batch, FocusedDots const& bench, DotPattern const& sources,
                      MirroredSources const& on_device, MirroredMedium const& medium,
                      DeflectionTable const& deflections, SpotView const* spot, RenderTheory theory,
                      std::shared_ptr<DeviceLight>& light_out) {
  Scene const& scene = bench.scene();
  std::uint64_t const dots = sources.centre.size(), rays = scene.rays_per_dot;
  TracingPass pass(scene, sources);
  GroundTruth& truth = pass.rendering.truth;

  OwnedLightModel const host_light(bench, sources, spot, deflections, MomentImagesBy::device);
  MirroredLightModel const light(host_light.model);
  SceneView<double> const view = on_device.place(bench.view(sources));
  SceneView<T> const traced = on_device.place([&] {
    if constexpr (std::is_same_v<T, double>) {
      return view;
    } else {
      return cast<T>(view);
    }
  }());
  double const light_per_ray = bench.light_per_ray(sources);
  TheoryModel const theory_model = bench.theory_model();
  std::optional<ImagePairOnDevice> images;
  if (spot) {
    images.emplace(scene.setup.camera.columns, scene.setup.camera.rows);
    light_out = std::make_shared<DeviceLight>(scene.setup.camera.columns, scene.setup.camera.rows);
  }
  DeviceImages const frames = images ? images->view(light_per_ray) : DeviceImages{};
  if (dots > 0) {
    DeviceArray<TraceTally> tally(1, "counters");
    tally.zero();
    DeviceArray<DotTruth> found(dots, "the dots' truth");
    DeviceArray<DotTheory> integrals(theory == RenderTheory::yes ? dots : 0, "the dots' theory");
    DeviceArray<RayRecord<T>> records(dots_a_batch * rays, "the rays of a batch of dots");
    DeviceArray<DotCone> cones(images ? dots_a_batch : 0, "the cones of a batch of dots");
    Progress progress(spot ? "tracing rays" : "tracing truth", dots);
    for (Batch batch{0, 0, rays}; batch.first < dots; batch.first += batch.dots) {
      throw_if_interrupted();
      batch.dots = std::min(dots_a_batch, dots - batch.first);
      trace_rays<T>(traced, medium.view<T>(), light.model().image, batch, records.data(), tally.data());
      throw_if_interrupted();
      sum_dots<T>(light.model(), view.sources, batch, records.data(), found.data() + batch.first, cones.data());
      if (images) {
        if (host_light.model.controlled) expose_cones(light.model(), view.sources, batch, cones.data(), frames);
        expose_dots<T>(light.model(), view.sources, batch, records.data(), found.data() + batch.first, cones.data(),
                       frames);
      }
      throw_if_interrupted();
      if (theory == RenderTheory::yes) {
        integrate_dots(light.model(), theory_model, view, medium.view<double>(), batch, integrals.data() + batch.first);
      }
      if (dots_a_batch < dots) check(cudaDeviceSynchronize(), "a batch of dots");
      progress.advance(batch.dots);
    }

    std::vector<DotTruth> hits(dots);
    found.download(hits.data(), dots);
    for (std::size_t dot = 0; dot < dots; ++dot) truth.set_hits(dot, hits[dot], light_per_ray);
    if (theory == RenderTheory::yes) {
      std::vector<DotTheory> along(dots);
      integrals.download(along.data(), dots);
      for (std::size_t dot = 0; dot < dots; ++dot)
        set_theory(truth, dot, theory_model, along[dot].along, along[dot].cone);
    }
    TraceTally counted{};
    tally.download(&counted, 1);
    pass.largest_bend = std::sqrt(std::bit_cast<double>(counted.largest_bend2));
    for (std::size_t frame = 0; frame < 2; ++frame) {
      for (std::size_t status = 0; status < ray_status_count; ++status) {
        pass.rendering.statuses[frame][status] = static_cast<std::int64_t>(counted.statuses[frame][status]);
      }
    }
  }
  if (images) images->to_light(*light_out);
  return pass;
}

}  // namespace

struct CudaRenderer::Uploads {
  KeptMedium medium;
  KeptDeflections<DeviceDeflections> deflections;
  PinnedBuffer staging;
};

CudaRenderer::CudaRenderer() : uploads_(std::make_unique<Uploads>()) {
  keep_freed_memory();
  keep_freed_device_memory();
}
CudaRenderer::~CudaRenderer() = default;

Rendering CudaRenderer::render(Scene& scene, DotPattern const& sources, RenderImages images, RenderTheory theory) {
  // dots in focus; others too, ray by ray, until the device has the general renderer
  std::optional<FocusedDots> const bench = bench_rays(scene);
  GLADSTONE_EXPECTS(bench);
  bool const single = scene.setup.render.precision == Precision::single;
  std::optional<AiryTable> airy;
  SpotView const spot = make_spot(scene, airy);
  if (!uploads_->medium.serves(scene, !single)) {
    uploads_->deflections.forget();
    uploads_->medium.upload(scene, !single);
  }
  MirroredSources on_device(sources);
  if (single) on_device.mirror_single(sources);
  std::shared_ptr<DeviceLight> light;
  auto const trace = [&]<class T>(T) {
    MirroredMedium const& medium = uploads_->medium.medium();
    DeflectionTable const deflections = uploads_->deflections.table(*bench, sources, medium.view<double>());
    std::uint64_t const dots = std::max<std::uint64_t>(1, sources.centre.size());
    double const steps = static_cast<double>(scene.rays_per_dot) * std::max(1.0, scene.steps_across());
    std::uint64_t const most = std::min(most_record_bytes / (scene.rays_per_dot * sizeof(RayRecord<T>)),
                                        static_cast<std::size_t>(most_steps_a_launch / steps));
    // where the device is short of memory, once more with smaller batches, which give the same bits
    for (std::uint64_t batch = std::clamp<std::uint64_t>(most, 1, dots);; batch /= 2) try {
        return trace_all<T>(batch, *bench, sources, on_device, medium, deflections,
                            images == RenderImages::no ? nullptr : &spot, theory, light);
      } catch (OutOfDeviceMemory const&) {
        if (batch == 1) throw;
      }
  };
  Rendering rendering = render_with_margin(scene, [&] { return single ? trace(float{}) : trace(double{}); });
  rendering.table = uploads_->deflections.state();
  if (light && scene.setup.target.polarity == Polarity::dark) light->take_from(white_light(scene));
  if (images == RenderImages::yes) rendering.light = light->to_host(uploads_->staging);
  if (images == RenderImages::kept) rendering.kept = std::move(light);
  return rendering;
}

}  // namespace gladstone::cuda
