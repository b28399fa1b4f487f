#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "render/base/warning.h"
#include "render/light/dot_pattern.h"
#include "render/light/particles.h"
#include "render/medium/field_volume.h"
#include "render/scene/camera.h"
#include "render/scene/setup.h"
#include "render/sensor/diffraction_spot.h"

namespace gladstone::inline scene {

/// A setup prepared for ray tracing: a value that nothing changes after build_scene(). Owns the dots or particles and
/// the medium.
struct Scene {
  Setup setup;
  ImagingGeometry imaging{};
  Camera camera;
  DotPattern dots;                           ///< dots of the target; empty for PIV
  Particles particles;                       ///< particles; PIV only
  Warnings flow_warnings;                    ///< assumptions made about the velocity file
  std::shared_ptr<MieScattering const> mie;  ///< scattering of the particles; null: matt white spheres
  double photon_unit = 1;  ///< number of photons per unit of image light: that of the brightest particle through the
                           ///< lens; 1 without particles
  BuiltMedium medium;
  std::optional<BuiltMedium> second_medium;  ///< medium at the second laser pulse, if different

  /// Number of dots or particles.
  std::size_t source_count() const { return setup.experiment().sources.count(*this); }
  /// Position of a source in a frame, by default in the reference image (PIV: frame A) [m].
  Vec3d source_place(std::size_t source, std::size_t frame = 0) const {
    return setup.experiment().sources.place(*this, source, frame);
  }
  /// Returns true if the sensor sees a source in the reference image (PIV: frame A).
  bool source_in_view(std::size_t source) const { return setup.experiment().sources.in_view(*this, source); }
  /// Returns the mean plane of the laser sheets of both pulses: x along the light, z normal to the sheet.
  /// @pre setup.piv
  Pose<double> sheet_plane() const;
  bool chief_rays_only() const { return imaging.entrance_pupil == 0; }
  /// Returns the number of integration steps of an axial ray across the medium; 0 without medium.
  /// @param step  [m]
  double steps_across(double step) const;
  /// Returns the width of the smoothed zone at the edge of the stop as a fraction of its area, which decreases with the
  /// number of rays [1].
  static double stop_edge(double rays);
  /// Standard deviation of the Gaussian PSF [px]; 0: none.
  double spot_sigma_px() const;
  /// Scale N (1 + M) lambda of the diffraction-limited PSF, see Setup::spot_scale_px() [px].
  double spot_scale_px() const;
  /// Pose of the dots' plane, with the axes of the world's X and Y.
  Pose<double> target_plane() const { return {{0, 0, -setup.z_d}}; }
  /// Returns true if the sensor sees a point of the target.
  bool in_view(Vec2d on_target) const;
  /// Maps a point of the target [m] to the pixel of its chief ray without medium [px], or back; NaN if no chief ray
  /// passes.
  Vec2d to_pixel(Vec2d on_target) const;
  Vec2d to_target(Vec2d pixel) const;
};

/// Whether the medium of a setup is yet to be built or already in memory.
enum class FieldMemory { needed, taken };

/// Memory requirement of one part of a rendering, and the key that reduces it.
struct MemoryRequirement {
  char const* key;
  char const* what;
  double bytes;
};

/// Returns the memory that a rendering requires, before any of it is allocated. Opens the files of fields and reads
/// their headers.
/// @param field  whether the field must still be allocated
std::vector<MemoryRequirement> memory_requirements(Setup const& setup, FieldMemory field = FieldMemory::needed);

/// Checks that a rendering fits into the available memory, before any of it is allocated.
/// @param field  whether the field must still be allocated
/// @param more  requirements of a renderer beyond images, field and dots
/// @throws DataError with the sizes
void check_memory(Setup const& setup, FieldMemory field = FieldMemory::needed,
                  std::vector<MemoryRequirement> const& more = {});

/// Checks that the medium deflects no ray by more than 45 degrees before it reaches the lens: no real set-up does so,
/// and the search for a sufficient pupil margin would not terminate.
/// @param shift  deflection on the lens plane [m]
/// @param z_b  distance from the dots to the lens [m]
/// @throws DataError if shift > z_b
void check_deflection_limit(double shift, double z_b);

/// Returns the dots of a target of BOS or of one plane of a calibration, or the pixels of an image target.
/// @throws DataError if the dots cannot be placed, or if the target's file is invalid
DotPattern build_target(Setup const& setup);

/// Builds the scene: camera, dots or particles, and medium. plan_rendering() chooses the integration step and the
/// number of rays for it.
/// @param medium  the medium of this setup, if it is already built
Scene build_scene(Setup const& setup, BuiltMedium const* medium = nullptr);

/// Builds the medium of a setup and checks it for negative densities.
/// @throws DataError
BuiltMedium build_checked_medium(MediumSetup const& setup);

}  // namespace gladstone::inline scene
