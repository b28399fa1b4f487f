#pragma once

#include "render/base/host_device.h"
#include "render/sensor/diffraction_spot.h"

namespace gladstone::inline focused_dots {

/// Computes the PSF factors of some points along both axes, like GaussianSpot::taylor_shares(), by a group of lanes. On
/// a device, eight lanes process one axis of a point: they integrate the PSF up to the pixel edges, and the factor of a
/// pixel is the difference between its two edges. On the CPU, a single lane processes whole vectors of pixels.
/// @param at_point  returns the position of the i-th point [px]
/// @param room  output: factors [point][axis][order][pitch]; on a single lane with zeros beyond the last pixel of the
/// PSF
/// @param pitch  width of the PSF plus one, or the number of pixels that a lane processes together
/// @param apart  stride between the points in `room`
template <int orders, class Group, class Place>
GLADSTONE_HD void spot_factors(Group const& group, GaussianSpot<double> const& spot, Place const& at_point, int points,
                               int pitch, int apart, double* room) {
  using Spot = GaussianSpot<double>;
  auto const eight = group.eight();
  int const width = 2 * spot.half_width() + 1;
  double const per_sigma = 1 / spot.sigma;
  for (int task = eight.index(); task < 2 * points; task += eight.count()) {
    Vec2d const at = at_point(task / 2);
    Footprint const reach = spot.footprint(at);
    double const p = task % 2 == 0 ? at.x : at.y;
    int const first = task % 2 == 0 ? reach.column : reach.row;
    double* const out = room + task / 2 * apart + task % 2 * orders * pitch;
    if constexpr (Group::alone) {
      double shares[orders * Spot::most_width];
      spot.taylor_shares(p, first, width, orders - 1, shares);
      for (int k = 0; k < orders; ++k) {
        for (int i = 0; i < pitch; ++i) out[k * pitch + i] = i < width ? shares[k * width + i] : 0.0;
      }
    } else {
      for (int edge = eight.lane(); edge <= width; edge += eight.size()) {
        double const t = (first - p + edge - 0.5) * per_sigma;
        Spot::EdgeTerms const terms(t, per_sigma);
        out[edge] = Spot::edge_value(t);
        for (int k = 1; k < orders; ++k) out[k * pitch + edge] = terms.of[k];
      }
    }
  }
  group.sync();
  if constexpr (!Group::alone) {
    for (int task = group.lane(); task < points * 2 * orders; task += group.size()) {
      double* const factors = room + task / (2 * orders) * apart + task % (2 * orders) * pitch;
      double before = factors[0];
      for (int i = 0; i < width; ++i) {
        double const next = factors[i + 1];
        factors[i] = next - before;
        before = next;
      }
    }
    group.sync();
  }
}

}  // namespace gladstone::inline focused_dots
