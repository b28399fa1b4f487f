#pragma once

#include <string>
#include <vector>

#include "render/base/hdf5_file.h"
#include "studies/case.h"

namespace gladstone {

/// What a camera sees of one plane of a calibration.
struct RenderedPlane {
  double z = 0;  ///< [m]
  Scene scene;
  Image<double> light;  ///< in fully lit pixels on the axis
  GroundTruth truth;
  StatusCounts statuses{};
};

/// A calibration as far as memory.
struct RenderedCalibration {
  std::vector<RenderedPlane> planes;
  std::vector<std::string> warnings;
  double exposure_e = 0;   ///< one for all planes
  std::uint64_t rays = 0;  ///< a dot
  std::string device;
  double seconds = 0;
};

/// Renders the dots on every plane, ray by ray, through one and the same camera.
RenderedCalibration render_planes(CaseSetup& loaded, Renderer& renderer);

/// Writes plane_000.tif, ..., truth.h5, setup.toml and summary.json into a folder. @return the text of summary.json
std::string write_calibration(CaseSetup& loaded, RenderedCalibration const& rendered, std::string const& folder);

/// Writes truth.h5 of a calibration: /dots, /planes and, for an ideal thin lens, /pinhole (docs/file-formats.md).
void write_calibration_truth(std::string const& path, RenderedCalibration const& rendered, FileOrigin const& origin);

}  // namespace gladstone
