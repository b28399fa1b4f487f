#pragma once

#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "render/base/displacement_field.h"
#include "render/base/host_device.h"
#include "render/base/vec.h"

namespace gladstone {

/// Sorts a few values in place and gives their median. @pre count > 0
template <class T>
GLADSTONE_HD T median_in_place(T* values, int count) {
  for (int i = 1; i < count; ++i) {
    T const value = values[i];
    int k = i;
    for (; k > 0 && values[k - 1] > value; --k) values[k] = values[k - 1];
    values[k] = value;
  }
  return count % 2 == 1 ? values[count / 2] : (values[count / 2 - 1] + values[count / 2]) / T(2);
}

/// A vector's neighbours on its grid, at most the 3x3 around it without itself.
template <class T>
struct Neighbours {
  static constexpr int capacity = 8;
  Vec2<T> value[capacity];
  int count = 0;

  /// Median of each component. @pre count > 0
  GLADSTONE_HD Vec2<T> median() const {
    T x[capacity], y[capacity];
    for (int i = 0; i < count; ++i) {
      x[i] = value[i].x;
      y[i] = value[i].y;
    }
    return {median_in_place(x, count), median_in_place(y, count)};
  }
};

/// Normalised median residual of a vector, Westerweel & Scarano, Exp. Fluids 39 (2005) 1096, eq. 2: for each component
/// the distance from the neighbours' median over (median of the neighbours' own distances + epsilon), both joined as
/// the length of a vector. Above about 2 a vector is spurious. @param epsilon expected noise [px] @pre count > 0
template <class T>
GLADSTONE_HD T normalised_median_residual(Vec2<T> vector, Neighbours<T> const& neighbours, T epsilon) {
  using std::abs;
  Vec2<T> const median = neighbours.median();
  T x[Neighbours<T>::capacity], y[Neighbours<T>::capacity];
  for (int i = 0; i < neighbours.count; ++i) {
    x[i] = abs(neighbours.value[i].x - median.x);
    y[i] = abs(neighbours.value[i].y - median.y);
  }
  return length(Vec2<T>{(vector.x - median.x) / (median_in_place(x, neighbours.count) + epsilon),
                        (vector.y - median.y) / (median_in_place(y, neighbours.count) + epsilon)});
}

/// One vector of a grid under validation.
struct GridVector {
  Vec2d displacement;                   ///< [px]; means nothing where the status is masked or invalid
  std::array<Vec2d, 2> alternatives{};  ///< displacements of the next correlation peaks
  int alternative_count = 0;
  VectorStatus status = VectorStatus::invalid;
};

/// When a vector is spurious.
struct ValidationRule {
  double threshold = 2.0;   ///< of the normalised median residual
  double epsilon_px = 0.1;  ///< its noise level
};

/// Finds spurious vectors among the valid ones of a grid, row by row, and replaces them: by the next correlation peak
/// that agrees with the sound neighbours, else by their median (status replaced); where too few neighbours are sound,
/// invalid. A vector with fewer than three neighbours is left as it is. Where neighbours are missing (at the rim),
/// their median is off by the local gradient; there a vector also passes that agrees once the neighbours' plane is
/// subtracted. The result does not depend on any order.
void validate_vectors(std::span<GridVector> vectors, int columns, ValidationRule const& rule);

/// Displacement at every node, for a predictor: masked and invalid ones are filled from their neighbours' medians, from
/// the rim inwards; zero everywhere where the grid has no vector at all.
std::vector<Vec2d> filled_displacement(std::span<GridVector const> vectors, int columns);

/// A light 3x3 average, weights (1 6 1)/8 along each axis, left out across the rim, so that linear fields pass
/// unchanged.
std::vector<Vec2d> smoothed_displacement(std::span<Vec2d const> nodes, int columns);

}  // namespace gladstone
