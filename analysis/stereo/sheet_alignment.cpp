#include "analysis/stereo/sheet_alignment.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "analysis/correlation/standard_correlator.h"
#include "render/base/contracts.h"
#include "render/base/error.h"
#include "render/base/median.h"

namespace gladstone::inline stereo {
namespace {

/// Least-squares plane, and the standard uncertainties of its parameters for a standard deviation of 1 m of the points'
/// z.
struct SolvedPlane {
  ObjectPlane plane;
  double height_sigma;
  Vec2d slope_sigma;
};

/// Returns the plane through the selected points; nullopt if they do not determine it.
std::optional<SolvedPlane> solve_plane(std::vector<Vec3d> const& points, std::vector<char> const& selected) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  double scale = 0.0;  // largest coordinate, by which the columns are divided so that they have similar magnitudes [m]
  for (Vec3d const& p : points) scale = std::max({scale, std::abs(p.x), std::abs(p.y)});
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!selected[i]) continue;
    Eigen::Vector3d const row(1.0, points[i].x / scale, points[i].y / scale);
    normal += row * row.transpose();
    right += row * points[i].z;
  }
  Eigen::FullPivLU<Eigen::Matrix3d> solver(normal);
  solver.setThreshold(1e-9);
  if (!solver.isInvertible()) return std::nullopt;
  Eigen::Vector3d const solution = solver.solve(right);
  Eigen::Vector3d const sigma = solver.inverse().diagonal().cwiseSqrt();
  return SolvedPlane{
      {solution(0), {solution(1) / scale, solution(2) / scale}}, sigma(0), {sigma(1) / scale, sigma(2) / scale}};
}

double height_above(ObjectPlane const& plane, Vec3d const& point) {
  return point.z - plane.point({point.x, point.y}).z;
}

/// Computes the intersection of a plane with the line from a pinhole through a point.
Vec2d project_onto_plane(Vec3d const& pinhole, Vec3d const& point, ObjectPlane const& plane) {
  double const from = height_above(plane, pinhole), to = height_above(plane, point);
  Vec3d const at = pinhole + (from / (from - to)) * (point - pinhole);
  return {at.x, at.y};
}

double find_mean_pixel_size(std::array<PinholeCamera const*, 2> const& cameras, ObjectPlane const& plane) {
  return 0.5 * (find_pixel_size(*cameras[0], plane) + find_pixel_size(*cameras[1], plane));
}

/// Disparities measured between images dewarped onto a plane.
struct Disparities {
  std::vector<Vec2d> node_px;   ///< positions in the dewarped images, midway between both images of the particles
  std::vector<Vec2d> value_px;  ///< position in the image of the second camera minus that in the first
  NodeGrid grid;
  double redundancy = 1.0;  ///< ratio of the number of vectors to the number of independent vectors [1]
};

Disparities measure_disparities(std::array<PinholeCamera const*, 2> const& cameras,
                                std::vector<SimultaneousImages> const& images, ObjectPlane const& plane,
                                double pixel_size, CorrelationSettings const& settings) {
  SimultaneousImages const& first = images.front();
  Disparities result;
  result.grid = find_common_view(
      cameras, {{{first[0].columns(), first[0].rows()}, {first[1].columns(), first[1].rows()}}}, plane, pixel_size);
  if (result.grid.size() == 0)
    throw DataError(ErrorCode::undetermined, "images",
                    "the fields of view of the two cameras do not overlap on the plane; check the calibrations");
  PairSequence const pairs{images.size(), [&](std::size_t pair) {
                             return HostFrames(dewarp_image(images[pair][0], *cameras[0], plane, result.grid),
                                               dewarp_image(images[pair][1], *cameras[1], plane, result.grid));
                           }};
  DisplacementField const field = correlate_ensemble(pairs, settings);
  result.redundancy = find_redundancy(field.columns, settings.overlap) * find_redundancy(field.rows, settings.overlap);
  for (std::size_t i = 0; i < field.size(); ++i) {
    bool const valid = field.status.empty() || field.status[i] == VectorStatus::valid;
    if (!valid || !is_finite(field.displacement_px[i])) continue;
    result.node_px.push_back(field.position_px[i]);
    result.value_px.push_back(field.displacement_px[i]);
  }
  return result;
}

/// Computes the disparity between two images dewarped onto `plane` at a point that is not on this plane [px].
Vec2d predict_disparity(std::array<PinholeCamera const*, 2> const& cameras, Vec3d const& point,
                        ObjectPlane const& plane, double pixel_size) {
  Vec2d const apart = project_onto_plane(find_pinhole(*cameras[1]), point, plane) -
                      project_onto_plane(find_pinhole(*cameras[0]), point, plane);
  return Vec2d{apart.x, -apart.y} / pixel_size;
}

/// Computes the disparity of a point on the Z axis divided by its height above a plane [px/m].
double find_disparity_of_height(std::array<PinholeCamera const*, 2> const& cameras, ObjectPlane const& plane,
                                double pixel_size) {
  constexpr double height = 1e-5;  // height of the point [m], small compared with the distance of the cameras
  return length(predict_disparity(cameras, plane.point({}) + Vec3d{0.0, 0.0, height}, plane, pixel_size)) / height;
}

}  // namespace

double find_redundancy(int vectors, double overlap) {
  double sum = 1.0;
  for (int apart = 1; apart < vectors; ++apart)
    sum += 2.0 * (1.0 - static_cast<double>(apart) / vectors) * std::max(0.0, 1.0 - apart * (1.0 - overlap));
  return sum;
}

std::optional<FittedPlane> fit_object_plane(std::vector<Vec3d> const& points, double redundancy) {
  constexpr int max_rounds = 10;
  constexpr double limit = 3.0;  // in standard deviations
  if (points.size() < 4) return std::nullopt;
  std::vector<char> selected(points.size(), 1);
  FittedPlane fit;
  for (int round = 0; round < max_rounds; ++round) {
    auto const solved = solve_plane(points, selected);
    if (!solved) return std::nullopt;
    std::vector<double> distance(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) distance[i] = std::abs(height_above(solved->plane, points[i]));
    double const largest = limit * sigma_per_median_deviation * upper_median(distance), rounding = 1e-12;  // [m]
    fit = {solved->plane};
    std::vector<char> next(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      next[i] = distance[i] <= largest + rounding ? 1 : 0;
      fit.points += next[i] ? 1 : 0;
      fit.scatter += next[i] ? distance[i] * distance[i] : 0.0;
    }
    fit.outliers = points.size() - fit.points;
    fit.scatter = std::sqrt(fit.scatter / static_cast<double>(fit.points));
    double const independent = static_cast<double>(fit.points) / redundancy;
    fit.freedom = std::max(1.0, independent - 3.0);
    double const sigma = fit.scatter * std::sqrt(independent / fit.freedom * redundancy);
    fit.height_sigma = sigma * solved->height_sigma;
    fit.slope_sigma = sigma * solved->slope_sigma;
    if (next == selected) break;
    selected = std::move(next);
  }
  return fit;
}

Vec3d triangulate(PinholeCamera const& a, Vec2d in_a, PinholeCamera const& b, Vec2d in_b, ObjectPlane const& plane) {
  Vec3d const from_a = find_pinhole(a), from_b = find_pinhole(b);
  Vec3d const along_a = normalized(plane.point(in_a) - from_a), along_b = normalized(plane.point(in_b) - from_b);
  double const cosine = dot(along_a, along_b), sine2 = 1.0 - cosine * cosine;
  Vec3d const base = from_b - from_a;
  double const way_a = (dot(base, along_a) - cosine * dot(base, along_b)) / sine2;
  double const way_b = (cosine * dot(base, along_a) - dot(base, along_b)) / sine2;
  return 0.5 * (from_a + way_a * along_a + from_b + way_b * along_b);
}

SheetAlignment align_sheet(std::array<PinholeCamera const*, 2> const& cameras,
                           std::vector<SimultaneousImages> const& images, ObjectPlane plane,
                           CorrelationSettings const& settings, int max_iterations) {
  GLADSTONE_EXPECTS(!images.empty() && max_iterations > 0);
  constexpr double goal_px = 0.005;
  SheetAlignment result;
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    result.pixel_size = find_mean_pixel_size(cameras, plane);
    Disparities const measured = measure_disparities(cameras, images, plane, result.pixel_size, settings);
    std::vector<Vec3d> points;
    for (std::size_t i = 0; i < measured.node_px.size(); ++i) {
      Vec2d const half = 0.5 * measured.value_px[i];
      points.push_back(triangulate(*cameras[0], measured.grid.position_of_pixel(measured.node_px[i] - half),
                                   *cameras[1], measured.grid.position_of_pixel(measured.node_px[i] + half), plane));
    }
    auto const fit = fit_object_plane(points, measured.redundancy);
    if (!fit)
      throw DataError(ErrorCode::undetermined, "images",
                      "the two cameras have too few valid disparities to determine the laser sheet; use "
                      "larger windows or more images");
    double squares = 0.0, scatter = 0.0, inside = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      Vec2d const predicted =
          predict_disparity(cameras, fit->plane.point({points[i].x, points[i].y}), plane, result.pixel_size);
      Vec2d const off = measured.value_px[i] - predicted;
      // point that the fit has excluded as an outlier
      if (std::abs(height_above(fit->plane, points[i])) > 5.0 * fit->scatter + 1e-12) continue;
      squares += dot(predicted, predicted);
      scatter += dot(off, off);
      inside += 1.0;
    }
    result.fit = *fit;
    result.disparity_px.push_back(std::sqrt(squares / inside));
    result.scatter_px = std::sqrt(scatter / inside);
    // Three parameters of the plane share the variance of the independent points.
    result.disparity_sigma_px =
        fit->scatter * std::sqrt(3.0 / fit->freedom) * find_disparity_of_height(cameras, fit->plane, result.pixel_size);
    plane = fit->plane;
    if (result.disparity_px.back() < goal_px) break;
  }
  return result;
}

}  // namespace gladstone::inline stereo
