#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "render/base/ray.h"
#include "render/base/vec.h"

namespace gladstone {

/// Weighted sums of one dot's hits in one frame, about an origin near them so that no digits are lost.
template <class T>
struct CentroidSum {
  T weight{};
  Vec2<T> first{};
  Vec2<T> second{};
  std::int64_t count = 0;

  GLADSTONE_HD void add(Vec2<T> p, T w, bool counts) {
    weight += w;
    first += w * p;
    second += Vec2<T>{w * p.x * p.x, w * p.y * p.y};
    count += counts ? 1 : 0;
  }
  GLADSTONE_HD CentroidSum& operator+=(CentroidSum const& o) {
    weight += o.weight;
    first += o.first;
    second += o.second;
    count += o.count;
    return *this;
  }
  GLADSTONE_HD Vec2<T> mean() const { return first / weight; }
  Vec2<T> deviation() const {
    using std::sqrt;
    Vec2<T> const m = mean();
    T const x = second.x / weight - m.x * m.x;
    T const y = second.y / weight - m.y * m.y;
    return {x > T(0) ? sqrt(x) : T(0), y > T(0) ? sqrt(y) : T(0)};
  }
};

/// What a dot's truth was made from.
enum class TruthPath : int {
  rays,   ///< the centroids of its rays
  table,  ///< the integral of a deflection table over its cone, which its rays correct
};

/// A dot's truth in numbers, on whichever device they were made.
struct DotTruth {
  Vec2d origin;  ///< that the sums' places count from [px]
  CentroidSum<double> hits[2];
  Vec2d error;  ///< standard error of the displacement [px]
  TruthPath path = TruthPath::rays;
};

/// What a camera sees of particles beside GroundTruth, whose reference is the first pulse and whose flow the second.
struct ParticleTruth {
  std::vector<Vec3d> second_m;                 ///< where they are at the second pulse [m]
  std::vector<double> diameter_m;              ///< [m]
  std::vector<Vec2d> reference_ambient_px;     ///< as GroundTruth::reference_px, without the medium
  std::vector<Vec2d> displacement_ambient_px;  ///< as GroundTruth::displacement_px, without the medium
};

/// What a camera sees of every dot (ray truth), and what theory says of it; all in px, flow minus reference.
struct GroundTruth {
  std::vector<Vec3d> position_m;
  std::vector<Vec2d> reference_px;     ///< radiance-weighted centroid of the rays that pass the stop; NaN: none does
  std::vector<Vec2d> displacement_px;  ///< flow centroid minus reference centroid
  std::vector<Vec2d> displacement_error_px;  ///< standard error of displacement_px; NaN: unknown (truth_error.h)
  std::vector<Vec2d> displacement_std_px;    ///< weighted standard deviation of the flow hits
  std::vector<Vec2d> flux;  ///< light in the reference (x) and the flow (y) frame [fully lit px]; of particles photons
  std::vector<std::array<std::int64_t, 2>> rays;  ///< counted in each frame
  std::vector<std::int64_t> rays_planned;         ///< that it was to have
  std::vector<Vec2d> eq9_px;                      ///< Rajendran et al. eq. 9 along the chief ray, lever Z_D
  std::vector<Vec2d> chief_px;                    ///< the same with each slice's own lever
  std::vector<Vec2d> eq9_cone_px;                 ///< averaged over the disc and the stop's pupil, own levers
  std::vector<TruthPath> path;                    ///< that displacement_px came by
  ParticleTruth particles;                        ///< empty for dots

  std::size_t size() const { return position_m.size(); }
  void resize(std::size_t count);
  /// Writes what another truth says of a source.
  void copy(GroundTruth const& other, std::size_t from, std::size_t to);
  /// Writes what the rays of a dot say.
  void set_hits(std::size_t dot, DotTruth const& found, double light_per_weight);
};

/// What the standard errors of the dots' displacements come to.
struct TruthAccuracy {
  double rms_px = 0;              ///< over dots and components whose error is known; NaN: none is
  double largest_px = 0;          ///< of a component
  std::size_t worst = 0;          ///< the dot that has it
  std::size_t above = 0;          ///< dots with a component above the limit
  std::size_t unknown = 0;        ///< dots that are seen, but by so few rays that their errors are not known
  std::size_t by_table = 0;       ///< dots whose truth is the table's
  std::size_t above_by_rays = 0;  ///< of those above the limit, the others
};
/// @param limit_px of a component
TruthAccuracy truth_accuracy(GroundTruth const& truth, double limit_px);

/// Counts of rays by RayStatus in each frame.
using StatusCounts = std::array<std::array<std::int64_t, ray_status_count>, 2>;

}  // namespace gladstone
