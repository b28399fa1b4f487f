#include "analysis/calibration/grid_assignment.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <queue>
#include <utility>

#include "analysis/calibration/grid_smoothness.h"
#include "render/base/median.h"

namespace gladstone::inline calibration {
namespace {

// maximum distance of a neighbour from its predicted position, relative to the distance between neighbours
constexpr double reach = 0.3;

/// Image vectors from a dot to its neighbours along X and Y [px].
struct Steps {
  Vec2d x, y;
};

using Places = std::map<std::pair<int, int>, std::size_t>;

double length2(Vec2d v) { return dot(v, v); }

/// Start of the search: dot with index (0, 0) and the steps to its neighbours.
struct Beginning {
  std::size_t dot;
  Steps steps;
};

std::size_t nearest_to(std::vector<DetectedDot> const& dots, Vec2d at) {
  auto const nearer = [at](DetectedDot const& a, DetectedDot const& b) {
    return length2(a.centre_px - at) < length2(b.centre_px - at);
  };
  return static_cast<std::size_t>(std::min_element(dots.begin(), dots.end(), nearer) - dots.begin());
}

/// Returns the vector from a dot to its nearest neighbour within 45 degrees of a direction.
std::optional<Vec2d> first_step(std::vector<DetectedDot> const& dots, std::size_t from, Vec2d direction) {
  std::optional<Vec2d> nearest;
  for (std::size_t k = 0; k < dots.size(); ++k) {
    Vec2d const step = dots[k].centre_px - dots[from].centre_px;
    double const along = dot(step, direction);
    if (k == from || !(along > 0) || !(2 * along * along >= length2(step) * length2(direction))) continue;
    if (!nearest || length2(step) < length2(*nearest)) nearest = step;
  }
  return nearest;
}

/// Chooses the start among the dots nearest to the centroid: the dot whose steps are closest to the median steps, which
/// is robust to missing neighbours and spurious spots.
std::optional<Beginning> begin(std::vector<DetectedDot> const& dots, ExpectedView const& expected) {
  constexpr std::size_t most = 25;  // maximum number of dots that are examined, as in a square of five by five
  Vec2d middle{};
  for (DetectedDot const& dot : dots) middle += dot.centre_px / static_cast<double>(dots.size());
  std::vector<std::size_t> order(dots.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return length2(dots[a].centre_px - middle) < length2(dots[b].centre_px - middle);
  });
  std::vector<Beginning> candidates;
  for (std::size_t k = 0; k < std::min(most, order.size()); ++k) {
    auto const x = first_step(dots, order[k], expected.along_x_px), y = first_step(dots, order[k], expected.along_y_px);
    if (x && y) candidates.push_back({order[k], {*x, *y}});
  }
  if (candidates.empty()) return std::nullopt;
  auto const middle_of = [&candidates](auto const& component) {
    std::vector<double> values;
    for (Beginning const& candidate : candidates) values.push_back(component(candidate.steps));
    return upper_median(std::move(values));
  };
  Vec2d const x{middle_of([](Steps const& s) { return s.x.x; }), middle_of([](Steps const& s) { return s.x.y; })};
  Vec2d const y{middle_of([](Steps const& s) { return s.y.x; }), middle_of([](Steps const& s) { return s.y.y; })};
  auto const off = [&](Beginning const& candidate) {
    return length2(candidate.steps.x - x) + length2(candidate.steps.y - y);
  };
  return *std::min_element(candidates.begin(), candidates.end(),
                           [&off](Beginning const& a, Beginning const& b) { return off(a) < off(b); });
}

/// Assigns grid indices, relative to the start of the search, by proceeding from each dot to its neighbours.
Places spread(std::vector<DetectedDot> const& dots, Beginning const& beginning) {
  Places places{{{0, 0}, beginning.dot}};
  std::vector<bool> taken(dots.size());
  taken[beginning.dot] = true;
  struct Open {
    int i, j;
    Steps steps;
  };
  std::queue<Open> open;
  open.push({0, 0, beginning.steps});
  while (!open.empty()) {
    Open const here = open.front();
    open.pop();
    Vec2d const at = dots[places.at({here.i, here.j})].centre_px;
    for (int k = 0; k < 4; ++k) {
      int const di = k == 0 ? 1 : k == 1 ? -1 : 0, dj = k == 2 ? 1 : k == 3 ? -1 : 0;
      std::pair<int, int> const place{here.i + di, here.j + dj};
      if (places.contains(place)) continue;
      Vec2d const step = static_cast<double>(di + dj) * (di != 0 ? here.steps.x : here.steps.y);
      std::size_t const found = nearest_to(dots, at + step);
      Vec2d const made = dots[found].centre_px - at;
      if (taken[found] || length2(made - step) > reach * reach * length2(step)) continue;
      taken[found] = true;
      places[place] = found;
      Steps next = here.steps;
      (di != 0 ? next.x : next.y) = static_cast<double>(di + dj) * made;
      open.push({place.first, place.second, next});
    }
  }
  return places;
}

/// Range of occupied columns and rows.
struct Span {
  int left = std::numeric_limits<int>::max(), right = std::numeric_limits<int>::min();
  int low = left, high = right;
};

Span find_span(Places const& places) {
  Span span;
  for (auto const& [place, dot] : places) {
    span = {std::min(span.left, place.first), std::max(span.right, place.first), std::min(span.low, place.second),
            std::max(span.high, place.second)};
  }
  return span;
}

/// Fractional grid index [spacings].
struct GridPoint {
  double i, j;
};

/// Returns the fractional grid index of a pixel by linear extrapolation from the nearest dot.
GridPoint point_at(std::vector<DetectedDot> const& dots, Places const& places, Vec2d pixel, Steps const& first) {
  auto nearest = places.begin();
  for (auto place = places.begin(); place != places.end(); ++place) {
    if (length2(dots[place->second].centre_px - pixel) < length2(dots[nearest->second].centre_px - pixel))
      nearest = place;
  }
  int const i = nearest->first.first, j = nearest->first.second;  // clang 14 cannot capture structured bindings
  Vec2d const at = dots[nearest->second].centre_px;
  auto const step = [&](int di, int dj, Vec2d otherwise) {
    if (auto const next = places.find({i + di, j + dj}); next != places.end()) return dots[next->second].centre_px - at;
    if (auto const last = places.find({i - di, j - dj}); last != places.end()) return at - dots[last->second].centre_px;
    return otherwise;
  };
  Vec2d const x = step(1, 0, first.x), y = step(0, 1, first.y), way = pixel - at;
  double const area = x.x * y.y - x.y * y.x;
  return {i + (way.x * y.y - way.y * y.x) / area, j + (x.x * way.y - x.y * way.x) / area};
}

/// Removes the indices of spots that do not belong to the grid.
/// @return removed spots and smoothness of the remaining grid
SmoothGrid clean(std::vector<DetectedDot> const& dots, Places& places) {
  std::vector<GridDot> all;
  for (auto const& [place, dot] : places) {
    all.push_back({place.first, place.second, dots[dot].centre_px, dots[dot].diameter_px});
  }
  SmoothGrid grid = remove_inconsistent_spots(std::move(all));
  Places kept;
  for (GridDot const& dot : grid.dots) kept[{dot.i, dot.j}] = places.at({dot.i, dot.j});
  places = std::move(kept);
  return grid;
}

}  // namespace

AssignedDots assign_to_grid(std::vector<DetectedDot> const& dots, CalibrationGrid const& grid,
                            ExpectedView const& expected) {
  AssignedDots assigned;
  if (dots.size() < 3) return assigned;
  std::optional<Beginning> const beginning = begin(dots, expected);
  if (!beginning) return assigned;
  Places places = spread(dots, *beginning);
  SmoothGrid smooth = clean(dots, places);
  if (places.empty()) return assigned;
  Span const span = find_span(places);
  assigned.columns = span.right - span.left + 1;
  assigned.rows = span.high - span.low + 1;
  assigned.strangers = std::move(smooth.strangers);
  assigned.smoothness_px = smooth.rms_px;
  bool const all_columns = assigned.columns == 2 * grid.half_columns + 1;
  bool const all_rows = assigned.rows == 2 * grid.half_rows + 1;
  std::pair<int, int> origin{span.left + grid.half_columns, span.low + grid.half_rows};
  if (!all_columns || !all_rows) {
    assigned.middle_by = CentreDotMethod::expected_view;
    GridPoint const middle = point_at(dots, places, expected.middle_px, beginning->steps);
    auto const choose = [&assigned](double point, int& place) {
      place = static_cast<int>(std::lround(point));
      assigned.middle_offset = std::max(assigned.middle_offset, std::abs(point - place));
    };
    if (!all_columns) choose(middle.i, origin.first);
    if (!all_rows) choose(middle.j, origin.second);
  }
  for (GridDot dot : smooth.dots) {
    dot.i -= origin.first;
    dot.j -= origin.second;
    if (std::abs(dot.i) <= grid.half_columns && std::abs(dot.j) <= grid.half_rows) assigned.dots.push_back(dot);
  }
  return assigned;
}

}  // namespace gladstone::inline calibration
