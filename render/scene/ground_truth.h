#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "render/base/ray.h"
#include "render/base/vec.h"

namespace gladstone::inline scene {

/// Weighted sums over the ray hits of one dot in one image, relative to a nearby origin to avoid loss of significance.
template <class T>
struct CentroidSum {
  T weight{};
  Vec2<T> first{};
  Vec2<T> second{};
  std::int64_t count = 0;

  /// Adds a hit at p with weight w.
  /// @param counts  whether the ray is included in `count`
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

/// Method by which the true displacement of a dot was computed.
enum class TruthPath : int {
  rays,   ///< centroids of traced rays
  table,  ///< integral of the deflection table over the light cone, corrected by traced rays
};

/// Sums over the traced rays of one dot, from which GroundTruth::set_hits() computes its true displacement.
struct DotTruth {
  Vec2d origin;  ///< position to which the sums are relative [px]
  CentroidSum<double> hits[2];
  Vec2d error;  ///< standard error of the displacement [px]
  TruthPath path = TruthPath::rays;
};

/// Truth of particles in addition to GroundTruth, whose reference is frame A and whose flow is frame B.
struct ParticleTruth {
  std::vector<Vec3d> second_m;                 ///< positions at the second pulse [m]
  std::vector<double> diameter_m;              ///< particle diameters [m]
  std::vector<Vec2d> reference_ambient_px;     ///< like GroundTruth::reference_px, without the medium
  std::vector<Vec2d> displacement_ambient_px;  ///< like GroundTruth::displacement_px, without the medium
};

/// True image positions and displacements of all dots or particles (by rays) and their theoretical displacements [px].
/// Displacements are measurement image minus reference image (PIV: frame B minus frame A).
struct GroundTruth {
  std::vector<Vec3d> position_m;
  std::vector<Vec2d> reference_px;  ///< radiance-weighted centroid of the rays that pass the stop; NaN: no ray passes
  std::vector<Vec2d> displacement_px;        ///< measurement centroid minus reference centroid
  std::vector<Vec2d> displacement_error_px;  ///< standard error of displacement_px; NaN: unknown (truth_error.h)
  std::vector<Vec2d> displacement_std_px;    ///< weighted standard deviation of the hits in the measurement image
  std::vector<Vec2d> flux;  ///< light in reference (x) and measurement image (y) [fully lit px; particles: photons]
  std::vector<std::array<std::int64_t, 2>> rays;  ///< number of rays counted in each image
  std::vector<std::int64_t> rays_planned;         ///< number of rays planned
  std::vector<Vec2d> eq9_px;                      ///< small-angle theory (Eq. 9) along the chief ray, lever Z_D
  std::vector<Vec2d> chief_px;                    ///< Eq. 9 along the chief ray, with the lever of each slice
  std::vector<Vec2d> eq9_cone_px;  ///< aperture-averaged theory: mean over dot and pupil, levers of slices
  std::vector<TruthPath> path;     ///< method that computed displacement_px
  ParticleTruth particles;         ///< additional truth of particles; empty for dots

  std::size_t size() const { return position_m.size(); }
  void resize(std::size_t count);
  /// Copies all values of source `from` of another truth to source `to` of this one, except `particles`.
  void copy(GroundTruth const& other, std::size_t from, std::size_t to);
  /// Stores the ray results of a dot.
  /// @param light_per_weight  light per unit of ray weight
  void set_hits(std::size_t dot, DotTruth const& found, double light_per_weight);
};

/// Statistics of the standard errors of the true displacements.
struct TruthAccuracy {
  double rms_px = 0;              ///< rms over dots and components with a known error [px]; NaN: none is known
  double largest_px = 0;          ///< largest error of any component [px]
  std::size_t worst = 0;          ///< index of the dot with the largest error
  std::size_t above = 0;          ///< number of dots with a component above the limit
  std::size_t unknown = 0;        ///< number of visible dots whose error is unknown because too few rays passed
  std::size_t by_table = 0;       ///< number of dots whose truth is from the deflection table
  std::size_t above_by_rays = 0;  ///< number of dots above the limit whose truth is from rays alone
};
/// Computes the statistics of a truth's standard errors.
/// @param limit_px  limit of the error of a component [px]
TruthAccuracy truth_accuracy(GroundTruth const& truth, double limit_px);

/// Number of rays for each RayStatus, for each of the two images.
using StatusCounts = std::array<std::array<std::int64_t, ray_status_count>, 2>;
/// Adds the counts of some rays to those of others.
inline void add_counts(StatusCounts& all, StatusCounts const& some) {
  for (std::size_t frame = 0; frame < all.size(); ++frame) {
    for (std::size_t status = 0; status < all[frame].size(); ++status) all[frame][status] += some[frame][status];
  }
}

}  // namespace gladstone::inline scene
