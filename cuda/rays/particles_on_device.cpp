#include "cuda/rays/particles_on_device.h"

#include "render/rays/hit_grid.h"

namespace gladstone::cuda {
namespace {

/// Widest patch of pixels that a warp gathers spots in.
constexpr int widest_patch_px = 24;

}  // namespace

void KeptScattering::upload(std::shared_ptr<MieScattering const> const& mie) {
  if (owner_ == mie) return;
  owner_.reset();
  table_of_ = {};
  tables_ = {};
  coefficients_ = {};
  if (!mie) return;
  char const* const name = "what the particles scatter";
  table_of_ = DeviceArray<std::uint32_t>(mie->table_of().data(), mie->table_of().size(), name);
  tables_ = DeviceArray<MieTable>(mie->tables().data(), mie->tables().size(), name);
  coefficients_ = DeviceArray<float>(mie->coefficients().data(), mie->coefficients().size(), name);
  owner_ = mie;
}

MieScatteringView<double> KeptScattering::view(std::uint64_t first) const {
  MieScatteringView<double> view = owner_->view<double>();
  view.table_of = table_of_.data() + first;
  view.table = tables_.data();
  view.coefficient = coefficients_.data();
  return view;
}

LaunchesOnDevice::LaunchesOnDevice(ParticleLaunch const& host, DeviceMedium<double> const& medium,
                                   ImagePairOnDevice* images, double photon_unit)
    : smooth_(host.smooth.camera.elements.data(), host.smooth.camera.elements.size(), "the camera"),
      sharp_(host.sharp.camera.elements.data(), host.sharp.camera.elements.size(), "the camera"),
      stop_(host.sharp.camera) {
  RaysLaunch const& shared = host.smooth;
  stop_.camera.elements = sharp_.data();
  launch_.camera = stop_.camera;
  launch_.tracing = shared.tracing;
  launch_.choice = shared.choice;
  launch_.rays = shared.rays;
  launch_.chief_rays = shared.camera.chief_rays_only();
  if (!images) return;
  launch_.images = images->view(1 / (static_cast<double>(shared.rays) * photon_unit));
  launch_.spot = shared.spot;
  if (shared.spot.model == SpotModel::airy) {
    airy_ = DeviceArray<double>(shared.spot.airy.shares, shared.spot.airy.count(), "the Airy table");
    launch_.spot.airy.shares = airy_.data();
  } else if (shared.spot.model != SpotModel::none && HitGrid::pays(shared.spot.gaussian.sigma, shared.rays)) {
    HitSpline const spline(shared.spot.gaussian);
    launch_.spline = spline.view();
    share_ = DeviceArray<double>(launch_.spline.share, static_cast<std::size_t>(launch_.spline.count()), "a spline");
    launch_.spline.share = share_.data();
    launch_.most_window_px = widest_particle_window_px(launch_, medium);
  } else if (shared.spot.model != SpotModel::none && 2 * shared.spot.half_width() + 1 <= widest_patch_px) {
    launch_.patch_px = widest_patch_px;
  }
}

ParticlesLaunch LaunchesOnDevice::wide(ParticlesLaunch const& of, double sign) const {
  ParticlesLaunch launch = of;
  launch.camera.elements = smooth_.data();
  launch.sign = sign;
  return launch;
}

double LaunchesOnDevice::steps_a_particle(double across_medium) const {
  int const wide = 2 * launch_.spot.half_width() + 1;
  double const light = launch_.images.light[0] ? wide * wide / 16.0 : 0;
  return static_cast<double>(frame_count * launch_.rays) * (across_medium + 2.0 * launch_.camera.count + light);
}

}  // namespace gladstone::cuda
