#pragma once

#include "analysis/correlation/float_lanes.h"

namespace gladstone::inline uncertainty {

/// Access policy of WindowStatistics for eight columns at a time.
struct EightColumns {
  using Value = FloatLanes;
  static constexpr int count = lane_count;
  static FloatLanes load(float const* from) { return load_lanes(from); }
  static void store(float* to, FloatLanes value) { store_lanes(to, value); }
  /// Sums the lanes in a fixed order.
  static double sum(FloatLanes value) {
    return static_cast<double>(((value[0] + value[4]) + (value[2] + value[6])) +
                               ((value[1] + value[5]) + (value[3] + value[7])));
  }
};

}  // namespace gladstone::inline uncertainty
