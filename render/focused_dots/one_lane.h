#pragma once

#include "render/base/interrupt.h"

namespace gladstone {

/// The threads that work on a dot together: on the CPU one lane by itself, which is every group at once. A device's
/// block splits into teams, which take a place or some points of the source each, and those into groups of eight.
/// What is written for them runs on both: lanes take every size()-th piece of work from their own on, sync() before
/// they read what others wrote, and get sums in one order.
struct OneLane {
  static constexpr bool alone = true;
  static constexpr int lane() { return 0; }
  static constexpr int size() { return 1; }
  static void sync() {}
  static void sync_team() {}
  static void poll() { throw_if_interrupted(); }

  // parts of the group, and which of how many of them this lane is in
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
  /// The next place in a list that lanes add to in any order.
  static int take(int& listed) { return listed++; }
  /// How many lanes below have the same key, and how many lanes have.
  struct Same {
    int before, all;
  };
  static Same same(int) { return {0, 1}; }
  /// Sum over the lanes below. @param all receives that over all lanes
  static int sum_below(int value, int& all) {
    all = value;
    return 0;
  }
};

/// Numbers in which a spot's row is held: whole vectors, whose ends add zeros beyond its last pixel.
constexpr int most_lanes = 48;
constexpr int lanes_for(int width) {
  for (int const lanes : {8, 12, 16, 24}) {
    if (width <= lanes) return lanes;
  }
  return most_lanes;
}
/// Calls body<lanes>(), so that the compiler knows them and a row takes whole vectors.
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

}  // namespace gladstone
