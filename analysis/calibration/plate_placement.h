#pragma once

#include <array>
#include <optional>
#include <vector>

#include "analysis/calibration/calibration_points.h"

namespace gladstone {

/// How the plate with the dots stood, where that differs from a grid that is moved along its own normal with its middle
/// dot on Z. The world's X and Y are the plate's, its Z the plate's normal.
struct PlatePlacement {
  Vec2d drift{};                          ///< components along X and Y of the unit direction in which it was moved [1]
  std::vector<std::array<int, 2>> moved;  ///< columns and rows to be added to the dots of each plane; empty: none
  std::vector<std::size_t> order;         ///< the plane that each picture shows; empty: its own
};

/// The dots of all planes with their places on the grid.
struct PlateDots {
  std::vector<Vec2d> pixel;
  std::vector<std::array<int, 2>> index;  ///< columns and rows from the middle dot
  std::vector<std::size_t> plane_of;
  std::vector<double> z;  ///< by how far each plane was moved [m]
  double spacing = 0;     ///< of the dots [m]
  double dot_radius = 0;  ///< [m]
  CalibratedLens lens;

  CalibrationPoints points(PlatePlacement const& placement = {}) const;
};

/// Finds the order of pictures in which a pinhole camera without distortion fits the dots at least five times better
/// than in the given one. @return nullopt where there is none, or more than six planes
std::optional<std::vector<std::size_t>> find_picture_order(PlateDots const& dots);

/// Finds the plane whose middle dot is off by one or two columns or rows: the only such change that makes a pinhole
/// camera without distortion fit at least five times better. Of several, which differ by a drift, that with the
/// principal point nearest to the expected one.
std::optional<PlatePlacement> find_moved_middle(PlateDots const& dots, Vec2d principal_point_px);

/// Finds the drift of a plate that was not moved along its normal from the place of the principal point: a drift d
/// moves it by f d. Where the drift is a whole number of spacings from plane to plane, the middle dots were taken
/// wrong.
/// @return nullopt where no drift brings the principal point within 1 px of the expected one
std::optional<PlatePlacement> find_drift(PlateDots const& dots, Vec2d principal_point_px);

}  // namespace gladstone
