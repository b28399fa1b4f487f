#pragma once

#include "render/focused_dots/cone_moments.h"
#include "render/scene/truth_error.h"

/// Standard errors of a dot's displacement where a deflection table has a say in it.
namespace gladstone {

/// What some of a dot's rays come to.
struct DotSums : RaySums {
  TableCheck check;  ///< where the deflection table covers the dot

  GLADSTONE_HD DotSums& operator+=(DotSums const& o) {
    RaySums::operator+=(o);
    check += o.check;
    return *this;
  }
};

/// Squares of standard errors, by component [px^2].
struct DotErrors : TruthErrors {
  Vec2d table2;  ///< of the integral over the cone that the rays correct: what their choice makes of it
  Vec2d miss2;   ///< variance from ray to ray of what the table is off by
};

/// As truth_errors().
GLADSTONE_HD inline DotErrors dot_errors(DotSums const* of, int scramblings, DotSums const& all) {
  TableCheck const& check = all.check;
  Vec2d const miss = (check.traced - check.expected) / check.weight;
  Vec2d table2{};
  for (int i = 0; i < scramblings; ++i) {
    TableCheck const& here = of[i].check;
    table2 += squares_of((here.traced - here.expected - here.weight * miss) / check.weight);
  }
  // the stop's smoothed edge lets some weights be negative, and so a variance of little but these
  Vec2d const miss2 = check.miss2 / check.weight - squares_of(miss);
  return {truth_errors(of, scramblings, all),
          error2_factor(scramblings) * table2,
          {miss2.x > 0 ? miss2.x : 0, miss2.y > 0 ? miss2.y : 0}};
}

}  // namespace gladstone
