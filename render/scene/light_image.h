#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "render/base/image.h"
#include "render/sensor/exposure.h"

namespace gladstone::inline scene {

/// Image accumulator in 64-bit fixed point. Threads may add to it concurrently; the result does not depend on the
/// order.
class LightImage {
 public:
  LightImage(int columns, int rows)
      : columns_(columns), rows_(rows), light_(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows)) {}

  void add(int column, int row, double light) {
    if (column < 0 || row < 0 || column >= columns_ || row >= rows_) return;
    light_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column)]
        .fetch_add(to_fixed_point(light), std::memory_order_relaxed);
  }
  Image<double> to_light() const {
    Image<double> image(columns_, rows_);
    for (std::size_t i = 0; i < light_.size(); ++i) {
      image.data()[i] = static_cast<double>(light_[i].load(std::memory_order_relaxed)) / fixed_point_one;
    }
    return image;
  }

 private:
  int columns_;
  int rows_;
  std::vector<std::atomic<std::int64_t>> light_;
};

}  // namespace gladstone::inline scene
