#include "analysis/uncertainty/particle_pairs.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "render/base/median.h"

namespace gladstone::inline uncertainty {
namespace {

/// Half width of the square of pixels around a dot's maximum in which the frames are compared [px]: covers dots of up
/// to 5 px.
constexpr int reach = 2;

/// Returns whether a frame has a positive maximum at a distance of at most one pixel from (i, j) along each axis.
bool has_dot(MatchedWindow const& w, std::vector<float> const& frame, int i, int j) {
  int x = i, y = j;
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx)
      if (frame[w.at(i + dx, j + dy)] > frame[w.at(x, y)]) {
        x = i + dx;
        y = j + dy;
      }
  float const centre = frame[w.at(x, y)];
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx)
      if (frame[w.at(x + dx, y + dy)] > centre) return false;
  return centre > 0.0f;
}

/// Returns the disparity of a dot at (i, j): the shift from frame A to frame B that minimises the sum of squared
/// differences of the surrounding pixels, to first order. Light of neighbouring dots, present in both frames, does not
/// contribute if the frames are equal. Returns nullopt if noise dominates the gradients or the disparity exceeds 1 px.
std::optional<Vec2d> disparity_of_dot(MatchedWindow const& w, int i, int j) {
  auto const slope = [&](std::vector<float> const& frame, int x, int y) {
    return 0.5 * Vec2d{frame[w.at(x + 1, y)] - frame[w.at(x - 1, y)], frame[w.at(x, y + 1)] - frame[w.at(x, y - 1)]};
  };
  auto const difference = [&](int x, int y) { return w.reference[w.at(x, y)] - w.flow[w.at(x, y)]; };
  double xx = 0.0, xy = 0.0, yy = 0.0, by_x = 0.0, by_y = 0.0;
  for (int y = j - reach; y <= j + reach; ++y)
    for (int x = i - reach; x <= i + reach; ++x) {
      // Multiply gradients of different frames: the squared gradient of one frame contains its squared noise, the
      // product does not.
      Vec2d const a = slope(w.reference, x, y), b = slope(w.flow, x, y);
      xx += a.x * b.x;
      xy += 0.5 * (a.x * b.y + a.y * b.x);
      yy += a.y * b.y;
      // A central difference over two pixels is the derivative averaged over these pixels, so the difference between
      // the frames is averaged in the same way (Simpson's rule).
      double const here = 4.0 * difference(x, y);
      by_x += 0.5 * (a.x + b.x) * (difference(x - 1, y) + here + difference(x + 1, y)) / 6.0;
      by_y += 0.5 * (a.y + b.y) * (difference(x, y - 1) + here + difference(x, y + 1)) / 6.0;
    }
  double const determinant = xx * yy - xy * xy;
  if (!(xx > 0.0 && yy > 0.0 && determinant > 0.01 * xx * yy)) return std::nullopt;
  Vec2d const disparity{(yy * by_x - xy * by_y) / determinant, (xx * by_y - xy * by_x) / determinant};
  bool const small = std::abs(disparity.x) <= 1.0 && std::abs(disparity.y) <= 1.0;
  return small ? std::optional(disparity) : std::nullopt;
}

}  // namespace

void find_particle_pairs(MatchedWindow const& w, std::vector<ParticleImagePair>& pairs) {
  pairs.clear();
  auto const product = [&](int i, int j) {
    float const a = w.reference[w.at(i, j)], b = w.flow[w.at(i, j)];
    return a > 0.0f && b > 0.0f ? a * b : 0.0f;
  };
  constexpr int margin = reach + 1;
  for (int j = margin; j + margin < w.side; ++j)
    for (int i = margin; i + margin < w.side; ++i) {
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
      if (!has_dot(w, w.reference, i, j) || !has_dot(w, w.flow, i, j)) continue;
      std::optional<Vec2d> const disparity = disparity_of_dot(w, i, j);
      if (!disparity) continue;
      double const weight = w.weight[w.at(i, j)];
      pairs.push_back({*disparity, static_cast<double>(here) * weight * weight});
    }
}

void remove_mismatched_pairs(std::vector<ParticleImagePair>& pairs) {
  if (pairs.size() < 3) return;
  std::vector<double> values(pairs.size());
  Vec2d centre, most;
  for (double Vec2d::*axis : {&Vec2d::x, &Vec2d::y}) {
    std::transform(pairs.begin(), pairs.end(), values.begin(), [&](auto const& p) { return p.disparity.*axis; });
    double const middle = centre.*axis = upper_median(values);
    std::transform(pairs.begin(), pairs.end(), values.begin(),
                   [&](auto const& p) { return std::abs(p.disparity.*axis - middle); });
    most.*axis = 3.5 * sigma_per_median_deviation * upper_median(values);
  }
  std::erase_if(pairs, [&](ParticleImagePair const& p) {
    return std::abs(p.disparity.x - centre.x) > most.x || std::abs(p.disparity.y - centre.y) > most.y;
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

}  // namespace gladstone::inline uncertainty
