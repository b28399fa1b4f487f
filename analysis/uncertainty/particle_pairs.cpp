#include "analysis/uncertainty/particle_pairs.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "analysis/correlation/subpixel_peak.h"

namespace gladstone {
namespace {

/// The place of a frame's maximum at most a pixel from (i, j); nothing where there is none.
std::optional<Vec2d> place_of_dot(MatchedWindow const& w, std::vector<float> const& frame, int i, int j) {
  int x = i, y = j;
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx)
      if (frame[w.at(i + dx, j + dy)] > frame[w.at(x, y)]) {
        x = i + dx;
        y = j + dy;
      }
  if (x < 1 || y < 1 || x + 1 >= w.side || y + 1 >= w.side) return std::nullopt;
  float const centre = frame[w.at(x, y)];
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx)
      if (frame[w.at(x + dx, y + dy)] > centre) return std::nullopt;
  if (!(centre > 0.0f)) return std::nullopt;
  auto const along = [&](int dx, int dy) {
    return gaussian_peak<double>(frame[w.at(x - dx, y - dy)], centre, frame[w.at(x + dx, y + dy)]).offset;
  };
  return Vec2d{x + along(1, 0), y + along(0, 1)};
}

}  // namespace

void find_particle_pairs(MatchedWindow const& w, std::vector<ParticleImagePair>& pairs) {
  pairs.clear();
  auto const product = [&](int i, int j) {
    float const a = w.reference[w.at(i, j)], b = w.flow[w.at(i, j)];
    return a > 0.0f && b > 0.0f ? a * b : 0.0f;
  };
  for (int j = 2; j + 2 < w.side; ++j)
    for (int i = 2; i + 2 < w.side; ++i) {
      float const here = product(i, j);
      if (!(here > 0.0f)) continue;
      bool highest = true;
      for (int dy = -1; dy <= 1 && highest; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
          bool const before = dy < 0 || (dy == 0 && dx < 0);
          float const other = product(i + dx, j + dy);
          if ((dx != 0 || dy != 0) && (other > here || (before && other == here))) highest = false;
        }
      if (!highest) continue;
      std::optional<Vec2d> const a = place_of_dot(w, w.reference, i, j), b = place_of_dot(w, w.flow, i, j);
      if (!a || !b) continue;
      double const weight = w.weight[w.at(i, j)];
      pairs.push_back({*b - *a, static_cast<double>(here) * weight * weight});
    }
}

void leave_out_mismatches(std::vector<ParticleImagePair>& pairs) {
  if (pairs.size() < 3) return;
  std::vector<double> values(pairs.size());
  auto const median = [&] {
    auto const middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
  };
  Vec2d centre, reach;
  for (double Vec2d::*axis : {&Vec2d::x, &Vec2d::y}) {
    std::transform(pairs.begin(), pairs.end(), values.begin(), [&](auto const& p) { return p.disparity.*axis; });
    double const middle = centre.*axis = median();
    std::transform(pairs.begin(), pairs.end(), values.begin(),
                   [&](auto const& p) { return std::abs(p.disparity.*axis - middle); });
    reach.*axis = 2.5 * 1.4826 * median();
  }
  std::erase_if(pairs, [&](ParticleImagePair const& p) {
    return std::abs(p.disparity.x - centre.x) > reach.x || std::abs(p.disparity.y - centre.y) > reach.y;
  });
}

double effective_number(std::vector<ParticleImagePair> const& pairs) {
  double sum = 0.0, squares = 0.0;
  for (ParticleImagePair const& pair : pairs) {
    sum += pair.weight;
    squares += pair.weight * pair.weight;
  }
  return squares > 0.0 ? sum * sum / squares : 0.0;
}

}  // namespace gladstone
