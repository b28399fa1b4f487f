#pragma once

#include <memory>
#include <vector>

#include "cuda/device/device_array.h"
#include "cuda/rays/trace_particles.h"
#include "render/rays/particle_tracer.h"

namespace gladstone::cuda::inline rays {

/// Cache of the scattering table on the device: that of the last scene, which is often that of the next one, too.
class ScatteringCache {
 public:
  /// Uploads a table unless it is already there. @param mie  may be null @throws OutOfDeviceMemory
  void upload(std::shared_ptr<MieScattering const> const& mie);
  /// Returns a view for the particles from index `first` on. @pre a table has been uploaded
  MieScatteringView<double> view(std::uint64_t first) const;

 private:
  std::shared_ptr<MieScattering const> owner_;
  DeviceArray<std::uint32_t> table_of_;
  DeviceArray<MieTable> tables_;
  DeviceArray<float> coefficients_;
};

/// Data common to all particles of a scene, on the device, for each number of rays of RaysLadder.
class LaunchesOnDevice {
 public:
  /// @param images  receive the light; null: only the truth is computed
  /// @param light_per_photon  light in the images per photon
  LaunchesOnDevice(ParticleLaunches const& host, DeviceMedium const& medium, ImagePairOnDevice* images,
                   double light_per_photon);

  StopView const& stop() const { return stop_; }
  ParticleLadder const& ladder() const { return ladder_; }
  std::size_t steps() const { return launches_.size(); }
  /// Returns the launch of a step of RaysLadder for rays that fill the stop, without particles.
  ParticlesLaunch const& filled(std::size_t step) const { return launches_[step]; }
  /// Returns the camera's elements for rays clipped at a stop with a smooth edge.
  CameraElement<double> const* smooth(std::size_t step) const;

  /// Estimates the operations of all rays of a particle at a step of RaysLadder, in units of integration steps, to
  /// limit the duration of a launch.
  double steps_per_particle(double across_medium, std::size_t step) const;

 private:
  ParticleLaunches const& host_;
  DeviceArray<CameraElement<double>> sharp_;
  mutable std::vector<DeviceArray<CameraElement<double>>> smooth_;  ///< camera elements with a smoothed edge of the
                                                                    ///< stop, uploaded on first use
  DeviceArray<double> airy_, share_, rules_;
  StopView stop_;
  ParticleLadder ladder_;
  std::vector<ParticlesLaunch> launches_;
};

/// Batch of particles in device memory.
class ParticleBatch {
 public:
  /// Uploads the particles. @param staging  page-locked buffer; must not be written before the first kernel of the
  /// batch has run
  ParticleBatch(Particles const& particles, std::size_t first, std::size_t count, std::size_t sums_per_pulse,
                PinnedBuffer& staging)
      : count_(count),
        diameters_(count, "the particles"),
        aims_(frame_count * count, "the particles"),
        origins_(count, "the particles"),
        sums_(frame_count * count * sums_per_pulse, "the sums over a batch's rays"),
        moved2_(frame_count * count, "the sums over a batch's rays"),
        truth_(count, "the particles"),
        ambient_(count, "the particles"),
        steps_(3 * count, "the particles"),
        counts_(LadderView::max_step_count + 1, "the particles") {
    for (int pulse = 0; pulse < frame_count; ++pulse) {
      places_[pulse] = DeviceArray<Vec3d>(count, "the particles");
      photons_[pulse] = DeviceArray<double>(count, "the particles");
    }
    upload(particles, first, staging);
  }

  /// Returns the device memory per particle [bytes].
  static std::size_t device_bytes_per_particle(std::size_t sums_per_pulse) {
    std::size_t const a_pulse =
        sizeof(PulseAim) + sizeof(Vec3d) + 2 * sizeof(double) + sums_per_pulse * sizeof(RaySums);
    std::size_t const listed = LadderView::max_step_count * frame_count * sizeof(std::uint32_t);
    return frame_count * a_pulse + sizeof(double) + sizeof(Vec2d) + 2 * sizeof(DotTruth) + 3 * sizeof(int) + listed;
  }

  /// Sets the particles of a launch to those of this batch.
  void fill(ParticlesLaunch& launch, std::size_t first, AnyScattering scattering,
            LaserSheet<double> const& sheet) const {
    launch.first = first;
    scattering.lambert.diameter = diameters_.data();
    for (int pulse = 0; pulse < frame_count; ++pulse) {
      launch.pulses[pulse] = {places_[pulse].data(), photons_[pulse].data(), scattering, sheet, pulse};
    }
  }

  ParticleSteps steps() { return {steps_.data(), steps_.data() + count_, steps_.data() + 2 * count_, counts_.data()}; }
  /// Memory of the arrays `step`, `next` and `chosen` of steps(), one after the other.
  DeviceArray<int>& all_steps() { return steps_; }
  /// Number of listed pairs of particle and pulse for each number of rays. The last element counts the pairs whose ray
  /// directions the host determines, or the particles that need more rays.
  DeviceArray<unsigned int>& counts() { return counts_; }
  /// Returns the memory for the lists of pairs of particle and pulse. @param steps  number of steps of RaysLadder
  std::uint32_t* listed(std::size_t steps) {
    if (listed_.size() == 0) listed_ = DeviceArray<std::uint32_t>(steps * frame_count * count_, "the particles");
    return listed_.data();
  }
  std::size_t count() const { return count_; }
  DeviceArray<PulseAim>& aims() { return aims_; }
  DeviceArray<Vec2d>& origins() { return origins_; }
  DeviceArray<double>& moved2() { return moved2_; }
  DeviceArray<RaySums>& sums() { return sums_; }
  DeviceArray<DotTruth>& truth() { return truth_; }
  DeviceArray<DotTruth>& ambient() { return ambient_; }

 private:
  void upload(Particles const& particles, std::size_t first, PinnedBuffer& staging);

  std::size_t count_;
  DeviceArray<Vec3d> places_[frame_count];
  DeviceArray<double> photons_[frame_count];
  DeviceArray<double> diameters_;
  DeviceArray<PulseAim> aims_;
  DeviceArray<Vec2d> origins_;
  DeviceArray<RaySums> sums_;
  DeviceArray<double> moved2_;
  DeviceArray<DotTruth> truth_, ambient_;
  DeviceArray<int> steps_;
  DeviceArray<unsigned int> counts_;
  DeviceArray<std::uint32_t> listed_;
};

}  // namespace gladstone::cuda::inline rays
