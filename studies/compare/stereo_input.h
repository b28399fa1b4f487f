#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "analysis/stereo/stereo_camera.h"
#include "render/files/source_files.h"
#include "render/scene/ground_truth.h"
#include "studies/case/case.h"
#include "studies/compare/compared_vectors.h"
#include "studies/compare/stereo.h"

namespace gladstone::inline compare {

/// Vectors, camera and truth of one input.
struct StereoInput {
  std::optional<CaseSetup> loaded;
  MeasuredVectors vectors;
  stereo::CalibratedCamera camera;
  std::optional<GroundTruth> truth;
  std::string path;         ///< path of the vectors
  std::string calibration;  ///< path of the calibration; empty: the setup's exact camera
  double window_px = 0.0;
};

/// Locates the files of an input, adds them to the sources, and reads them.
/// @param index  index in StereoOptions::inputs, 0 or 1
/// @throws DataError for files that are missing or do not fit together
StereoInput read_stereo_input(StereoOptions const& options, std::size_t index, SourceFiles& sources);

}  // namespace gladstone::inline compare
