#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "render/base/vec.h"

namespace gladstone::inline scene {

struct Setup;
struct Scene;
struct MemoryRequirement;

/// Kind of light sources of a scene: dots of a target, or particles.
struct SourceKind {
  char const* one;         ///< name of a source in messages
  char const* many;        ///< name of several sources
  char const* seed_table;  ///< table of a setup that contains the seed of the sources' positions
  /// true: sources printed on a target behind the medium, all of which are lit evenly; false: sources within the
  /// medium, some of which a laser sheet lights
  bool on_target;
  bool in_photons;  ///< the light of the sources is counted in photons, which limits the exposure

  /// Returns the memory that the sources and the files read with them require.
  std::vector<MemoryRequirement> (*memory)(Setup const& setup);
  /// Adds the sources to a scene whose camera has been built. @throws DataError
  void (*add)(Scene& scene);
  std::size_t (*count)(Scene const& scene);
  /// Returns the position of a source in a frame [m].
  Vec3d (*place)(Scene const& scene, std::size_t source, std::size_t frame);
  /// Returns true if the sensor sees a source in the first frame.
  bool (*in_view)(Scene const& scene, std::size_t source);
  /// Removes sources by a condition on their pixel in the first frame without medium: a dot is removed, a particle
  /// loses its light. If optical elements divide the light of a point among many images, all particles remain.
  /// @param near  returns true for the pixels of sources that remain
  /// @return number of sources with light
  std::size_t (*retain)(Scene& scene, std::function<bool(Vec2d pixel)> const& near);
};

extern SourceKind const dot_sources, particle_sources;

}  // namespace gladstone::inline scene
