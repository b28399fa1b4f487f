#pragma once

#include <vector>

#include "analysis/correlation/axis_weights.h"
#include "analysis/correlation/interrogation_job.h"
#include "render/base/vec.h"

namespace gladstone::inline correlation {

/// Weighted means of both frames over each window of a job that is entirely inside the image. All pixels are assumed to
/// be known. Windows overlap, so the sums along pixel columns are computed once for all windows of a grid row.
class WindowMeans {
 public:
  WindowMeans(InterrogationJob const& job, AxisWeightsView const& x, AxisWeightsView const& y);

  /// Returns the mean grey levels of frame A (x) and frame B (y). @pre the window is inside the image
  Vec2<float> of(int column, int row) const { return means_[static_cast<std::size_t>(row) * columns_ + column]; }

 private:
  int columns_;
  std::vector<Vec2<float>> means_;
};

}  // namespace gladstone::inline correlation
