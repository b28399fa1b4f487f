#include "analysis/calibration/plate_placement.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "analysis/calibration/linear_pinhole.h"

namespace gladstone {
namespace {

constexpr double least_gain = 5;         // minimum ratio by which another placement must reduce the residual
constexpr std::size_t most_planes = 6;   // maximum number of planes for the search over orders
constexpr int most_moved = 2;            // maximum index offset [columns, rows]
constexpr double rounding_share = 1e-3;  // residuals below this fraction of the given one count as equal
constexpr double whole_spacing = 0.15;   // tolerance for a drift by whole spacings [spacings]
constexpr double largest_drift = 0.8;    // maximum sine of the drift angle
constexpr double precision_px = 1;       // tolerance of the principal point

bool in_front(PinholeCamera const& camera) { return camera.value.back() > 0; }

Vec2d principal_point(PlateDots const& dots, PlatePlacement const& placement) {
  PinholeCamera const camera = linear_pinhole(dots.points(placement));
  return {camera.cx(), camera.cy()};
}

/// Converts a drift to index offsets; returns nullopt if it is not a whole number of spacings per plane or is zero.
std::optional<PlatePlacement> as_moved_middles(PlateDots const& dots, Vec2d drift) {
  PlatePlacement placement;
  bool any = false;
  for (double const z : dots.z) {
    double const x = drift.x * z / dots.spacing, y = drift.y * z / dots.spacing;
    std::array<int, 2> const whole{static_cast<int>(std::lround(x)), static_cast<int>(std::lround(y))};
    if (std::abs(x - whole[0]) > whole_spacing || std::abs(y - whole[1]) > whole_spacing) return std::nullopt;
    any = any || whole[0] != 0 || whole[1] != 0;
    placement.moved.push_back(whole);
  }
  if (!any) return std::nullopt;
  return placement;
}

}  // namespace

CalibrationPoints PlateDots::points(PlatePlacement const& placement) const {
  CalibrationPoints points;
  points.dot_radius = dot_radius;
  points.lens = lens;
  points.pixel = pixel;
  double const along = std::sqrt(1 - dot(placement.drift, placement.drift));
  for (std::size_t k = 0; k < pixel.size(); ++k) {
    std::size_t const plane = plane_of[k];
    double const way = z[placement.order.empty() ? plane : placement.order[plane]];
    std::array<int, 2> place = index[k];
    if (!placement.moved.empty()) {
      for (std::size_t axis = 0; axis < 2; ++axis) place[axis] += placement.moved[plane][axis];
    }
    points.world.push_back(
        {spacing * place[0] + placement.drift.x * way, spacing * place[1] + placement.drift.y * way, along * way});
  }
  return points;
}

std::optional<std::vector<std::size_t>> find_picture_order(PlateDots const& dots) {
  if (dots.z.size() < 3 || dots.z.size() > most_planes) return std::nullopt;
  PlatePlacement placement;
  placement.order.resize(dots.z.size());
  std::iota(placement.order.begin(), placement.order.end(), std::size_t{0});
  double const given = linear_residual_px(dots.points(placement));
  double least = given;
  std::optional<std::vector<std::size_t>> best;
  while (std::next_permutation(placement.order.begin(), placement.order.end())) {
    CalibrationPoints const points = dots.points(placement);
    double const residual = linear_residual_px(points);
    if (!(residual < least) || !in_front(linear_pinhole(points))) continue;
    least = residual;
    best = placement.order;
  }
  return least_gain * least < given ? best : std::nullopt;
}

std::optional<PlatePlacement> find_moved_middle(PlateDots const& dots, Vec2d principal_point_px) {
  struct Candidate {
    PlatePlacement placement;
    double residual_px;
  };
  double const given = linear_residual_px(dots.points());
  std::vector<Candidate> candidates;
  for (std::size_t plane = 0; plane < dots.z.size(); ++plane) {
    for (int di = -most_moved; di <= most_moved; ++di) {
      for (int dj = -most_moved; dj <= most_moved; ++dj) {
        PlatePlacement placement;
        placement.moved.resize(dots.z.size());
        placement.moved[plane] = {di, dj};
        double const residual = linear_residual_px(dots.points(placement));
        if (least_gain * residual < given) candidates.push_back({std::move(placement), residual});
      }
    }
  }
  if (candidates.empty()) return std::nullopt;
  auto const by_residual = [](Candidate const& a, Candidate const& b) { return a.residual_px < b.residual_px; };
  double const least = std::min_element(candidates.begin(), candidates.end(), by_residual)->residual_px;
  double const as_good = std::max(2 * least, rounding_share * given);
  std::erase_if(candidates, [as_good](Candidate const& candidate) { return candidate.residual_px > as_good; });
  auto const off = [&](Candidate const& candidate) {
    return length(principal_point(dots, candidate.placement) - principal_point_px);
  };
  return std::min_element(candidates.begin(), candidates.end(),
                          [&off](Candidate const& a, Candidate const& b) { return off(a) < off(b); })
      ->placement;
}

std::optional<PlatePlacement> find_drift(PlateDots const& dots, Vec2d principal_point_px) {
  constexpr int most_steps = 50;
  constexpr double probe = 1e-4;
  PlatePlacement placement;
  Vec2d& drift = placement.drift;
  for (int step = 0; step < most_steps; ++step) {
    Vec2d const off = principal_point(dots, placement) - principal_point_px;
    if (length(off) < precision_px) {
      auto moved = as_moved_middles(dots, drift);
      return moved ? moved : placement;
    }
    auto const slope = [&](Vec2d by) {
      PlatePlacement probed = placement;
      probed.drift += by;
      return (principal_point(dots, probed) - principal_point_px - off) / probe;
    };
    Vec2d const x = slope({probe, 0}), y = slope({0, probe});
    double const area = x.x * y.y - x.y * y.x;
    if (!(std::abs(area) > 0)) return std::nullopt;
    // Newton step, limited to 0.2 so that the direction remains towards the plate.
    Vec2d by = {-(off.x * y.y - off.y * y.x) / area, -(x.x * off.y - x.y * off.x) / area};
    if (double const size = length(by); size > 0.2) by *= 0.2 / size;
    drift += by;
    if (!(length(drift) < largest_drift)) return std::nullopt;
  }
  return std::nullopt;
}

}  // namespace gladstone
