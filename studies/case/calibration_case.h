#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "render/base/warning.h"
#include "studies/case/case.h"

namespace gladstone::inline cases {

/// Monte Carlo error of the dot images' positions. Some dots are traced twice with independent random numbers; the
/// difference of two independent positions is sqrt(2) times the error of either.
struct DotPositionError {
  std::size_t dots = 0;   ///< number of dots traced twice and seen in the image
  double rms_px = 0;      ///< rms over dots and components [px]; NaN if none was seen
  double largest_px = 0;  ///< largest error of a component [px]
};

/// Rendered image and truth of one calibration plane.
struct RenderedPlane {
  double z = 0;  ///< [m]
  Scene scene;
  Image<double> light;  ///< light per pixel, in fully lit pixels on the axis
  GroundTruth truth;
  StatusCounts statuses{};
  std::uint64_t rays = 0;  ///< largest number of rays of a dot
  DotPositionError place_error;
};

/// A calibration rendered in memory.
struct RenderedCalibration {
  std::vector<RenderedPlane> planes;
  Warnings warnings;
  double exposure_e = 0;   ///< electrons in a fully lit pixel, equal for all planes [e]
  std::uint64_t rays = 0;  ///< largest number of rays of a dot, of all planes
  std::string device;
  double seconds = 0;
};

/// Renders the dots of every plane by ray tracing through the same camera.
RenderedCalibration render_planes(CaseSetup& loaded, Renderer& renderer);

/// Records the image of a plane with the camera's noise, which is independent between planes.
Recording record_plane(CameraSetup const& camera, RenderedCalibration const& rendered, std::size_t plane);

/// Writes plane_000.tif, ..., truth.h5, setup.toml and summary.json into a folder.
/// @return the contents of summary.json
nlohmann::json write_calibration(CaseSetup& loaded, RenderedCalibration const& rendered, std::string const& folder);

}  // namespace gladstone::inline cases
