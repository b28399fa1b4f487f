#pragma once

#include <array>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "analysis/calibration/grid_assignment.h"
#include "analysis/calibration/pinhole_fit.h"
#include "analysis/calibration/soloff_fit.h"
#include "render/base/source_files.h"

namespace gladstone {

/// What one plane of a calibration showed.
struct CalibratedPlane {
  std::string file;
  double z = 0;                  ///< [m]
  std::string sha256;            ///< of its pixels
  std::size_t found = 0;         ///< what looks like a dot
  std::size_t used = 0;          ///< of these, those with a place on the grid
  std::size_t not_dots = 0;      ///< what stands out and has neither the size nor the shape of the dots
  std::vector<Vec2d> strangers;  ///< spots with a place on the grid that do not fit the other dots [px]
  MiddleBy middle_by = MiddleBy::whole_grid;
  double smoothness_px = 0;  ///< scatter of the dots about a smooth grid, per component
};

/// A camera calibrated by pictures of dots.
struct Calibration {
  int columns = 0, rows = 0;  ///< of the pictures
  std::vector<CalibratedPlane> planes;
  CalibrationPoints points;
  std::vector<std::size_t> plane_of;      ///< every point
  std::vector<std::array<int, 2>> index;  ///< its place on the grid
  PinholeFit pinhole;
  SoloffFit soloff;
  Vec2d drift{};  ///< components along X and Y of the unit direction in which the plate was moved [1]
  std::vector<std::string> warnings;
  std::optional<PinholeCamera> rendered;  ///< that the truth of the case knows, for comparison alone
  SourceFiles sources;
  std::string setup;  ///< resolved
  std::uint64_t seed = 0;
};

/// Detects the dots of all planes, puts them on the grid and fits both models. @throws DataError where the case is no
/// calibration, a picture shows too few dots, or the planes are too few
Calibration calibrate_case(std::string const& folder);

/// The same by pictures from anywhere, one for each plane of a setup with experiment = "calibration": its [calibration]
/// says what they show, its camera and lens about how. @throws DataError also where their number or size is not the
/// setup's; SetupError
Calibration calibrate_pictures(std::string const& setup, std::vector<std::string> const& pictures);

/// Writes calibration.h5 (docs/file-formats.md).
void write_calibration_file(std::string const& path, Calibration const& calibration);

/// Draws the residuals of both models over the picture. @throws GnuplotMissing
void draw_calibration(std::string const& path, Calibration const& calibration);

/// One JSON object, and the same as a table.
nlohmann::ordered_json calibration_json(Calibration const& calibration);
std::string calibration_table(Calibration const& calibration);

}  // namespace gladstone
