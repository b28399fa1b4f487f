#pragma once

#include <string>

#include "render/files/hdf5_file.h"
#include "studies/case/calibration_case.h"

namespace gladstone::inline cases {

/// Writes truth.h5 of a calibration: /dots, /planes and, if the camera is a pinhole, /pinhole (docs/file-formats.md).
void write_calibration_truth(std::string const& path, RenderedCalibration const& rendered, FileOrigin const& origin);

}  // namespace gladstone::inline cases
