#include "cuda/rays/particles_on_device.h"

#include <algorithm>

#include "render/base/parallel.h"
#include "render/rays/hit_grid.h"

namespace gladstone::cuda::inline rays {
namespace {

/// Widest square of pixels in which a warp accumulates PSFs [px].
constexpr int widest_patch_px = 24;

}  // namespace

void ScatteringCache::upload(std::shared_ptr<MieScattering const> const& mie) {
  if (owner_ == mie) return;
  owner_.reset();
  table_of_ = {};
  tables_ = {};
  coefficients_ = {};
  if (!mie) return;
  char const* const name = "the scattering table";
  table_of_ = DeviceArray<std::uint32_t>(mie->table_of().data(), mie->table_of().size(), name);
  tables_ = DeviceArray<MieTable>(mie->tables().data(), mie->tables().size(), name);
  coefficients_ = DeviceArray<float>(mie->coefficients().data(), mie->coefficients().size(), name);
  owner_ = mie;
}

MieScatteringView<double> ScatteringCache::view(std::uint64_t first) const {
  MieScatteringView<double> view = owner_->view();
  view.table_of = table_of_.data() + first;
  view.table = tables_.data();
  view.coefficient = coefficients_.data();
  return view;
}

LaunchesOnDevice::LaunchesOnDevice(ParticleLaunches const& host, DeviceMedium const& medium, ImagePairOnDevice* images,
                                   double light_per_photon)
    : host_(host),
      sharp_(host.sharp.camera.elements.data(), host.sharp.camera.elements.size(), "the camera"),
      smooth_(host.ladder.size()),
      stop_(host.sharp.camera),
      ladder_{host.ladder.view(), light_per_photon} {
  RaysLaunch const& shared = host.ladder[0];
  stop_.camera.elements = sharp_.data();
  ParticlesLaunch launch;
  launch.camera = stop_.camera;
  launch.tracing = shared.tracing;
  launch.chief_rays = shared.camera.chief_rays_only();
  bool const gaussian = shared.spot.model != SpotModel::none && shared.spot.model != SpotModel::airy;
  HitSplineView spline;
  if (images) {
    launch.spot = shared.spot;
    if (shared.spot.model == SpotModel::airy) {
      airy_ = DeviceArray<double>(shared.spot.airy.shares, shared.spot.airy.count(), "the Airy table");
      launch.spot.airy.shares = airy_.data();
    } else if (gaussian &&
               HitGrid::is_faster_than_psfs(shared.spot.gaussian.sigma, host.ladder[host.ladder.size() - 1].rays)) {
      HitSpline const owner(shared.spot.gaussian);
      spline = owner.view();
      share_ = DeviceArray<double>(spline.share, static_cast<std::size_t>(spline.count()), "a spline");
      spline.share = share_.data();
    }
  }
  std::vector<double> rules;
  for (std::size_t step = 0; step < host.ladder.size(); ++step) {
    RaysLaunch const& here = host.ladder[step];
    launch.choice = here.choice;
    launch.rays = here.rays;
    launch.rule = here.rule.view();
    rules.insert(rules.end(), launch.rule.radius2, launch.rule.radius2 + launch.rule.rings);
    rules.insert(rules.end(), launch.rule.share, launch.rule.share + launch.rule.rings);
    ladder_.sums_per_pulse =
        std::max(ladder_.sums_per_pulse, launch.shares() * static_cast<std::uint64_t>(launch.scramblings()));
    launch.spline = {};
    launch.most_window_px = launch.patch_px = 0;
    if (images) {
      launch.images = images->view(light_per_photon / static_cast<double>(here.rays));
      if (gaussian && HitGrid::is_faster_than_psfs(shared.spot.gaussian.sigma, here.rays)) {
        launch.spline = spline;
        launch.most_window_px = widest_particle_window_px(launch, medium);
      } else if (gaussian && 2 * shared.spot.half_width() + 1 <= widest_patch_px) {
        launch.patch_px = widest_patch_px;
      }
    }
    launches_.push_back(launch);
  }
  rules_ = DeviceArray<double>(rules.data(), rules.size(), "the rules");
  double const* rule = rules_.data();
  for (ParticlesLaunch& one : launches_) {
    one.sums_per_pulse = ladder_.sums_per_pulse;
    one.rule.radius2 = rule;
    one.rule.share = rule + one.rule.rings;
    rule += 2 * one.rule.rings;
  }
}

CameraElement<double> const* LaunchesOnDevice::smooth(std::size_t step) const {
  if (smooth_[step].size() == 0) {
    std::vector<CameraElement<double>> const& elements = host_.ladder[step].camera.elements;
    smooth_[step] = DeviceArray<CameraElement<double>>(elements.data(), elements.size(), "the camera");
  }
  return smooth_[step].data();
}

double LaunchesOnDevice::steps_per_particle(double across_medium, std::size_t step) const {
  ParticlesLaunch const& launch = launches_[step];
  int const wide = 2 * launch.spot.half_width() + 1;
  double const light = launch.images.light[0] ? wide * wide / 16.0 : 0;
  return static_cast<double>(frame_count * launch.rays) * (across_medium + 2.0 * launch.camera.count + light);
}

void ParticleBatch::upload(Particles const& particles, std::size_t first, PinnedBuffer& staging) {
  struct Column {
    void* to;
    char const* from;
    std::size_t begin, end;  ///< offsets in the staging memory
  };
  std::vector<Column> columns;
  std::size_t bytes = 0;
  auto const take = [&](auto& to, auto const& from) {
    std::size_t const here = count_ * sizeof(from[0]);
    columns.push_back({to.data(), reinterpret_cast<char const*>(from.data() + first), bytes, bytes + here});
    bytes += here;
  };
  take(diameters_, particles.diameter);
  for (int pulse = 0; pulse < frame_count; ++pulse) {
    take(places_[pulse], particles.place[pulse]);
    take(photons_[pulse], particles.photons[pulse]);
  }
  auto* const staged = static_cast<char*>(staging.reserve(bytes));
  parallel_chunks(bytes, std::size_t{1} << 17, [&](std::size_t begin, std::size_t end) {
    for (Column const& column : columns) {
      std::size_t const from = std::max(begin, column.begin), to = std::min(end, column.end);
      if (from < to) std::copy(column.from + (from - column.begin), column.from + (to - column.begin), staged + from);
    }
  });
  for (Column const& column : columns) {
    copy_pinned_to_device(column.to, staged + column.begin, column.end - column.begin);
  }
}

}  // namespace gladstone::cuda::inline rays
