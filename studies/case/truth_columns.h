#pragma once

#include <span>
#include <string>
#include <vector>

#include "render/files/hdf5_axes.h"
#include "render/scene/renderer.h"

/// Common structure of the groups /dots and /particles of truth.h5.
namespace gladstone::inline cases {

/// Dataset with two numbers per source, in GroundTruth or, of particles only, in ParticleTruth.
struct TruthColumn {
  char const* name;  ///< name in its group
  std::vector<Vec2d> GroundTruth::*values;
  char const* units;
  char const* description;
  char const* axes = "dot, component";
  std::vector<Vec2d> ParticleTruth::*of_particles = nullptr;  ///< column of particles only; `values` is then null

  template <class Truth>
  auto& of(Truth& truth) const {
    return values ? truth.*values : truth.particles.*of_particles;
  }
};

/// Group of truth.h5 that describes the light sources.
struct TruthGroup {
  std::string path;         ///< "/dots"
  std::string source;       ///< axis of the sources in the group: "dot"
  std::string frame;        ///< axis of both frames: "/frame"
  std::string frame_order;  ///< order of the frames in words, for readers of the file: "frame (reference, flow)"
  char const* rays;         ///< description of the counted rays
  char const* rays_planned;
  char const* conventions;
  std::span<TruthColumn const> columns;

  std::string sources() const { return path + '/' + source; }
};

/// Writes the columns and numbers of rays of a group, and /rays/status.
void write_sources(Hdf5Writer& file, Hdf5Axes& axes, TruthGroup const& group, Rendering const& rendering);
/// Writes the attributes of a group, and the method.
void write_source_attributes(Hdf5Writer& file, TruthGroup const& group, Scene const& scene, RenderPlan const& plan);

/// Reads the datasets of write_sources() into a truth that has the right size already.
/// @throws DataError if a dataset is missing or has another size
void read_sources(Hdf5Reader const& file, std::string const& path, TruthGroup const& group, GroundTruth& truth);

/// @throws DataError if the length of a dataset differs from the one required
void require_length(std::string const& path, std::string const& dataset, std::size_t there, std::size_t needed);

}  // namespace gladstone::inline cases
