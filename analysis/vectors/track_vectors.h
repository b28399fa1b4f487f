#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "analysis/vectors/displacement_field.h"
#include "render/files/hdf5_file.h"

namespace gladstone::inline vectors {

/// Writes the scattered vectors of dots or particles in the format of vectors.h5, with a dataset `track`.
/// @param tracks  number of the track of each vector; empty: no tracks, and no such dataset
/// @throws OutputError; DataError if a source has changed since it was read
void write_track_vectors(std::string const& path, DisplacementField const& field, std::span<std::int64_t const> tracks,
                         FileOrigin const& origin);

/// Contents of a file of write_track_vectors().
struct TrackVectors {
  DisplacementField field;
  std::vector<std::int64_t> tracks;  ///< number of the track of each vector; empty: the file contains no tracks
};
/// Reads a file of write_track_vectors(). @throws DataError if it is another file
TrackVectors read_track_vectors(std::string const& path);

}  // namespace gladstone::inline vectors
