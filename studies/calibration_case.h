#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "render/base/hdf5_file.h"
#include "studies/case.h"

namespace gladstone {

/// What a finite number of rays leaves in the places of a plane's dots, from some of them traced once more with rays of
/// other random numbers: two independent places differ by sqrt(2) of what either is off.
struct PlaceError {
  std::size_t dots = 0;   ///< that were traced again and seen
  double rms_px = 0;      ///< over them and components; NaN: none was seen
  double largest_px = 0;  ///< of a component
};

/// What a camera sees of one plane of a calibration.
struct RenderedPlane {
  double z = 0;  ///< [m]
  Scene scene;
  Image<double> light;  ///< in fully lit pixels on the axis
  GroundTruth truth;
  StatusCounts statuses{};
  PlaceError place_error;
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

/// Writes plane_000.tif, ..., truth.h5, setup.toml and summary.json into a folder. @return what summary.json holds
nlohmann::json write_calibration(CaseSetup& loaded, RenderedCalibration const& rendered, std::string const& folder);

/// Writes truth.h5 of a calibration: /dots, /planes and, for an ideal thin lens, /pinhole (docs/file-formats.md).
void write_calibration_truth(std::string const& path, RenderedCalibration const& rendered, FileOrigin const& origin);

}  // namespace gladstone
