#pragma once

#include "render/base/interrupt.h"

namespace gladstone::inline focused_dots {

/// Group of threads that process a dot together: on the CPU a single lane, which represents groups of all levels. On a
/// device, a block of threads is divided into teams, each of which processes a point of the source rule or some points
/// of the source, and teams into groups of eight.
/// Code for such groups runs on both: a lane processes every size()-th item from its own index on, calls sync() before
/// it reads results of others, and obtains sums in a fixed order.
struct OneLane {
  static constexpr bool alone = true;
  static constexpr int lane() { return 0; }
  static constexpr int size() { return 1; }
  static void sync() {}
  static void sync_team() {}
  static void poll() { throw_if_interrupted(); }

  // Parts of the group: index of this lane's part, and number of parts.
  OneLane team() const { return {}; }
  OneLane eight() const { return {}; }
  static constexpr int index() { return 0; }
  static constexpr int count() { return 1; }

  template <class Value>
  static Value sum(Value const& value) {
    return value;
  }
  template <class Extent>
  static Extent spanned(Extent const& extent) {
    return extent;
  }
  static bool all(bool value) { return value; }
  static bool any(bool value) { return value; }
  /// Returns the next free position in a list to which lanes add in any order.
  static int take(int& listed) { return listed++; }
  /// Number of lower lanes with the same key, and of all lanes with the same key.
  struct Same {
    int before, all;
  };
  static Same same(int) { return {0, 1}; }
  /// Returns the sum of `value` over the lower lanes.
  /// @param all  receives the sum over all lanes
  static int sum_below(int value, int& all) {
    all = value;
    return 0;
  }
};

/// Length of the array for a row of the PSF: a multiple of the vector width; elements beyond the last pixel are zero.
constexpr int most_lanes = 48;
constexpr int lanes_for(int width) {
  for (int const lanes : {8, 12, 16, 24}) {
    if (width <= lanes) return lanes;
  }
  return most_lanes;
}
/// Calls body<lanes>() with the row length as a compile-time constant, so that the compiler uses whole vectors.
template <class Body>
void with_lanes(int width, Body const& body) {
  switch (lanes_for(width)) {
    case 8:
      return body.template operator()<8>();
    case 12:
      return body.template operator()<12>();
    case 16:
      return body.template operator()<16>();
    case 24:
      return body.template operator()<24>();
    default:
      return body.template operator()<most_lanes>();
  }
}

}  // namespace gladstone::inline focused_dots
