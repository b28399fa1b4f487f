#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analysis/vectors/displacement_field.h"
#include "render/base/frame_pair.h"
#include "render/files/source_files.h"
#include "studies/report/report.h"

namespace gladstone::inline report {

/// Files of a measurement in their present state.
struct MeasuredFiles {
  std::string setup, vectors;
  std::vector<std::string> repeats;         ///< vectors of repeated measurements
  std::optional<FramePair<double>> frames;  ///< decoded frames; nullopt: the folder contains none
  SourceFiles sources;                      ///< setup, frames, vectors and repeats with their hashes
};

/// Locates and hashes the files of a measurement.
/// @throws DataError if a file cannot be read
MeasuredFiles measured_files(ReportOptions const& options);

/// Checks that the frames are from the setup's camera, and that the vectors were measured on them.
/// @throws DataError if their number of pixels differs from the setup's camera, or vectors.h5 names other frames
void check_frames_match_camera(MeasuredFiles const& files, ReportOptions const& options, CameraSetup const& camera);

/// Vectors of a measurement and its repeats.
struct RepeatedVectors {
  std::vector<DisplacementField> fields;
  std::vector<std::string> incomplete;  ///< files whose header declares another number of vectors
};

/// Reads the vectors and their repeats in our conventions.
/// @throws DataError if vectors are outside the camera's image, or positions of a repeat differ
RepeatedVectors read_repeats(MeasuredFiles const& files, ReportOptions const& options, CameraSetup const& camera);

/// Returns the fraction of the image area spanned by the vectors, from 0 to 1.
double spanned_share(DisplacementField const& field, CameraSetup const& camera);

}  // namespace gladstone::inline report
