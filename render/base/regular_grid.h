#pragma once

#include <array>
#include <cstddef>

#include "render/base/vec.h"

namespace gladstone {

/// A regular grid of nodes in the world frame; node i of N on an axis lies at origin + i spacing.
struct RegularGrid {
  std::array<int, 3> nodes{1, 1, 1};                  ///< along x, y, z
  Vec3d spacing{1.0, 1.0, 1.0};                       ///< [m], positive
  Vec3d origin{0.0, 0.0, 0.0};                        ///< world position of node (0, 0, 0) [m]
  std::array<bool, 3> periodic{false, false, false};  ///< period N times spacing

  std::size_t size() const {
    return static_cast<std::size_t>(nodes[0]) * static_cast<std::size_t>(nodes[1]) * static_cast<std::size_t>(nodes[2]);
  }
};

}  // namespace gladstone
