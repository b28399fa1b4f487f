#pragma once

#include <vector>

#include "analysis/correlation/axis_weights.h"
#include "analysis/correlation/interrogation_job.h"
#include "render/base/vec.h"

namespace gladstone {

/// The weighted means of both frames over every window of a job that lies in them, all their pixels taken as known.
/// Windows overlap: the sums down a column of pixels are taken once for all windows of a row.
class WindowMeans {
 public:
  WindowMeans(InterrogationJob const& job, AxisWeightsView const& x, AxisWeightsView const& y);

  /// Grey levels of reference and flow. @pre the window lies in the frames
  Vec2<float> of(int column, int row) const { return means_[static_cast<std::size_t>(row) * columns_ + column]; }

 private:
  int columns_;
  std::vector<Vec2<float>> means_;
};

}  // namespace gladstone
