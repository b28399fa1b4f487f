#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "render/base/displacement_field.h"
#include "render/base/host_device.h"
#include "render/base/vec.h"

namespace gladstone {

/// A vector's neighbours on its grid, at most the 3x3 around it without itself. Only compile-time indices, so that a
/// GPU holds them in registers.
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
  /// Median of of(k) for k < count. @pre count > 0
  template <class Of>
  GLADSTONE_HD T median_of(Of const& of) const {
    // sorts all places, the empty ones last, by exchanging neighbours
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
  /// Median of each component. @pre count > 0
  GLADSTONE_HD Vec2<T> median() const {
    return {median_of([&](int k) { return value[k].x; }), median_of([&](int k) { return value[k].y; })};
  }
};

/// Normalised median residual of a vector, Westerweel & Scarano, Exp. Fluids 39 (2005) 1096, eq. 2: for each component
/// the distance from the neighbours' median over (median of the neighbours' own distances + epsilon), both joined as
/// the length of a vector. Above about 2 a vector is spurious.
/// @param epsilon expected noise [px]
/// @param enough  a bound that is not above this may stand for the residual: it takes less time @pre count > 0
template <class T>
GLADSTONE_HD T normalised_median_residual(Vec2<T> vector, Neighbours<T> const& neighbours, T epsilon, T enough = T(0)) {
  using std::abs;
  // a median is no farther than the farthest neighbour, and the neighbours' own distances only lower the residual
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

/// One vector of a grid under validation.
struct GridVector {
  Vec2d displacement;                   ///< predictor included [px]; means nothing where masked or invalid
  Vec2d predictor;                      ///< that the pass was deformed by, at the window's centre [px]
  Vec2d raw;                            ///< as measured, predictor included [px]; NaN where nothing was
  std::array<Vec2d, 2> alternatives{};  ///< displacements of the next correlation peaks, predictor included
  int alternative_count = 0;
  double correlation = 0.0;  ///< coefficient of the peak that `raw` is [1]
  double peak_ratio = 0.0;   ///< its height over that of the next peak; 0 where it is not the highest
  Ambiguity ambiguous = Ambiguity::none;
  VectorStatus status = VectorStatus::invalid;
  VectorReason reason = VectorReason::no_signal;
  FailedTest failed = FailedTest::none;
};

GLADSTONE_HD inline bool is_measured(GridVector const& vector) { return vector.raw.x == vector.raw.x; }

/// When a vector is spurious.
struct ValidationRule {
  double threshold = 2.0;      ///< of the normalised median residual
  double epsilon_px = 0.1;     ///< its noise level
  double trusted_ratio = 2.0;  ///< peak ratio from which a window is trusted against its neighbours
  double limit_px = std::numeric_limits<double>::infinity();  ///< largest displacement along either axis
  double least_peak_ratio = 0.0;   ///< below it a vector is spurious whatever its neighbours say
  double least_correlation = 0.0;  ///< the same for the coefficient of its peak [1]
  /// Of the residual of whole displacements (is_unlike()); infinite: no test.
  double displacement_threshold = std::numeric_limits<double>::infinity();
  bool replaces = true;  ///< spurious vectors; else they are invalid
};

/// Most by which a trusted window may differ from its neighbours' median [px]. Windows that overlap share dots: did
/// their displacements differ by more than a dot's size, 2 to 4 px, the dots of either would not agree on one peak.
/// What differs by more and has one clear peak is something else: a speck on the window, a reflection.
constexpr double most_trusted_px = 2.0;

GLADSTONE_HD inline bool is_within(Vec2d displacement, double limit_px) {
  using std::abs;
  return abs(displacement.x) <= limit_px && abs(displacement.y) <= limit_px;
}

/// The neighbours of vector i of a grid for which usable(index) holds, in reading order.
/// @param displacement of a vector by its index
/// @param offset       receives the neighbours' positions on the grid relative to i
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

/// The neighbours less the slopes of the plane that fits them best (least squares); as they are where all lie in one
/// line.
GLADSTONE_HD inline Neighbours<double> without_slope(Neighbours<double> neighbours, Neighbours<double> const& offset) {
  // normal equations with the mean taken out; the offsets are whole, so that the determinant is exact
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

/// Fewest neighbours by which a vector can be judged.
constexpr int fewest_neighbours = 3;

GLADSTONE_HD inline bool is_sound(VectorStatus status) {
  return status == VectorStatus::valid || status == VectorStatus::replaced;
}

/// Whether a vector's correlation speaks for it, so that it need not agree with its neighbours: a peak that is alone,
/// and a displacement that windows beside each other can have. Chance peaks have rivals: of those that win over the
/// true one in noise 19 of 20 are less than twice as high as the next, of true ones in clean images 1 in 50 (windows of
/// 16 px, five dots).
GLADSTONE_HD inline bool is_trusted(GridVector const& vector, Neighbours<double> const& neighbours,
                                    ValidationRule const& rule) {
  return vector.peak_ratio >= rule.trusted_ratio && vector.ambiguous == Ambiguity::none &&
         length(vector.displacement - vector.predictor - neighbours.median()) <= most_trusted_px;
}

/// A vector's usable neighbours, as what their pass added to its predictor and as displacements.
struct Surroundings {
  Neighbours<double> offset;  ///< on the grid; filled while the next is made
  Neighbours<double> increment;
  Neighbours<double> displacement;  ///< only where some are missing

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

/// Whether a displacement agrees with those around it: what the pass added does. Where neighbours are missing (at the
/// rim), their median is off by the local gradient, and the predictor is continued from further inside: there it also
/// agrees that agrees with the neighbours' displacements, or lies on the plane of either.
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

/// A window whose correlation is below this part of its neighbours' median correlates worse than they do.
constexpr double as_correlated = 0.9;

/// Whether a displacement as a whole differs from those around it, and its window correlates worse than theirs. A gross
/// error of an earlier pass is in the predictor, and what the last pass adds to it is small: the median test of what it
/// adds finds nothing. Gradients as steep as the grid is fine make whole displacements differ, too, but leave a window
/// as correlated as those beside it. At the rim, where the median is off by the gradient, the neighbours less their
/// slope must say so as well.
template <class Usable>
GLADSTONE_HD bool is_unlike(GridVector const* vectors, int i, int columns, int rows, ValidationRule const& rule,
                            Usable const& usable) {
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
  return vectors[i].correlation < as_correlated * correlation.median().x;
}

/// What vectors are judged by, one after the other: those that the first takes out no longer speak for others.
enum class Judgement { increments, displacements };

/// The test that a valid vector i fails: its peak is too low or too much like the next, or it does not agree with its
/// valid neighbours (validate_vectors).
GLADSTONE_HD inline FailedTest failed_test(GridVector const* vectors, int i, int columns, int rows,
                                           ValidationRule const& rule, Judgement by) {
  GridVector const& vector = vectors[i];
  auto const valid = [&](int k) { return vectors[k].status == VectorStatus::valid; };
  if (!valid(i)) return FailedTest::none;
  if (by == Judgement::displacements)
    return is_unlike(vectors, i, columns, rows, rule, valid) ? FailedTest::displacement : FailedTest::none;
  if (vector.peak_ratio < rule.least_peak_ratio) return FailedTest::peak_ratio;
  if (vector.correlation < rule.least_correlation) return FailedTest::correlation;
  Surroundings const around(vectors, i, columns, rows, valid);
  bool const stands = around.increment.count < fewest_neighbours ||
                      agrees(vector.displacement, vector.predictor, around, rule) ||
                      is_trusted(vector, around.increment, rule);
  return stands ? FailedTest::none : FailedTest::median;
}

/// The judgements that a rule asks for.
GLADSTONE_HD inline int judgements(ValidationRule const& rule) {
  return rule.displacement_threshold < std::numeric_limits<double>::infinity() ? 2 : 1;
}

/// What a spurious vector is replaced by, and where it is from.
struct VectorReplacement {
  Vec2d value;
  VectorReason reason;
};

/// Finds what replaces the spurious vector i. @return false where too few neighbours are sound
GLADSTONE_HD inline bool find_replacement(GridVector const* vectors, int i, int columns, int rows,
                                          ValidationRule const& rule, VectorReplacement& found) {
  GridVector const& vector = vectors[i];
  auto const usable = [&](int k) { return is_sound(vectors[k].status); };
  Surroundings const around(vectors, i, columns, rows, usable);
  if (around.increment.count < fewest_neighbours) return false;
  if (is_unlike(vectors, i, columns, rows, rule,
                usable)) {  // its predictor is wrong, and so is all that was found by it
    Neighbours<double> offset;
    Neighbours<double> const displacement = neighbours_of(
        i, columns, rows, [&](int k) { return vectors[k].displacement; }, usable, offset);
    found = {without_slope(displacement, offset).median(), VectorReason::neighbours};
    return true;
  }
  found = {around.is_whole() ? vector.predictor + around.increment.median()
                             : without_slope(around.displacement, around.offset).median(),
           VectorReason::neighbours};
  // where neighbours decide nothing no other peak is better, nor where even this one is too low
  if (!(rule.threshold < std::numeric_limits<double>::infinity()) || vector.correlation < rule.least_correlation)
    return true;
  for (int k = vector.alternative_count - 1; k >= 0; --k)
    if (agrees(vector.alternatives[k], vector.predictor, around, rule))
      found = {vector.alternatives[k], VectorReason::other_peak};
  return true;
}

/// Takes a spurious vector out, and puts what replaces it in its place. The limit binds replacements, too.
GLADSTONE_HD inline void take_out(GridVector& vector, FailedTest failed) {
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

/// Finds what fills the unknown node i from the known around it. @return false where there is none
template <class Known>
GLADSTONE_HD bool find_filling(Vec2d const* nodes, int i, int columns, int rows, Known const& known, Vec2d& value) {
  Neighbours<double> offset;
  Neighbours<double> const around = neighbours_of(
      i, columns, rows, [&](int k) { return nodes[k]; }, known, offset);
  if (around.count == 0) return false;
  value = around.median();
  return true;
}

/// The middle of three nodes in a line after averaging. @param part of its value that comes from the two others
GLADSTONE_HD inline Vec2d smoothed(Vec2d before, Vec2d middle, Vec2d after, double part) {
  return 0.5 * part * (before + after) + (1.0 - part) * middle;
}

/// Finds spurious vectors among the valid ones of a grid, row by row, and replaces them: by the next correlation peak
/// that agrees with the sound neighbours, else by their median (status replaced); where too few neighbours are sound,
/// the median is beyond the limit, or the rule says not to replace, invalid. What is judged is what a pass adds to its
/// predictor: there steep gradients are already taken off; at the rim, where the predictor is continued from further
/// inside, also the sum (agrees()), and the median there is that of the displacements less their plane. A vector with
/// fewer than three neighbours is left as it is, and so is one whose window is_trusted(): where structures are as fine
/// as the grid, the median cuts their crests off. Then, where the rule says so, whole displacements are judged alike
/// (is_unlike()). The result does not depend on any order.
void validate_vectors(std::span<GridVector> vectors, int columns, ValidationRule const& rule);

/// Displacement at every node, for a predictor: masked and invalid ones are filled from their neighbours' medians, from
/// the rim inwards; zero everywhere where the grid has no vector at all.
std::vector<Vec2d> filled_displacement(std::span<GridVector const> vectors, int columns);

/// A light 3x3 average, smoothed() along each axis, left out across the rim, so that linear fields pass unchanged.
std::vector<Vec2d> smoothed_displacement(std::span<Vec2d const> nodes, int columns, double part);

}  // namespace gladstone
