#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "render/light/dot_pattern.h"
#include "render/light/particles.h"
#include "render/medium/field_volume.h"
#include "render/scene/camera.h"
#include "render/scene/setup.h"
#include "render/sensor/diffraction_spot.h"

namespace gladstone {

/// By what the general renderer chooses the rays of every source: what the camera makes of light, which all share.
struct RaysByNeed {
  double level = 0;         ///< light of one grey level
  double brightest_at = 0;  ///< grey levels of the brightest pixel that the camera is exposed for
};

/// A setup made ready to trace: owns the dots and the medium, gives views.
struct Scene {
  Setup setup;
  ImagingGeometry imaging{};
  Camera camera;
  DotPattern dots;                           ///< none for PIV
  Particles particles;                       ///< of PIV alone
  std::string flow_warning;                  ///< what had to be assumed of the file that moves them
  std::shared_ptr<MieScattering const> mie;  ///< of the particles; null: they are matt white spheres
  double photon_unit = 1;  ///< photons that light of 1 stands for: those of the brightest particle that pass the lens
  BuiltMedium medium;
  std::optional<BuiltMedium> second_medium;  ///< that PIV's second pulse sees instead
  double step = 0;                           ///< [m]
  double pupil_margin = 0;                   ///< by which the pupil is enlarged so that bending loses no ray [m]
  std::uint64_t rays_per_dot = 1;            ///< of every source, or the most of one where they are chosen by need
  std::optional<RaysByNeed> by_need;         ///< nothing: all sources have rays_per_dot
  std::uint64_t rays_at_side_faces = 0;      ///< of dots there (side_faces.h), as rays_per_dot; 0: as many
  int fineness = 1;                          ///< of the fast renderer's table and rules: 2 where fronts ask for it

  /// Dots, or particles.
  std::size_t source_count() const { return setup.piv ? particles.size() : dots.centre.size(); }
  /// Where a source is in the first frame [m].
  Vec3d source_place(std::size_t source) const {
    if (setup.piv) return particles.place[0][source];
    return {dots.centre[source].x, dots.centre[source].y, -setup.z_d};
  }
  /// Whether the sensor sees a source in the first frame.
  bool source_in_view(std::size_t source) const;
  /// The middle of the laser sheet between the pulses: x along the light, z its normal. @pre setup.piv
  Pose<double> sheet_plane() const;
  bool chief_rays_only() const { return imaging.entrance_pupil == 0; }
  /// Steps that a ray along the axis takes across the medium; 0 without one.
  double steps_across() const;
  /// Width of the smoothed zone about the stop's edge, as a share of its area; falls with the number of rays [1].
  static double stop_edge(double rays);
  double stop_edge() const { return stop_edge(static_cast<double>(rays_per_dot)); }
  /// Widens the pupil by a margin [m].
  /// @throws DataError where rays are bent by more than 45 degrees on their way: no bench sees those, and the search
  ///                   for a margin that loses none of them would not end
  void widen_pupil(double margin);
  /// Radius of the disc in the lens plane that rays are sent to, so many of a dot [m]; falls with their number.
  double pupil_radius(double rays) const;
  double pupil_radius() const { return pupil_radius(static_cast<double>(rays_per_dot)); }
  /// Radius of a Gaussian spot [px]; 0: none.
  double spot_sigma_px() const;
  /// As Setup::spot_scale_px.
  double spot_scale_px() const;
  /// The dots' plane, with the world's X and Y.
  Pose<double> target_plane() const { return {{0, 0, -setup.z_d}}; }
  /// Whether the sensor sees a point of the target.
  bool in_view(Vec2d on_target) const;
  /// Where the chief ray of a point of the target ends without medium [px], and back [m]; NaN where none gets through.
  Vec2d to_pixel(Vec2d on_target) const;
  Vec2d to_target(Vec2d pixel) const;
};

/// Whether a setup's medium is still to be built, or in memory already.
enum class FieldMemory { needed, taken };

/// Memory that something takes, and the key that it can be reduced by.
struct MemoryNeed {
  char const* key;
  char const* what;
  double bytes;
};

/// Refuses what this machine's memory cannot hold, before any of it is allocated.
/// @param more than images, field and dots take: a renderer's own needs
/// @throws SetupError-like DataError naming the sizes
void check_memory(Setup const& setup, FieldMemory field = FieldMemory::needed,
                  std::vector<MemoryNeed> const& more = {});

/// Builds dots or particles, and the medium. Step, margin and rays are 0 until planned (ray_plan.h).
/// @param medium of this very setup, if it is built already
Scene build_scene(Setup const& setup, BuiltMedium const* medium = nullptr);

/// The setup's medium, checked for densities that no gas has. @throws DataError
BuiltMedium build_checked_medium(MediumSetup const& setup);

}  // namespace gladstone
