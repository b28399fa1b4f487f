#pragma once

#include <memory>

#include "cuda/device/device_array.h"
#include "cuda/rays/trace_particles.h"
#include "render/rays/particle_tracer.h"

namespace gladstone::cuda {

/// What spheres scatter, on the device: the table of the last scene, which often is the next one's too.
class KeptScattering {
 public:
  /// @param mie may be null @throws OutOfDeviceMemory
  void upload(std::shared_ptr<MieScattering const> const& mie);
  /// Of the particles from number `first` on. @pre there is a table
  MieScatteringView<double> view(std::uint64_t first) const;

 private:
  std::shared_ptr<MieScattering const> owner_;
  DeviceArray<std::uint32_t> table_of_;
  DeviceArray<MieTable> tables_;
  DeviceArray<float> coefficients_;
};

/// What all particles of a scene share, on the device.
class LaunchesOnDevice {
 public:
  /// @param images null: truth only @param photon_unit that light of 1 stands for in them
  LaunchesOnDevice(ParticleLaunch const& host, DeviceMedium<double> const& medium, ImagePairOnDevice* images,
                   double photon_unit);

  StopView const& stop() const { return stop_; }
  std::size_t sums_a_pulse() const { return launch_.shares() * static_cast<std::size_t>(launch_.scramblings()); }
  /// For rays that fill the stop; of no particles yet.
  ParticlesLaunch const& filled() const { return launch_; }
  /// For rays that are clipped at a smooth rim. @param sign of the light that is laid down
  ParticlesLaunch wide(ParticlesLaunch const& of, double sign) const;

  /// Operations of all rays of a particle, in steps across a medium, for the length of a launch.
  double steps_a_particle(double across_medium) const;

 private:
  DeviceArray<CameraElement<double>> smooth_, sharp_;
  DeviceArray<double> airy_, share_;
  StopView stop_;
  ParticlesLaunch launch_;
};

/// Some particles on the device.
class ParticleBatch {
 public:
  ParticleBatch(Particles const& particles, std::size_t first, std::size_t count, std::size_t sums_a_pulse)
      : count_(count),
        diameters_(particles.diameter.data() + first, count, "the particles"),
        aims_(frame_count * count, "the particles"),
        origins_(count, "the particles"),
        sums_(frame_count * count * sums_a_pulse, "the sums over a batch's rays"),
        bend2_(frame_count * count, "the sums over a batch's rays"),
        truth_(count, "the particles"),
        ambient_(count, "the particles") {
    for (int pulse = 0; pulse < frame_count; ++pulse) {
      places_[pulse] = DeviceArray<Vec3d>(particles.place[pulse].data() + first, count, "the particles");
      photons_[pulse] = DeviceArray<double>(particles.photons[pulse].data() + first, count, "the particles");
    }
  }

  /// What a particle takes.
  static std::size_t bytes_a_particle(std::size_t sums_a_pulse) {
    std::size_t const a_pulse = sizeof(PulseAim) + sizeof(Vec3d) + 2 * sizeof(double) + sums_a_pulse * sizeof(RaySums);
    return frame_count * a_pulse + sizeof(double) + sizeof(Vec2d) + 2 * sizeof(DotTruth);
  }

  /// A launch of its particles. @param scattering of them
  ParticlesLaunch launch(ParticlesLaunch const& shared, std::size_t first, AnyScattering scattering,
                         LaserSheet<double> const& sheet) const {
    ParticlesLaunch launch = shared;
    launch.first = first;
    scattering.lambert.diameter = diameters_.data();
    for (int pulse = 0; pulse < frame_count; ++pulse) {
      launch.pulses[pulse] = {places_[pulse].data(), photons_[pulse].data(), scattering, sheet, pulse};
    }
    return launch;
  }

  std::size_t count() const { return count_; }
  DeviceArray<PulseAim>& aims() { return aims_; }
  DeviceArray<Vec2d>& origins() { return origins_; }
  DeviceArray<double>& bend2() { return bend2_; }
  DeviceArray<RaySums>& sums() { return sums_; }
  DeviceArray<DotTruth>& truth() { return truth_; }
  DeviceArray<DotTruth>& ambient() { return ambient_; }

 private:
  std::size_t count_;
  DeviceArray<Vec3d> places_[frame_count];
  DeviceArray<double> photons_[frame_count];
  DeviceArray<double> diameters_;
  DeviceArray<PulseAim> aims_;
  DeviceArray<Vec2d> origins_;
  DeviceArray<RaySums> sums_;
  DeviceArray<double> bend2_;
  DeviceArray<DotTruth> truth_, ambient_;
};

}  // namespace gladstone::cuda
