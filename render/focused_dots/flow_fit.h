#pragma once

#include <cstdint>

#include "render/focused_dots/ray_record.h"

namespace gladstone {

/// How rays' displacements scatter: weighted sums of squares.
struct FlowScatter {
  double unexplained = 0;  ///< of |hit - fit|^2
  double square = 0;       ///< of |hit - mean|^2

  GLADSTONE_HD FlowScatter& operator+=(FlowScatter const& o) {
    unexplained += o.unexplained;
    square += o.square;
    return *this;
  }
};

/// A smooth model of a dot's light in the flow: displacement as a polynomial of the place on the source (cubic) and of
/// the pupil point (quadratic), arrival on the lens plane as a linear function of both. Where the rays are few, or the
/// source is a point, the model is simpler. By least squares over a dot's rays: prepare, sum products of factors over
/// the rays, solve, settle; one thread or many share the work.
class FlowFit {
 public:
  static constexpr int most_terms = 19;
  static constexpr int bend_terms = 5;  ///< 1, pupil x, y, place x, y: the first terms of the displacement, too
  static constexpr int targets = 4;     ///< displacement x, y and bend x, y
  static constexpr int most_factors = most_terms + targets;
  static constexpr int most_sums = most_terms * (most_terms + 1) / 2 + targets * most_terms;

  /// @param extended false: the source is a point
  GLADSTONE_HD void prepare(std::uint64_t rays, double stop_radius, bool extended) {
    stop_radius_ = stop_radius;
    extended_ = extended;
    terms_ = rays < 32 ? 1 : (rays < 96 ? (extended ? 5 : 3) : (extended ? most_terms : 6));
    bends_ = rays < 32 ? 1 : (extended ? bend_terms : 3);
  }

  GLADSTONE_HD int factor_count() const { return terms_ + targets; }
  GLADSTONE_HD int sum_count() const { return terms_ * (terms_ + 1) / 2 + targets * terms_; }

  /// The basis at a ray, then what it is to explain. @param hit the ray's displacement from flow_displacement()
  GLADSTONE_HD void factors(RayRecord<double> const& ray, Vec2d hit, double* out) const {
    basis(ray.place, ray.pupil, out);
    Vec2d const bend = ray.bend();
    out[terms_] = hit.x;
    out[terms_ + 1] = hit.y;
    out[terms_ + 2] = bend.x;
    out[terms_ + 3] = bend.y;
  }

  /// Which factors the sum `index` multiplies: first >= second, second < number of terms. The sum over the rays is
  /// weighted with their flow weight.
  GLADSTONE_HD void factors_of_sum(int index, int& first, int& second) const {
    first = 0;
    while (index >= (first < terms_ ? first + 1 : terms_)) {
      index -= first < terms_ ? first + 1 : terms_;
      ++first;
    }
    second = index;
  }

  /// Solves the normal equations by the root-free Cholesky decomposition of the matrix with the targets as further
  /// rows (Golub & Van Loan 2013, section 4.1). A term that the rays do not determine gets no coefficient.
  /// @param sums overwritten @param lane, lanes which of how many threads this is @param sync waits for the others
  template <class Sync>
  GLADSTONE_HD void solve(double* sums, int lane, int lanes, Sync&& sync) {
    double const smallest = 1e-13 * sums[0];
    for (int k = 0; k < terms_; ++k) {
      double const pivot = sums[at(k, k)];
      for (int i = k + 1 + lane; i < terms_ + targets; i += lanes) {
        double const l = pivot > smallest ? sums[at(i, k)] / pivot : 0.0;
        int const end = i < terms_ ? i + 1 : terms_;
        for (int j = k + 1; j < end; ++j) sums[at(i, j)] -= l * sums[at(j, k)];
      }
      sync();
    }
    for (int target = lane; target < targets; target += lanes) {
      int const count = target < 2 ? terms_ : bends_;
      for (int k = count - 1; k >= 0; --k) {
        double const pivot = sums[at(k, k)];
        double rest = sums[at(terms_ + target, k)];
        for (int j = k + 1; j < count; ++j) rest -= sums[at(j, k)] * coefficient(target, j);
        coefficient(target, k) = pivot > smallest ? rest / pivot : 0.0;
      }
      for (int k = count; k < bend_terms; ++k) coefficient(target, k) = 0;
    }
    sync();
  }

  /// A ray's part in the scatter about the fit and about the mean. @param hit its displacement
  GLADSTONE_HD FlowScatter scatter(RayRecord<double> const& ray, Vec2d hit, Vec2d mean) const {
    Vec2d const rest = hit - displacement(ray.place, ray.pupil);
    return {ray.flow_weight * dot(rest, rest), ray.flow_weight * dot(hit - mean, hit - mean)};
  }
  /// Where the field is finer than a polynomial can follow, the mean serves as well and is cheaper to integrate.
  /// @param scatter of all rays
  GLADSTONE_HD void settle(Vec2d mean, FlowScatter const& scatter) {
    if (scatter.unexplained <= 0.1 * scatter.square) return;
    terms_ = 1;
    displacement_[0] = mean;
  }

  GLADSTONE_HD Vec2d displacement(Vec2d place, Vec2d pupil) const {
    if (terms_ == 1) return displacement_[0];
    double value[most_terms];
    basis(place, pupil, value);
    Vec2d sum{};
    for (int term = 0; term < terms_; ++term) sum += value[term] * displacement_[term];
    return sum;
  }

  /// Where a ray is expected to arrive on the lens plane, and the pupil point of a ray that arrives there [m].
  GLADSTONE_HD Vec2d arrival(Vec2d pupil, Vec2d place) const {
    return pupil + bend_[0] + (pupil.x / stop_radius_) * bend_[1] + (pupil.y / stop_radius_) * bend_[2] +
           place.x * bend_[3] + place.y * bend_[4];
  }
  GLADSTONE_HD Vec2d pupil_of(Vec2d arrival, Vec2d place) const {
    Vec2d const q = arrival - bend_[0] - place.x * bend_[3] - place.y * bend_[4];
    Jacobian const j = arrival_by_pupil();
    double const scale = 1 / j.determinant();
    return {scale * (j.d * q.x - j.b * q.y), scale * (j.a * q.y - j.c * q.x)};
  }
  /// Pupil area that arrives on a unit of the stop's area.
  GLADSTONE_HD double area_ratio() const { return 1 / arrival_by_pupil().determinant(); }

  /// How far the pupil's rim moves the displacement [px].
  GLADSTONE_HD double pupil_spread() const {
    Vec2d const centre = displacement({}, {});
    double spread = 0;
    for (int quarter = 0; quarter < 4; ++quarter) {
      double const side = quarter < 2 ? stop_radius_ : -stop_radius_;
      Vec2d const rim = quarter % 2 == 0 ? Vec2d{side, 0} : Vec2d{0, side};
      double const moved = length(displacement({}, rim) - centre);
      spread = moved > spread ? moved : spread;
    }
    return spread;
  }

 private:
  bool extended_ = false;
  double stop_radius_ = 1;
  int terms_ = 0;
  int bends_ = 0;
  Vec2d displacement_[most_terms];
  Vec2d bend_[bend_terms];

  GLADSTONE_HD int at(int row, int column) const {
    return row < terms_ ? row * (row + 1) / 2 + column : terms_ * (terms_ + 1) / 2 + (row - terms_) * terms_ + column;
  }
  GLADSTONE_HD double& coefficient(int target, int term) {
    Vec2d& both = target < 2 ? displacement_[term] : bend_[term];
    return target % 2 == 0 ? both.x : both.y;
  }

  GLADSTONE_HD void basis(Vec2d x, Vec2d pupil, double* value) const {
    value[0] = 1;
    if (terms_ == 1) return;
    Vec2d const p = pupil / stop_radius_;
    int n = 1;
    value[n++] = p.x;
    value[n++] = p.y;
    if (extended_) {
      value[n++] = x.x;
      value[n++] = x.y;
    }
    if (terms_ <= bend_terms) return;
    value[n++] = p.x * p.x;
    value[n++] = p.x * p.y;
    value[n++] = p.y * p.y;
    if (!extended_) return;
    value[n++] = x.x * p.x;
    value[n++] = x.x * p.y;
    value[n++] = x.y * p.x;
    value[n++] = x.y * p.y;
    value[n++] = x.x * x.x;
    value[n++] = x.x * x.y;
    value[n++] = x.y * x.y;
    value[n++] = x.x * x.x * x.x;
    value[n++] = x.x * x.x * x.y;
    value[n++] = x.x * x.y * x.y;
    value[n++] = x.y * x.y * x.y;
  }

  /// d arrival / d pupil: [[a, b], [c, d]] and its determinant.
  struct Jacobian {
    double a, b, c, d;
    GLADSTONE_HD double determinant() const { return a * d - b * c; }
  };
  GLADSTONE_HD Jacobian arrival_by_pupil() const {
    return {1 + bend_[1].x / stop_radius_, bend_[2].x / stop_radius_, bend_[1].y / stop_radius_,
            1 + bend_[2].y / stop_radius_};
  }
};

}  // namespace gladstone
