#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "analysis/calibration/grid_assignment.h"
#include "analysis/calibration/pinhole_fit.h"
#include "analysis/calibration/soloff_fit.h"
#include "render/base/warning.h"
#include "render/files/source_files.h"

namespace gladstone::inline compare {

/// Results of detecting the dots of one calibration plane.
struct CalibratedPlane {
  std::string file;
  double z = 0;              ///< [m]
  std::string sha256;        ///< SHA-256 of the pixels
  std::size_t found = 0;     ///< number of spots that look like dots
  std::size_t used = 0;      ///< number of these spots that were assigned to a node of the grid
  std::size_t not_dots = 0;  ///< number of detected spots with neither the size nor the shape of the dots
  /// spots at nodes of the grid that do not fit the other dots, excluded from the fit [px]
  std::vector<Vec2d> strangers;
  CentreDotMethod middle_by = CentreDotMethod::whole_grid;
  double smoothness_px = 0;  ///< rms scatter of the dots about a smooth grid, per component [px]
};

/// Camera models fitted to images of a dot grid in several planes.
struct Calibration {
  int columns = 0, rows = 0;  ///< size of the images [px]
  std::vector<CalibratedPlane> planes;
  CalibrationPoints points;
  std::vector<std::size_t> plane_of;      ///< plane of each point
  std::vector<std::array<int, 2>> index;  ///< grid index of each point, from the middle dot
  PinholeFit pinhole;
  SoloffFit soloff;
  Vec2d drift{};  ///< X and Y components of the unit vector along which the plate was moved [1]
  Warnings warnings;
  std::optional<PinholeCamera> rendered;  ///< true camera stored in the case's truth.h5, used only for comparison
  SourceFiles sources;
  std::string setup;  ///< resolved setup as TOML text
  std::uint64_t seed = 0;
};

/// Detects the dots of all planes of a calibration case, assigns them to the grid and fits a pinhole camera and a
/// polynomial.
/// @throws DataError if the case is not a calibration, an image shows too few dots, or there are fewer than two planes
Calibration calibrate_case(std::string const& folder);

/// Calibrates from image files, one per plane of a setup with experiment = "calibration". The setup's [calibration]
/// describes the dot grid; its camera and lens are needed only approximately.
/// @throws DataError as calibrate_case(), and if number or size of the images differ from the setup
/// @throws SetupError if the setup is invalid
Calibration calibrate_images(std::string const& setup, std::vector<std::string> const& pictures);

}  // namespace gladstone::inline compare
