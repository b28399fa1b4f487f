#include "analysis/vectors/track_vectors.h"

#include <utility>

#include "analysis/vectors/vector_readers/vector_readers.h"
#include "analysis/vectors/vector_writers/vector_writers.h"

namespace gladstone::inline vectors {

void write_track_vectors(std::string const& path, DisplacementField const& field, std::span<std::int64_t const> tracks,
                         FileOrigin const& origin) {
  std::vector<VectorColumn> more;
  if (!tracks.empty())
    more.push_back({"track", "1", "number of the track of the dot through the pairs of the sequence, from 0", true,
                    std::vector<double>(tracks.begin(), tracks.end())});
  write_vector_columns(path, field, std::move(more), origin);
}

TrackVectors read_track_vectors(std::string const& path) {
  TrackVectors vectors{read_gladstone_hdf5(path).field, {}};
  if (Hdf5Reader const file(path); file.has("/track")) vectors.tracks = file.read_integers("/track");
  return vectors;
}

}  // namespace gladstone::inline vectors
