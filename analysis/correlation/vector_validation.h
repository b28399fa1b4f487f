#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "analysis/vectors/displacement_field.h"
#include "render/base/host_device.h"
#include "render/base/vec.h"

namespace gladstone::inline correlation {

/// Neighbours of a vector on its grid: up to eight of the surrounding 3x3. Only compile-time indices are used, so that
/// a GPU stores the array in registers.
template <class T>
struct Neighbours {
  static constexpr int capacity = 8;
  Vec2<T> value[capacity];
  int count = 0;

  GLADSTONE_HD void append(Vec2<T> v) {
    for (int k = 0; k < capacity; ++k)
      if (k == count) value[k] = v;
    ++count;
  }
  /// Returns the median of the values of(k) for 0 <= k < count. @pre count > 0
  template <class Of>
  GLADSTONE_HD T median_of(Of const& of) const {
    // Odd-even transposition sort; unused elements are filled with infinity, so that they are sorted to the end.
    T v[capacity];
    for (int k = 0; k < capacity; ++k) v[k] = k < count ? of(k) : std::numeric_limits<T>::infinity();
    for (int round = 0; round < capacity; ++round)
      for (int k = 0; k < capacity / 2; ++k) {
        int const i = 2 * k + round % 2;
        if (i + 1 >= capacity) continue;
        T const a = v[i], b = v[i + 1];
        v[i] = b < a ? b : a;
        v[i + 1] = b < a ? a : b;
      }
    T below{}, above{};
    for (int k = 0; k < capacity; ++k) {
      if (k == (count - 1) / 2) below = v[k];
      if (k == count / 2) above = v[k];
    }
    return count % 2 == 1 ? above : (below + above) / T(2);
  }
  /// Returns the median of each component. @pre count > 0
  GLADSTONE_HD Vec2<T> median() const {
    return {median_of([&](int k) { return value[k].x; }), median_of([&](int k) { return value[k].y; })};
  }
};

/// Normalised median residual of a vector, Westerweel & Scarano, Exp. Fluids 39 (2005) 1096, Eq. 2: for each component,
/// the distance of the vector from the neighbours' median is divided by the sum of epsilon and the median distance of
/// the neighbours from their median. Returns the length of the vector of both components. A vector is spurious above
/// about 2.
/// @param epsilon  expected noise [px]
/// @param enough  if a cheap upper bound of the residual is not above this value, the bound is returned instead
/// @pre neighbours.count > 0
template <class T>
GLADSTONE_HD T normalised_median_residual(Vec2<T> vector, Neighbours<T> const& neighbours, T epsilon, T enough = T(0)) {
  using std::abs;
  // Upper bound: the median is not farther away than the farthest neighbour, and the neighbours' spread only reduces
  // the residual.
  Vec2<T> farthest{};
  for (int k = 0; k < Neighbours<T>::capacity; ++k) {
    if (k >= neighbours.count) continue;
    T const x = abs(vector.x - neighbours.value[k].x), y = abs(vector.y - neighbours.value[k].y);
    farthest = {x > farthest.x ? x : farthest.x, y > farthest.y ? y : farthest.y};
  }
  if (T const bound = length(farthest) / epsilon; bound <= enough) return bound;
  Vec2<T> const median = neighbours.median();
  Vec2<T> const most{(vector.x - median.x) / epsilon, (vector.y - median.y) / epsilon};
  if (length(most) <= enough) return length(most);
  T const spread_x = neighbours.median_of([&](int k) { return abs(neighbours.value[k].x - median.x); });
  T const spread_y = neighbours.median_of([&](int k) { return abs(neighbours.value[k].y - median.y); });
  return length(Vec2<T>{(vector.x - median.x) / (spread_x + epsilon), (vector.y - median.y) / (spread_y + epsilon)});
}

/// Vector of a grid under validation.
struct GridVector {
  Vec2d displacement;                   ///< displacement including the predictor [px]; undefined if masked or invalid
  Vec2d predictor;                      ///< predictor of the pass at the window's centre [px]
  Vec2d raw;                            ///< measured displacement, including the predictor [px]; NaN: no measurement
  std::array<Vec2d, 2> alternatives{};  ///< displacements of the next correlation peaks, including the predictor [px]
  int alternative_count = 0;
  double correlation = 0.0;  ///< correlation coefficient of the peak from which `raw` was determined [1]
  /// Peak ratio of the peak from which `raw` was determined [1]; 0 if another peak is higher.
  double peak_ratio = 0.0;
  Ambiguity ambiguous = Ambiguity::none;
  VectorStatus status = VectorStatus::invalid;
  VectorReason reason = VectorReason::no_signal;
  FailedTest failed = FailedTest::none;
};

GLADSTONE_HD inline bool is_measured(GridVector const& vector) { return vector.raw.x == vector.raw.x; }

/// Criteria for spurious vectors.
struct ValidationRule {
  double threshold = 2.0;   ///< largest normalised median residual [1]
  double epsilon_px = 0.1;  ///< noise level in the normalised median residual [px]
  /// Peak ratio from which a vector may deviate from its neighbours [1], see has_reliable_correlation().
  double reliable_peak_ratio = 2.0;
  double limit_px = std::numeric_limits<double>::infinity();  ///< largest displacement along either axis [px]
  double least_peak_ratio = 0.0;   ///< lowest peak ratio of a vector, regardless of its neighbours [1]
  double least_correlation = 0.0;  ///< lowest correlation coefficient of a vector's peak [1]
  /// Largest normalised median residual of the total displacement, see is_displacement_outlier(); infinite: no test.
  double displacement_threshold = std::numeric_limits<double>::infinity();
  bool replaces = true;  ///< true: spurious vectors are replaced; false: they are invalid
};

/// Largest deviation from the neighbours' median for which a high peak ratio is accepted as evidence [px]. Overlapping
/// windows share dots: if their displacements differed by more than a dot diameter, 2 to 4 px, the dots of one window
/// would not agree on one peak. A single clear peak with a larger deviation has another cause, such as a speck or a
/// reflection.
constexpr double max_reliable_deviation_px = 2.0;

GLADSTONE_HD inline bool is_within(Vec2d displacement, double limit_px) {
  using std::abs;
  return abs(displacement.x) <= limit_px && abs(displacement.y) <= limit_px;
}

/// Returns the neighbours of vector i of a grid for which usable(index) is true, in reading order.
/// @param displacement  value of a vector by its index
/// @param offset  output: positions of the neighbours on the grid relative to i
template <class Displacement, class Usable>
GLADSTONE_HD Neighbours<double> neighbours_of(int i, int columns, int rows, Displacement const& displacement,
                                              Usable const& usable, Neighbours<double>& offset) {
  int const column = i % columns, row = i / columns;
  Neighbours<double> result;
  for (int y = -1; y <= 1; ++y)
    for (int x = -1; x <= 1; ++x) {
      bool const inside = column + x >= 0 && column + x < columns && row + y >= 0 && row + y < rows;
      int const k = i + y * columns + x;
      if (!inside || (x == 0 && y == 0) || !usable(k)) continue;
      offset.append({static_cast<double>(x), static_cast<double>(y)});
      result.append(displacement(k));
    }
  return result;
}

/// Subtracts the slopes of the least-squares plane from the neighbours' values; returns them unchanged if all
/// neighbours are on one line.
GLADSTONE_HD inline Neighbours<double> without_slope(Neighbours<double> neighbours, Neighbours<double> const& offset) {
  // Normal equations without the mean. The offsets are integers, so the determinant is exact.
  double const n = neighbours.count;
  Vec2d sum, value_sum;
  double xx = 0.0, xy = 0.0, yy = 0.0;
  Vec2d x_value, y_value;
  for (int k = 0; k < Neighbours<double>::capacity; ++k) {
    if (k >= neighbours.count) continue;
    Vec2d const o = offset.value[k], value = neighbours.value[k];
    sum += o;
    value_sum += value;
    xx += o.x * o.x;
    xy += o.x * o.y;
    yy += o.y * o.y;
    x_value += o.x * value;
    y_value += o.y * value;
  }
  double const a = n * xx - sum.x * sum.x, b = n * xy - sum.x * sum.y, c = n * yy - sum.y * sum.y;
  double const determinant = a * c - b * b;
  if (determinant == 0.0) return neighbours;
  Vec2d const right_x = n * x_value - sum.x * value_sum, right_y = n * y_value - sum.y * value_sum;
  Vec2d const slope_x = (c * right_x - b * right_y) / determinant, slope_y = (a * right_y - b * right_x) / determinant;
  for (int k = 0; k < Neighbours<double>::capacity; ++k)
    if (k < neighbours.count) neighbours.value[k] -= offset.value[k].x * slope_x + offset.value[k].y * slope_y;
  return neighbours;
}

/// Smallest number of neighbours for the median test.
constexpr int fewest_neighbours = 3;

GLADSTONE_HD inline bool is_valid_or_replaced(VectorStatus status) {
  return status == VectorStatus::valid || status == VectorStatus::replaced;
}

/// Returns whether the correlation of a vector outweighs a deviation from its neighbours: its peak ratio is high, it is
/// not ambiguous, and the deviation is at most max_reliable_deviation_px. In windows of 16 px with five dots, a peak
/// ratio below 2 occurs for 19 of 20 random peaks that exceed the true peak in noisy images, but only for 1 of 50 true
/// peaks in noise-free images.
GLADSTONE_HD inline bool has_reliable_correlation(GridVector const& vector, Neighbours<double> const& neighbours,
                                                  ValidationRule const& rule) {
  return vector.peak_ratio >= rule.reliable_peak_ratio && vector.ambiguous == Ambiguity::none &&
         length(vector.displacement - vector.predictor - neighbours.median()) <= max_reliable_deviation_px;
}

/// Usable neighbours of a vector: their displacements and the increments that the pass added to the predictor.
struct Surroundings {
  Neighbours<double> offset;  ///< positions on the grid relative to the vector
  Neighbours<double> increment;
  /// Displacements of the neighbours; filled only if some of the eight neighbours are missing.
  Neighbours<double> displacement;

  template <class Usable>
  GLADSTONE_HD Surroundings(GridVector const* vectors, int i, int columns, int rows, Usable const& usable)
      : increment(neighbours_of(
            i, columns, rows, [&](int k) { return vectors[k].displacement - vectors[k].predictor; }, usable, offset)) {
    if (is_whole()) return;
    Neighbours<double> again;
    displacement = neighbours_of(
        i, columns, rows, [&](int k) { return vectors[k].displacement; }, usable, again);
  }

  GLADSTONE_HD bool is_whole() const { return increment.count == Neighbours<double>::capacity; }
};

/// Median test: returns whether a displacement agrees with its neighbours. The test compares the increments to the
/// predictor. If neighbours are missing (at the border), their median is biased by the local gradient and the predictor
/// is extrapolated; in this case the displacement also agrees if it passes the test for the total displacements, or the
/// test for increments or total displacements after subtraction of their slopes.
GLADSTONE_HD inline bool agrees(Vec2d displacement, Vec2d predictor, Surroundings const& around,
                                ValidationRule const& rule) {
  auto const is_near = [&](Vec2d value, Neighbours<double> const& neighbours) {
    return normalised_median_residual(value, neighbours, rule.epsilon_px, rule.threshold) <= rule.threshold;
  };
  Vec2d const increment = displacement - predictor;
  if (is_near(increment, around.increment)) return true;
  return !around.is_whole() && (is_near(displacement, around.displacement) ||
                                is_near(increment, without_slope(around.increment, around.offset)) ||
                                is_near(displacement, without_slope(around.displacement, around.offset)));
}

/// Fraction of the neighbours' median correlation below which a window correlates worse than its neighbours.
constexpr double min_relative_correlation = 0.9;

/// Returns whether a total displacement deviates from its neighbours and the correlation of its window is also lower
/// than that of their windows. The median test of the increments does not detect a gross error of an earlier pass,
/// because the predictor contains this error and the last increment is small. A gradient that is steep on the scale of
/// the grid also causes deviating displacements, but does not lower the correlation. At the border, where the median is
/// biased by the gradient, the test must also fail for the neighbours without their slopes.
template <class Usable>
GLADSTONE_HD bool is_displacement_outlier(GridVector const* vectors, int i, int columns, int rows,
                                          ValidationRule const& rule, Usable const& usable) {
  double const threshold = rule.displacement_threshold;
  if (!(threshold < std::numeric_limits<double>::infinity())) return false;
  Neighbours<double> offset, again;
  Neighbours<double> const around = neighbours_of(
      i, columns, rows, [&](int k) { return vectors[k].displacement; }, usable, offset);
  auto const differs = [&](Neighbours<double> const& from) {
    return normalised_median_residual(vectors[i].displacement, from, rule.epsilon_px, threshold) > threshold;
  };
  if (around.count < fewest_neighbours || !differs(around)) return false;
  if (around.count < Neighbours<double>::capacity && !differs(without_slope(around, offset))) return false;
  Neighbours<double> const correlation = neighbours_of(
      i, columns, rows,
      [&](int k) {
        return Vec2d{vectors[k].correlation, 0.0};
      },
      usable, again);
  return vectors[i].correlation < min_relative_correlation * correlation.median().x;
}

/// Successive tests of the vectors of a grid: vectors rejected in the first stage are not used as neighbours in the
/// second stage.
enum class ValidationStage { increments, displacements };

/// Returns the first test that a valid vector i fails, see validate_vectors(). The tests of ValidationStage::increments
/// are peak ratio, correlation and agreement with the valid neighbours; the test of ValidationStage::displacements is
/// is_displacement_outlier().
GLADSTONE_HD inline FailedTest failed_test(GridVector const* vectors, int i, int columns, int rows,
                                           ValidationRule const& rule, ValidationStage by) {
  GridVector const& vector = vectors[i];
  auto const valid = [&](int k) { return vectors[k].status == VectorStatus::valid; };
  if (!valid(i)) return FailedTest::none;
  if (by == ValidationStage::displacements)
    return is_displacement_outlier(vectors, i, columns, rows, rule, valid) ? FailedTest::displacement
                                                                           : FailedTest::none;
  if (vector.peak_ratio < rule.least_peak_ratio) return FailedTest::peak_ratio;
  if (vector.correlation < rule.least_correlation) return FailedTest::correlation;
  Surroundings const around(vectors, i, columns, rows, valid);
  bool const stands = around.increment.count < fewest_neighbours ||
                      agrees(vector.displacement, vector.predictor, around, rule) ||
                      has_reliable_correlation(vector, around.increment, rule);
  return stands ? FailedTest::none : FailedTest::median;
}

/// Returns the number of validation stages that a rule requires.
GLADSTONE_HD inline int validation_stage_count(ValidationRule const& rule) {
  return rule.displacement_threshold < std::numeric_limits<double>::infinity() ? 2 : 1;
}

/// Replacement of a spurious vector: its value, and how it was determined.
struct VectorReplacement {
  Vec2d value;
  VectorReason reason;
};

/// Finds the replacement of the spurious vector i. @return false if fewer than fewest_neighbours of its neighbours are
/// valid or replaced
GLADSTONE_HD inline bool find_replacement(GridVector const* vectors, int i, int columns, int rows,
                                          ValidationRule const& rule, VectorReplacement& found) {
  GridVector const& vector = vectors[i];
  auto const usable = [&](int k) { return is_valid_or_replaced(vectors[k].status); };
  Surroundings const around(vectors, i, columns, rows, usable);
  if (around.increment.count < fewest_neighbours) return false;
  if (is_displacement_outlier(vectors, i, columns, rows, rule, usable)) {
    // The predictor is wrong, and therefore all peaks found with it are wrong.
    Neighbours<double> offset;
    Neighbours<double> const displacement = neighbours_of(
        i, columns, rows, [&](int k) { return vectors[k].displacement; }, usable, offset);
    found = {without_slope(displacement, offset).median(), VectorReason::neighbours};
    return true;
  }
  found = {around.is_whole() ? vector.predictor + around.increment.median()
                             : without_slope(around.displacement, around.offset).median(),
           VectorReason::neighbours};
  // Do not use secondary peaks if there is no median test to select them, or if the main peak is below the minimum
  // correlation, since secondary peaks are even lower.
  if (!(rule.threshold < std::numeric_limits<double>::infinity()) || vector.correlation < rule.least_correlation)
    return true;
  for (int k = vector.alternative_count - 1; k >= 0; --k)
    if (agrees(vector.alternatives[k], vector.predictor, around, rule))
      found = {vector.alternatives[k], VectorReason::other_peak};
  return true;
}

/// Marks a vector as spurious (reject_vector()), or stores its replacement (replace()). A replacement beyond the limit
/// is invalid.
GLADSTONE_HD inline void reject_vector(GridVector& vector, FailedTest failed) {
  vector.status = VectorStatus::invalid;
  vector.reason = VectorReason::not_replaced;
  vector.failed = failed;
}
GLADSTONE_HD inline void replace(GridVector& vector, VectorReplacement const& by, ValidationRule const& rule) {
  bool const allowed = is_within(by.value, rule.limit_px);
  vector.displacement = by.value;
  vector.status = allowed ? VectorStatus::replaced : VectorStatus::invalid;
  vector.reason = allowed ? by.reason : VectorReason::beyond_limit;
  if (!allowed) vector.failed = FailedTest::none;
}

/// Computes the value of the unknown node i as the median of its known neighbours. @return false if no neighbour is
/// known
template <class Known>
GLADSTONE_HD bool find_gap_value(Vec2d const* nodes, int i, int columns, int rows, Known const& known, Vec2d& value) {
  Neighbours<double> offset;
  Neighbours<double> const around = neighbours_of(
      i, columns, rows, [&](int k) { return nodes[k]; }, known, offset);
  if (around.count == 0) return false;
  value = around.median();
  return true;
}

/// Returns the weighted mean of three nodes in a line. @param part  total weight of the two outer nodes
GLADSTONE_HD inline Vec2d smoothed(Vec2d before, Vec2d middle, Vec2d after, double part) {
  return 0.5 * part * (before + after) + (1.0 - part) * middle;
}

/// Finds spurious vectors among the valid ones of a grid, and replaces them. The result does not depend on the order in
/// which the vectors are tested.
/// - The median test applies to the increments to the predictor, which no longer contain steep gradients; see
///   agrees() for the border. Then, if the rule requires it, is_displacement_outlier() tests the total displacements.
/// - A spurious vector is replaced by the highest secondary peak that agrees with the valid or replaced neighbours,
///   otherwise by the neighbours' median. The vector becomes invalid if it has fewer than three such neighbours, the
///   replacement exceeds the limit, or the rule does not allow replacements.
/// - Vectors with fewer than three neighbours and those accepted by has_reliable_correlation() remain unchanged: the
///   median would clip the maxima of structures as fine as the grid.
void validate_vectors(std::span<GridVector> vectors, int columns, ValidationRule const& rule);

/// Returns the displacement at every node, for a predictor. Masked and invalid nodes are filled with the median of
/// their neighbours, from the border of each gap inwards; all values are zero if the grid has no valid or replaced
/// vector.
std::vector<Vec2d> filled_displacement(std::span<GridVector const> vectors, int columns);

/// Smooths the nodes by smoothed() along each axis, except across the border, so that linear fields remain unchanged.
std::vector<Vec2d> smoothed_displacement(std::span<Vec2d const> nodes, int columns, double part);

}  // namespace gladstone::inline correlation
