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
#include "cuda/focused_dots/dot_cones.h"
#include "render/base/contracts.h"
#include "render/base/freed_memory.h"
#include "render/base/interrupt.h"
#include "render/base/progress.h"
#include "render/focused_dots/focused_dots_renderer.h"
#include "render/focused_dots/owned_dot_model.h"

namespace gladstone::cuda::inline focused_dots {
namespace {

/// Maximum memory for the ray cones of one batch of dots [bytes].
constexpr std::size_t most_cone_bytes = std::size_t{2} << 30;

/// Copy of a dot model whose quadrature rules are in device memory.
class MirroredModel {
 public:
  explicit MirroredModel(DotModel const& host)
      : model_(host),
        points_(host.source.points, static_cast<std::size_t>(host.source.count), "a cubature"),
        weights_(host.source.weights, static_cast<std::size_t>(host.source.count), "a cubature"),
        cone_points_(host.cone.points, static_cast<std::size_t>(host.cone.count), "a cubature"),
        directions_(host.cone.directions, static_cast<std::size_t>(host.cone.direction_count), "a cubature"),
        scattered_(host.cone.scattered, static_cast<std::size_t>(host.cone.scattered_count), "a cubature") {
    model_.source = {points_.data(), weights_.data(), host.source.count};
    model_.cone.points = cone_points_.data();
    model_.cone.directions = directions_.data();
    model_.cone.scattered = scattered_.data();
  }
  void make_images_of_moments() {
    if (!model_.moment_images.exist() || !model_.table.exists()) return;
    moment_images_ = DeviceArray<double>(model_.moment_images.size(), "the images of moments");
    moment_images_.zero();
    model_.moment_images.values = moment_images_.data();
    make_moment_images(model_, moment_images_.data());
  }
  DotModel const& model() const { return model_; }

 private:
  DotModel model_;
  DeviceArray<Vec2d> points_;
  DeviceArray<double> weights_;
  DeviceArray<ConePoint> cone_points_;
  DeviceArray<Vec2d> directions_, scattered_;
  DeviceArray<double> moment_images_;
};

/// Renders a scene, or its truth only.
/// @param dots_a_batch  number of dots processed at a time
/// @param light_out  output: light of the images of bright dots; null: truth only
TracingPass trace_all(std::uint64_t dots_a_batch, FocusedDots const& bench, DotPattern const& sources,
                      MirroredMedium const& mirrored, DeflectionTable const& table, RenderTheory theory,
                      std::shared_ptr<DeviceLight>* light_out) {
  Scene const& scene = bench.scene();
  std::uint64_t const dots = sources.centre.size();
  TracingPass pass(scene, bench.plan(), sources);
  OwnedDotModel const host(bench, sources, table, light_out, MomentImagesBy::device);
  MirroredModel on_device(host.model);
  DotModel const& model = on_device.model();
  DeviceMedium const& medium = mirrored.view();
  TheoryModel const theory_model = bench.theory_model();
  std::optional<ImagePairOnDevice> images;
  if (light_out) {
    images.emplace(scene.setup.camera.columns, scene.setup.camera.rows);
    *light_out = std::make_shared<DeviceLight>(scene.setup.camera.columns, scene.setup.camera.rows);
    on_device.make_images_of_moments();
  }
  DeviceImages const frames = images ? images->view(1) : DeviceImages{};
  if (dots > 0) {
    DeviceArray<Vec2d> const centres(sources.centre.data(), dots, "the dots");
    DeviceArray<double> const radiances(sources.radiance.data(), sources.radiance.size(), "the dots");
    DeviceArray<RayTally> tally(1, "counters");
    tally.zero();
    DeviceArray<DotFound> found(dots, "the dots' truth");
    DeviceArray<DotTheory> integrals(theory == RenderTheory::yes ? dots : 0, "the dots' theory");
    DeviceArray<DotCone> cones(dots_a_batch, "the cones of a batch of dots");
    Progress progress(images ? "tracing rays" : "tracing truth", dots);
    for (std::uint64_t first = 0; first < dots; first += dots_a_batch) {
      throw_if_interrupted();
      std::uint64_t const count = std::min(dots_a_batch, dots - first);
      SourcesView<double> seen{};
      seen.centre = centres.data() + first;
      if (!sources.radiance.empty()) seen.radiance = radiances.data() + first;
      check_dots(model, medium, seen, count, cones.data(), found.data() + first, tally.data());
      integrate_cones(model, count, cones.data(), found.data() + first);
      if (images) expose_dots(model, count, cones.data(), frames);
      throw_if_interrupted();
      if (theory == RenderTheory::yes) {
        integrate_theory(model, theory_model, medium, seen, count, integrals.data() + first);
      }
      if (dots_a_batch < dots) check(cudaDeviceSynchronize(), "a batch of dots");
      progress.advance(count);
    }

    std::vector<DotFound> here(dots);
    found.download(here.data(), dots);
    for (std::size_t dot = 0; dot < dots; ++dot) {
      pass.enter(dot, here[dot].truth, here[dot].rays, here[dot].left);
    }
    if (theory == RenderTheory::yes) {
      std::vector<DotTheory> along(dots);
      integrals.download(along.data(), dots);
      for (std::size_t dot = 0; dot < dots; ++dot) set_theory(pass.rendering.truth, dot, theory_model, along[dot]);
    }
    RayTally counted{};
    tally.download(&counted, 1);
    pass.largest_aim_distance = std::bit_cast<double>(counted.largest_aim_distance);
    for (std::size_t frame = 0; frame < frame_count; ++frame) {
      for (std::size_t status = 0; status < ray_status_count; ++status) {
        pass.rendering.statuses[frame][status] = static_cast<std::int64_t>(counted.statuses[frame][status]);
      }
    }
  }
  if (images) images->to_light(**light_out);
  return pass;
}

}  // namespace

struct CudaRenderer::Uploads {
  MediumCache medium;
  DeflectionTableCache<DeviceDeflections> deflections;
  PinnedBuffer staging;
};

CudaRenderer::CudaRenderer() : uploads_(std::make_unique<Uploads>()) {
  keep_freed_memory();
  keep_freed_device_memory();
}
CudaRenderer::~CudaRenderer() = default;

Rendering CudaRenderer::render(Scene const& scene, RenderPlan const& plan, DotPattern const& sources,
                               RenderImages images, RenderTheory theory) {
  std::optional<FocusedDots> const bench = build_focused_dots(scene, plan);
  GLADSTONE_EXPECTS(bench);
  if (!uploads_->medium.serves(scene)) {
    uploads_->deflections.forget();
    uploads_->medium.upload(scene);
  }
  MirroredMedium const& medium = uploads_->medium.medium();
  std::shared_ptr<DeviceLight> light;
  std::uint64_t const dots = std::max<std::uint64_t>(1, sources.centre.size());
  double const steps = static_cast<double>(plan.rays) * std::max(1.0, scene.steps_across(plan.step));
  std::uint64_t const most =
      std::min(most_cone_bytes / sizeof(DotCone), static_cast<std::size_t>(max_steps_per_launch / steps));
  Rendering rendering = render_within_table(scene, plan, [&](double largest_aim_distance) {
    DeflectionTable const table = uploads_->deflections.table(*bench, sources, largest_aim_distance, medium.view());
    // Retry with smaller batches if device memory is short; results are bitwise the same.
    for (std::uint64_t batch = std::clamp<std::uint64_t>(most, 1, dots);; batch /= 2) try {
        return trace_all(batch, *bench, sources, medium, table, theory, images == RenderImages::no ? nullptr : &light);
      } catch (OutOfDeviceMemory const&) {
        if (batch == 1) throw;
      }
  });
  rendering.table = uploads_->deflections.state();
  rendering.pupil_margin = plan.pupil_margin;
  if (light && plan.polarity == Polarity::dark) light->take_from(render_white_light(scene));
  if (images == RenderImages::yes) rendering.light = light->to_host(uploads_->staging);
  if (images == RenderImages::in_place) rendering.in_place = std::move(light);
  return rendering;
}

}  // namespace gladstone::cuda::inline focused_dots
