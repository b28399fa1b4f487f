#pragma once

#include <string>
#include <vector>

#include "render/base/displacement_field.h"
#include "render/base/source_files.h"
#include "render/scene/setup.h"
#include "studies/report/report.h"

namespace gladstone {

/// What a measurement consists of, as its files are now.
struct MeasuredFiles {
  std::string setup, vectors;
  std::vector<std::string> repeats;  ///< vectors of the same measured again
  bool frames = false;               ///< whether the folder holds them
  SourceFiles sources;               ///< setup, frames, vectors and repeats by what they hold
};

/// @throws DataError where a file cannot be read
MeasuredFiles measured_files(ReportOptions const& options);

/// Makes sure that the frames are the camera's and those that the vectors were measured on.
/// @throws DataError where they have another number of pixels than the setup's camera, or vectors.h5 names other frames
void require_frames_of(MeasuredFiles const& files, ReportOptions const& options, CameraSetup const& camera);

/// The vectors and those of the repeats in our conventions, all at the same places.
/// @throws DataError where vectors lie beyond the setup's camera, or a repeat has its own elsewhere
std::vector<DisplacementField> read_repeats(MeasuredFiles const& files, ReportOptions const& options,
                                            CameraSetup const& camera);

/// How much of the camera's frame the places of vectors span, from 0 to 1.
double spanned_share(DisplacementField const& field, CameraSetup const& camera);

}  // namespace gladstone
