#pragma once

#include <vector>

#include "analysis/correlation/window_deformation.h"
#include "render/base/parallel.h"

namespace gladstone::inline correlation {

/// Coarse map of the image tiles in which all pixels are known, for fast tests of whether a rectangle contains known
/// pixels only.
class KnownTiles {
 public:
  explicit KnownTiles(ImagePair const& pair) : columns_((pair.columns + tile - 1) / tile) {
    if (pair.available.empty()) return;
    known_.assign(static_cast<std::size_t>(columns_) * ((pair.rows + tile - 1) / tile), true);
    parallel_chunks(static_cast<std::size_t>(pair.rows), tile, [&](std::size_t begin, std::size_t end) {
      char* const known = known_.data() + begin / tile * static_cast<std::size_t>(columns_);
      for (std::size_t j = begin; j < end; ++j)
        for (int i = 0; i < pair.columns; ++i)
          if (pair.available[j * static_cast<std::size_t>(pair.columns) + i] == 0.0f) known[i / tile] = false;
    });
  }

  /// Returns true if all tiles that the rectangle touches are fully known. @pre the rectangle is inside the image; it
  /// may be empty
  bool all_known(int first_x, int first_y, int end_x, int end_y) const {
    if (known_.empty()) return true;
    for (int j = first_y / tile; j * tile < end_y; ++j)
      for (int i = first_x / tile; i * tile < end_x; ++i)
        if (!known_[static_cast<std::size_t>(j) * columns_ + i]) return false;
    return true;
  }

 private:
  static constexpr int tile = 16;
  int columns_;
  std::vector<char> known_;
};

}  // namespace gladstone::inline correlation
