#pragma once

#include "render/base/host_device.h"
#include "render/base/vec.h"

/// Distribution of displacements over a dot's light cone, and its variation over the area of the dot.
namespace gladstone::inline focused_dots {

/// Moments of a distribution of displacements about an origin up to fourth order: sums of weight x^a y^b.
struct DisplacementMoments {
  static constexpr int order = 4;
  static constexpr int count = 15;
  double of[count] = {};

  /// Returns the index of the moment of x^a y^b: sorted by total order, then by the power of y.
  GLADSTONE_HD static constexpr int at(int a, int b) { return (a + b) * (a + b + 1) / 2 + b; }

  /// Returns the total order of the moment with this index.
  GLADSTONE_HD static constexpr int total_order(int moment) {
    return (moment > 0) + (moment > 2) + (moment > 5) + (moment > 9);
  }

  /// Returns the sum of weight (x^2 + y^2).
  GLADSTONE_HD double square() const { return of[at(2, 0)] + of[at(0, 2)]; }

  GLADSTONE_HD void add(double weight, Vec2d d) {
    double x = weight;
    for (int a = 0; a <= order; ++a, x *= d.x) {
      double both = x;
      for (int b = 0; a + b <= order; ++b, both *= d.y) of[at(a, b)] += both;
    }
  }
};

/// Points on a source at which its cone is integrated, and the linear map from the results to a quadratic polynomial of
/// the position on the source.
struct PlaceRule {
  static constexpr int terms = 6;  ///< terms of the polynomial: 1, x, y, x^2, x y, y^2
  static constexpr int max_positions = 9;
  int count = 0;
  Vec2d places[max_positions];  ///< points in units of the half size, y downwards
  double weights[max_positions];
  double fit[terms][max_positions];  ///< weights of the least-squares fit: a term's coefficient is the sum of its
                                     ///< weights times the values at the points

  GLADSTONE_HD static void basis(Vec2d place, double (&value)[terms]) {
    value[0] = 1;
    value[1] = place.x;
    value[2] = place.y;
    value[3] = place.x * place.x;
    value[4] = place.x * place.y;
    value[5] = place.y * place.y;
  }
};

/// Moments as a quadratic polynomial of the position on the source.
struct MomentField {
  double coefficient[DisplacementMoments::count][PlaceRule::terms];

  /// Computes one coefficient of the polynomial of a moment.
  /// @param moments  moments at the points of the rule
  GLADSTONE_HD static double fitted(PlaceRule const& rule, DisplacementMoments const* moments, int moment, int term) {
    double sum = 0;
    for (int place = 0; place < rule.count; ++place) sum += rule.fit[term][place] * moments[place].of[moment];
    return sum;
  }
  /// Returns a moment at a position on the source.
  GLADSTONE_HD double value(int moment, Vec2d place) const {
    double basis[PlaceRule::terms];
    PlaceRule::basis(place, basis);
    double sum = 0;
    for (int term = 0; term < PlaceRule::terms; ++term) sum += basis[term] * coefficient[moment][term];
    return sum;
  }
};

}  // namespace gladstone::inline focused_dots
