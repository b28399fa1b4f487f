#include "analysis/calibration/plate_placement.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "analysis/calibration/linear_pinhole.h"

namespace gladstone::inline calibration {
namespace {

constexpr double least_gain = 5;        // minimum ratio by which another placement must reduce the residual
constexpr std::size_t most_planes = 6;  // maximum number of planes for the searches over orders and pairs of planes
constexpr int most_moved = 2;           // maximum change of one plane's index offset in a search step [columns, rows]
constexpr double step_gain = 0.9;       // maximum ratio of the residuals after and before a step of the search
constexpr double rounding_px = 1e-6;    // residual below which a fit counts as exact [px]
constexpr double whole_spacing = 0.15;  // tolerance for offsets by whole spacings [spacings]
constexpr double largest_drift = 0.8;   // maximum sine of the drift angle
constexpr double precision_px = 1;      // tolerance for the position of the principal point [px]

using Moves = std::vector<std::array<int, 2>>;  // offset of the dot indices of each plane (column, row)

bool in_front(PinholeCamera const& camera) { return camera.value.back() > 0; }

double residual_of(PlateDots const& dots, Moves const& moves) {
  PlatePlacement placement;
  placement.moved = moves;
  return linear_residual_px(dots.points(placement));
}

Vec2d principal_point(CalibrationPoints const& points) {
  PinholeCamera const camera = linear_pinhole(points);
  return {camera.cx(), camera.cy()};
}

/// Solves f(x) = target for a map of the plane by Newton's method, starting at 0, to within precision_px.
/// @return nullopt if the iteration does not converge or |x| reaches largest_drift
template <class Map>
std::optional<Vec2d> solve(Map const& f, Vec2d target) {
  constexpr int max_step_count = 50;
  constexpr double probe = 1e-4;
  Vec2d at{};
  for (int step = 0; step < max_step_count; ++step) {
    Vec2d const off = f(at) - target;
    if (length(off) < precision_px) return at;
    Vec2d const x = (f(at + Vec2d{probe, 0}) - target - off) / probe;
    Vec2d const y = (f(at + Vec2d{0, probe}) - target - off) / probe;
    double const area = x.x * y.y - x.y * y.x;
    if (!(std::abs(area) > 0)) return std::nullopt;
    // The Newton step is limited to 0.2, so that the drift direction continues to point towards the plate.
    Vec2d by = {-(off.x * y.y - off.y * y.x) / area, -(x.x * off.y - x.y * off.x) / area};
    if (double const size = length(by); size > 0.2) by *= 0.2 / size;
    at += by;
    if (!(length(at) < largest_drift)) return std::nullopt;
  }
  return std::nullopt;
}

/// Finds the index offsets, proportional to Z, that bring the principal point to its expected position. Offsets
/// proportional to Z do not change the residuals.
/// @param moved  offsets of the planes before this correction; empty: none
/// @return sum of `moved` and the found offsets; nullopt if the latter are not whole numbers or are zero
std::optional<Moves> find_whole_drift(PlateDots const& dots, Moves const& moved, Vec2d principal_point_px) {
  PlatePlacement placement;
  placement.moved = moved;
  CalibrationPoints const given = dots.points(placement);
  // Index offsets displace the dots of a plane within the plane; unlike a drift, they do not change its Z.
  auto const shear = solve(
      [&given](Vec2d by) {
        CalibrationPoints points = given;
        for (Vec3d& point : points.world) point += Vec3d{by.x * point.z, by.y * point.z, 0};
        return principal_point(points);
      },
      principal_point_px);
  if (!shear) return std::nullopt;
  Moves moves = moved;
  moves.resize(dots.z.size());
  bool any = false;
  for (std::size_t plane = 0; plane < moves.size(); ++plane) {
    double const x = shear->x * dots.z[plane] / dots.spacing, y = shear->y * dots.z[plane] / dots.spacing;
    std::array<int, 2> const whole{static_cast<int>(std::lround(x)), static_cast<int>(std::lround(y))};
    if (std::abs(x - whole[0]) > whole_spacing || std::abs(y - whole[1]) > whole_spacing) return std::nullopt;
    any = any || whole[0] != 0 || whole[1] != 0;
    for (std::size_t axis = 0; axis < 2; ++axis) moves[plane][axis] += whole[axis];
  }
  if (!any) return std::nullopt;
  return moves;
}

/// Offsets with their residual [px].
struct Fit {
  Moves moves;
  double residual_px;
};

/// Returns the best fit in which the offset of one plane differs from the given ones.
Fit move_one(PlateDots const& dots, Fit const& given) {
  Fit best = given;
  for (std::size_t plane = 0; plane < dots.z.size(); ++plane) {
    for (int di = -most_moved; di <= most_moved; ++di) {
      for (int dj = -most_moved; dj <= most_moved; ++dj) {
        Moves moves = given.moves;
        moves[plane] = {moves[plane][0] + di, moves[plane][1] + dj};
        double const residual = residual_of(dots, moves);
        if (residual < best.residual_px) best = {std::move(moves), residual};
      }
    }
  }
  return best;
}

/// Returns the best fit in which the offsets of two planes differ from the given ones by at most one column and row.
Fit move_two(PlateDots const& dots, Fit const& given) {
  constexpr int choices = 3 * 3 * 3 * 3;
  Fit best = given;
  if (dots.z.size() > most_planes) return best;
  for (std::size_t a = 0; a < dots.z.size(); ++a) {
    for (std::size_t b = a + 1; b < dots.z.size(); ++b) {
      for (int choice = 0; choice < choices; ++choice) {
        Moves moves = given.moves;
        moves[a] = {moves[a][0] + choice % 3 - 1, moves[a][1] + choice / 3 % 3 - 1};
        moves[b] = {moves[b][0] + choice / 9 % 3 - 1, moves[b][1] + choice / 27 - 1};
        double const residual = residual_of(dots, moves);
        if (residual < best.residual_px) best = {std::move(moves), residual};
      }
    }
  }
  return best;
}

/// Adds a constant to all offsets so that the sum of their absolute values is smallest; a common offset does not change
/// the camera.
void shift_to_smallest(Moves& moves) {
  for (std::size_t axis = 0; axis < 2; ++axis) {
    std::vector<int> sorted;
    for (std::array<int, 2> const& by : moves) sorted.push_back(by[axis]);
    std::sort(sorted.begin(), sorted.end());
    int const low = sorted[(sorted.size() - 1) / 2], high = sorted[sorted.size() / 2];
    // every value from `low` to `high` minimises the sum; that nearest to zero is chosen
    int const shift = std::clamp(0, low, high);
    for (std::array<int, 2>& by : moves) by[axis] -= shift;
  }
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

std::optional<std::vector<std::size_t>> find_image_order(PlateDots const& dots) {
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

std::optional<PlatePlacement> find_misidentified_centres(PlateDots const& dots, Vec2d principal_point_px) {
  Fit const given{Moves(dots.z.size()), linear_residual_px(dots.points())};
  Fit best = given;
  while (best.residual_px > rounding_px) {
    Fit next = move_one(dots, best);
    if (!(next.residual_px < step_gain * best.residual_px)) next = move_two(dots, best);
    if (!(next.residual_px < step_gain * best.residual_px)) break;
    best = std::move(next);
  }
  if (!(least_gain * best.residual_px < given.residual_px)) return std::nullopt;
  if (auto const drifted = find_whole_drift(dots, best.moves, principal_point_px)) best.moves = *drifted;
  shift_to_smallest(best.moves);
  PlatePlacement placement;
  placement.moved = std::move(best.moves);
  return placement;
}

std::optional<PlatePlacement> find_drift(PlateDots const& dots, Vec2d principal_point_px) {
  PlatePlacement placement;
  if (auto const moved = find_whole_drift(dots, {}, principal_point_px)) {
    placement.moved = *moved;
    return placement;
  }
  auto const drift = solve(
      [&dots](Vec2d by) {
        PlatePlacement drifted;
        drifted.drift = by;
        return principal_point(dots.points(drifted));
      },
      principal_point_px);
  if (!drift) return std::nullopt;
  placement.drift = *drift;
  return placement;
}

}  // namespace gladstone::inline calibration
