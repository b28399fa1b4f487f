#pragma once

#include <string>

#include "analysis/errors/window_truth.h"
#include "analysis/vectors/three_components.h"
#include "analysis/vectors/vector_file.h"
#include "render/scene/renderer.h"
#include "studies/compare/displacement_truth.h"

namespace gladstone::inline compare {

/// Vectors of a file in our conventions, with the provenance that a converted file stores.
struct ExportedVectors {
  DisplacementField field;
  FileOrigin origin;
  std::string format;       ///< name of the format: "gladstone", "gladstone truth", "OpenPIV", ...
  std::string conventions;  ///< conventions by which a foreign file was read, in the form of parse_conventions()
  bool foreign = false;     ///< written by another program
  bool complete = true;     ///< false: the file's header declares another number of vectors
};

/// Reads vectors of gladstone or another program, or the dots or particles of truth.h5, for a file in another format.
/// Dots have the position of their centroid in the reference image, the standard error of their displacement as
/// uncertainty, and status invalid if no ray of one of the images reached the sensor.
/// @param conventions  conventions of a foreign file, see parse_conventions(); empty: those of its format
/// @param image_rows   number of rows of the image, for files that count y upwards from its last row; 0: unknown
/// @throws DataError if the file cannot be read, or requires `image_rows` and it is 0
ExportedVectors load_for_export(std::string const& path, std::string const& conventions, int image_rows);

/// Computes the true displacement at the pixels of a case, see displacement_truth(), for a file in another format.
/// @param path  truth.h5 of the case
/// @throws DataError if the case lacks a file, or an input of its setup has changed
ExportedVectors compute_map_for_export(std::string const& path, Renderer& renderer, TruthAt at, int spacing_px,
                                       TracedPixels traced);

/// Returns true for truth.h5 of a case.
bool is_truth_file(std::string const& path);

/// Three components of a file of gladstone stereo, with the provenance that a converted file stores.
struct ExportedComponents {
  ThreeComponentField field;
  FileOrigin origin;
};

/// Reads three components for a file in another format. @throws DataError if the file cannot be read
ExportedComponents load_components_for_export(std::string const& path);

}  // namespace gladstone::inline compare
