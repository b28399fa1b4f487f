#pragma once

#include <array>
#include <cstddef>

#include "render/base/vec.h"

namespace gladstone::inline base {

/// Regular grid of nodes in the world frame; node i of an axis is at origin + i spacing.
struct RegularGrid {
  std::array<int, 3> nodes{1, 1, 1};                  ///< number of nodes along x, y and z
  Vec3d spacing{1.0, 1.0, 1.0};                       ///< distance between nodes [m], positive
  Vec3d origin{0.0, 0.0, 0.0};                        ///< position of node (0, 0, 0) [m]
  std::array<bool, 3> periodic{false, false, false};  ///< true along axes on which the field repeats with a period of
                                                      ///< nodes times spacing

  std::size_t size() const {
    return static_cast<std::size_t>(nodes[0]) * static_cast<std::size_t>(nodes[1]) * static_cast<std::size_t>(nodes[2]);
  }
};

}  // namespace gladstone::inline base
