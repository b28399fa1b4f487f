#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "render/base/vec.h"
#include "render/setup/setup_table.h"

namespace gladstone::inline light {

enum class TargetKind {
  dots,
  points,
  image,
  lattice,  ///< dots of a calibration target
};
enum class DotArrangement { random, regular };
enum class Polarity { bright, dark };

/// Table [target] of a setup, in SI.
struct TargetSetup {
  TargetKind kind = TargetKind::dots;
  double dots_per_32px_window = 20.0;
  std::optional<double> dot_diameter_px = 3.0;  ///< diameter of the geometric image [px]; empty: dot_diameter_m is
                                                ///< given
  std::optional<double> dot_diameter_m;         ///< diameter of a dot on the target [m]
  DotArrangement arrangement = DotArrangement::random;
  Polarity polarity = Polarity::bright;
  std::optional<Vec2d> extent_m;  ///< width and height [m]; empty: field of view plus one window on each side
  std::optional<Vec2d> centre_m;  ///< centre on the target plane [m]; empty: on the camera's optical axis
  std::string file;               ///< points: CSV x_mm,y_mm; image: image file
  std::uint64_t seed = 7;
  double spacing = 0;  ///< dot spacing of a lattice [m]
};

TargetSetup read_target_setup(SetupTable table);

}  // namespace gladstone::inline light
