#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "render/ideal_images/particle_image.h"
#include "render/light/flow_path.h"
#include "render/light/lambert_sphere.h"
#include "render/light/mie_scattering.h"
#include "render/light/particle_draw.h"
#include "render/scene/lens_light.h"
#include "render/scene/setup.h"
#include "render/sensor/diffraction_spot.h"
#include "render/sensor/pixel_detector.h"

namespace gladstone::inline ideal_images {

/// Choice of the exposure of a pair, equal to that of choose_exposure() for a scene.
struct ExposureRule {
  double fixed_e = 0;       ///< electrons per unit of light; 0: from the brightest pixel
  double brightest_e = 0;   ///< charge of the brightest pixel [e]
  double full_well_e = 0;   ///< electrons per unit of light if both frames are dark [e]
  double per_photon = 0;    ///< quantum efficiency [e], an upper limit; infinity: no limit
  bool by_photons = false;  ///< true: electrons = photons times quantum efficiency

  /// Returns the electrons per unit of light. @param brightest  light of the brightest pixel of both frames
  /// @param unit  photons per unit of light
  GLADSTONE_HD double electrons(double brightest, double unit) const {
    if (by_photons) return unit * per_photon;
    if (fixed_e > 0) return fixed_e;
    double const wanted = brightest > 0 ? brightest_e / brightest : full_well_e, most = unit * per_photon;
    return wanted < most ? wanted : most;
  }
};

/// Random seeds of one pair.
struct PairSeeds {
  std::uint64_t particles = 1;
  std::uint64_t noise = 1;
};

/// Pairs of ideal particle images of one setup: every particle as a function of the seed and its index. Trivially
/// copyable, for host and device. Its particles are those of seed_particles(), and their images those of
/// render_ideal_images(), up to rounding.
struct PairModel {
  // seeding
  std::uint64_t seeded = 0;  ///< number of particles of a pair, whether illuminated or not
  Vec3d center{}, volume{};  ///< seeded volume [m]
  Vec3d box{};               ///< size of the box about `center` that contains the particles at mid-time [m]
  DiameterSpread spread = DiameterSpread::one;
  double diameter = 1e-6, diameter_width = 0;  ///< parameters of the diameters, see DiameterSetup
  double density = 0, viscosity = 1;           ///< density of lagging particles [kg/m^3], viscosity of the gas [Pa s];
                                               ///< 0: no lag
  // motion
  Flow flow;
  double dt = 0;        ///< time between the pulses [s]
  double interval = 0;  ///< time step of the differences along the flow, see ParticleVelocity [s]
  int steps = 1;        ///< number of integration steps per half path, from mid-time to a pulse
  // light and camera
  LaserSheet<double> sheet;
  Pose<double> sheet_plane;  ///< Scene::sheet_plane()
  ParticleScattering scattering = ParticleScattering::gaussian;
  MieScatteringView<double> mie;  ///< scattering of the only diameter, index 0; for ParticleScattering::mie
  LensLight lens;
  IdealProjection projection;
  DefocusBlur blur;
  GaussianSpot<double> spot;  ///< PSF whose footprint is used for all images: that of the widest image that is not
                              ///< faint
  ExposureRule exposure;
  PixelDetector detector;  ///< detector of all pairs, without electrons per light and seed, which are set for each pair

  GLADSTONE_HD ParticleVelocity velocity(double d) const {
    return {flow, density > 0 ? stokes_response_time(density, d, viscosity) : 0.0, interval};
  }

  /// Returns the differential cross-section of a particle of diameter d in a direction (unit vector) [m^2/sr].
  GLADSTONE_HD double cross_section(double d, Vec3d place, Vec3d direction, int pulse) const {
    if (scattering == ParticleScattering::lambert)
      return LambertSpheres<double>{&d}.cross_section(0, direction, sheet.wave(place, pulse));
    if (scattering == ParticleScattering::mie) return mie.cross_section(0, direction, sheet.wave(place, pulse));
    return isotropic_cross_section(d);
  }

  /// Computes the images of a particle at both pulses, with light in photons.
  GLADSTONE_HD void images(std::uint64_t seed, std::uint64_t particle, ParticleImage (&image)[2]) const {
    double const d = draw_diameter(spread, diameter, diameter_width, size_engine(seed, particle));
    KeyedEngine engine(seed, RandomStream::particles, particle);
    Vec3d const middle = draw_place(engine, center, box);
    ParticleVelocity const moving = velocity(d);
    for (int pulse = 0; pulse < 2; ++pulse) {
      image[pulse] = {};
      Vec3d const place = moved<ParticleVelocity>(moving, middle, (pulse == 0 ? -0.5 : 0.5) * dt, steps);
      if (!is_inside_box(place, center, volume)) continue;
      double const photons = sheet.photons(place, pulse);
      if (!(photons > 0)) continue;
      Vec3d const way = lens.centre - place;
      double const far = length(way);
      image[pulse] = {projection(place), photons * lens(cross_section(d, place, way / far, pulse), way, far),
                      blur.width(place.z)};
    }
  }

  /// Returns the displacement [px] of the particle in the middle of the sheet at mid-time whose image in frame A is at
  /// a pixel. This is the truth of particle_displacements() with TruthAt::reference. The particle is found to 1e-9 px
  /// by fixed-point iteration. The iteration starts at the point of the sheet seen at the pixel, moved with the flow
  /// for half the time between the pulses; this is the solution if the flow is parallel to the sheet. NaN if the pixel
  /// sees no point of the sheet.
  GLADSTONE_HD Vec2d displacement(Vec2d pixel) const {
    using std::abs;
    ParticleVelocity const moving = velocity(diameter);
    constexpr int most_rounds = 16;
    Vec2d seen = projection(moved<ParticleVelocity>(moving, on_sheet(pixel), 0.5 * dt, steps)), first{};
    Vec3d middle{};
    for (int round = 0; round < most_rounds; ++round) {
      middle = on_sheet(seen);
      first = projection(moved<ParticleVelocity>(moving, middle, -0.5 * dt, steps));
      Vec2d const miss = pixel - first;
      if (!(abs(miss.x) + abs(miss.y) > 1e-9)) break;
      seen = seen + miss;
    }
    return projection(moved<ParticleVelocity>(moving, middle, 0.5 * dt, steps)) - first;
  }

  /// Returns the point of the sheet's middle plane whose image is at a position [m]; NaN if there is none.
  GLADSTONE_HD Vec3d on_sheet(Vec2d pixel) const {
    Vec3d const start{0, 0, projection.lens_z}, way = projection.direction(pixel);
    double const along = dot(sheet_plane.origin - start, sheet_plane.z) / dot(way, sheet_plane.z);
    return start + (along > 0 ? along : NAN) * way;
  }
};

/// A model with the memory to which it refers.
struct OwnedPairModel {
  PairModel model;
  std::shared_ptr<std::vector<float> const> velocity;  ///< coefficients of a velocity file; null: none
  std::shared_ptr<MieScattering const> mie;            ///< scattering table for ParticleScattering::mie; null: none
};

/// Returns the reason why the pairs of a setup have no PairModel; empty if they have one.
std::string reason_against_pair_model(Setup const& setup);

/// Builds the model of a setup. The number of integration steps and the angles of Mie scattering are chosen from the
/// particles of the setup's own seed.
/// @throws DataError if the setup has no PairModel, or its velocity file cannot be read
OwnedPairModel build_pair_model(Setup const& setup);

}  // namespace gladstone::inline ideal_images
