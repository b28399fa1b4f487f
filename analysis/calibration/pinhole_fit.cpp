#include "analysis/calibration/pinhole_fit.h"

#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "analysis/calibration/linear_pinhole.h"

namespace gladstone::inline calibration {
namespace {

constexpr std::size_t least_points = 12;
using Parameters = std::array<double, PinholeCamera::count>;

/// Computes the pixel of a point in camera coordinates.
template <class T>
void pixel_of(T const* p, T const* d, T* pixel) {
  T const x = d[0] / d[2], y = d[1] / d[2];
  T const r2 = x * x + y * y, radial = 1.0 + r2 * (p[4] + r2 * p[5]);
  pixel[0] = p[0] * (x * radial + 2.0 * p[6] * x * y + p[7] * (r2 + 2.0 * x * x)) + p[2];
  pixel[1] = p[1] * (y * radial + p[6] * (r2 + 2.0 * y * y) + 2.0 * p[7] * x * y) + p[3];
}

/// Transforms a world point to camera coordinates.
template <class T>
void look_at(T const* p, T const* world, T* d) {
  ceres::AngleAxisRotatePoint(p + 8, world, d);
  for (int axis = 0; axis < 3; ++axis) d[axis] += p[11 + axis];
}

/// Implements PinholeCamera::project for any scalar type.
template <class T>
void project(T const* p, T const* world, T* pixel) {
  T d[3];
  look_at(p, world, d);
  pixel_of(p, d, pixel);
}

template <class T>
T dot3(T const* a, T const* b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

template <class T>
void turn(T const* p, Vec3d const& world, T* turned) {
  T const v[3] = {T(world.x), T(world.y), T(world.z)};
  ceres::AngleAxisRotatePoint(p + 8, v, turned);
}

/// Adds the contribution of one ray from a point of a dot through a position in the pupil to the irradiance-weighted
/// mean image position. Adds its irradiance, cos(angle to the plate's normal) cos(angle to the lens axis) / distance^2,
/// to `sum`, and the irradiance times the image position to `pixel`. The image position follows from the ray's
/// intersection with the plane in focus (ideal lens). All vectors are in camera coordinates.
/// @param across  normal of the plane of the dots
/// @param axis    direction of the lens axis
/// @param focus   normal of the plane in focus; null: `place`, the position in the pupil, is the pinhole itself
/// @param depth   distance of the plane in focus from the camera, along its normal [m]
template <class T>
void add_ray(T const* p, T const* point, T const* place, T const* across, T const* axis, T const* focus, T const& depth,
             T* pixel, T& sum) {
  T way[3], crossing[3], one[2];
  for (int k = 0; k < 3; ++k) way[k] = point[k] - place[k];
  T const share = focus ? (depth - dot3(focus, place)) / dot3(focus, way) : T(1.0);
  for (int k = 0; k < 3; ++k) crossing[k] = place[k] + share * way[k];
  pixel_of(p, crossing, one);
  T const distance2 = dot3(way, way), light = dot3(across, way) * dot3(axis, way) / (distance2 * distance2);
  pixel[0] += light * one[0];
  pixel[1] += light * one[1];
  sum += light;
}

/// Computes two vectors of the given length, perpendicular to the lens axis and to each other.
template <class T>
void across_axis(T const* axis, double length, T* right, T* down) {
  using std::sqrt;
  T const size = sqrt(dot3(axis, axis)), flat = sqrt(axis[0] * axis[0] + axis[2] * axis[2]);
  right[0] = length * axis[2] / flat;
  right[1] = T(0.0);
  right[2] = -length * axis[0] / flat;
  down[0] = axis[1] * right[2] / size;
  down[1] = (axis[2] * right[0] - axis[0] * right[2]) / size;
  down[2] = -axis[1] * right[0] / size;
}

/// Computes the centroid of the image of a Lambertian dot: the irradiance-weighted mean over disc_points of the dot
/// and, if the pupil radius is not 0, over disc_points of the entrance pupil. The lens axis points at `middle`.
template <class T>
void project_dot(T const* p, Vec3d const& centre, double radius, Vec3d const& middle, CalibratedLens const& lens,
                 T* pixel) {
  T const faced[3] = {T(middle.x), T(middle.y), T(middle.z)};
  T across[3], axis[3], focus[3], right[3], down[3], sum(0.0);
  turn(p, {0, 0, 1}, across);
  look_at(p, faced, axis);
  turn(p, lens.focus_normal, focus);
  T const depth = dot(lens.focus_normal, lens.focus_point) + dot3(focus, p + 11);
  across_axis(axis, lens.pupil_radius, right, down);
  pixel[0] = pixel[1] = T(0.0);
  for (Vec2d const off : disc_points) {
    T const world[3] = {T(centre.x + radius * off.x), T(centre.y + radius * off.y), T(centre.z)};
    T point[3], place[3] = {T(0.0), T(0.0), T(0.0)};
    look_at(p, world, point);
    if (lens.pupil_radius == 0) {
      add_ray<T>(p, point, place, across, axis, nullptr, depth, pixel, sum);
      continue;
    }
    for (Vec2d const at : disc_points) {
      for (int k = 0; k < 3; ++k) place[k] = at.x * right[k] + at.y * down[k];
      add_ray<T>(p, point, place, across, axis, focus, depth, pixel, sum);
    }
  }
  pixel[0] /= sum;
  pixel[1] /= sum;
}

Vec3d mean_of(std::vector<Vec3d> const& points) {
  Vec3d sum{};
  for (Vec3d const& point : points) sum = sum + point;
  return sum / static_cast<double>(points.size());
}

struct Residual {
  Vec3d centre;
  Vec2d pixel;
  double radius;
  Vec3d middle;
  CalibratedLens lens;

  template <class T>
  bool operator()(T const* parameters, T* residual) const {
    project_dot(parameters, centre, radius, middle, lens, residual);
    residual[0] = pixel.x - residual[0];
    residual[1] = pixel.y - residual[1];
    return true;
  }
};

struct Refinement {
  double cost = 0;  ///< half the sum of squared residuals
  bool converged = false;
};

/// Fits the parameters in three stages from their initial values: first without distortion and with a fixed principal
/// point, then without distortion, finally all parameters.
Refinement refine(CalibrationPoints const& points, Parameters& parameters) {
  Refinement refinement;
  Vec3d const middle = mean_of(points.world);
  for (std::vector<int> const& held : {std::vector<int>{2, 3, 4, 5, 6, 7}, std::vector<int>{4, 5, 6, 7}, {}}) {
    ceres::Problem problem;
    for (std::size_t k = 0; k < points.size(); ++k) {
      problem.AddResidualBlock(
          new ceres::AutoDiffCostFunction<Residual, 2, static_cast<int>(PinholeCamera::count)>(
              new Residual{points.world[k], points.pixel[k], points.dot_radius, middle, points.lens}),
          nullptr, parameters.data());
    }
    if (!held.empty()) {
      problem.SetManifold(parameters.data(), new ceres::SubsetManifold(static_cast<int>(PinholeCamera::count), held));
    }
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_QR;
    options.max_num_iterations = 500;
    options.function_tolerance = options.gradient_tolerance = options.parameter_tolerance = 1e-15;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    refinement = {summary.final_cost, summary.termination_type == ceres::CONVERGENCE};
  }
  return refinement;
}

/// Returns the derivatives of all residuals with respect to the parameters.
Eigen::MatrixXd jacobian(CalibrationPoints const& points, Parameters const& parameters) {
  constexpr auto columns = static_cast<int>(PinholeCamera::count);
  Eigen::Matrix<double, Eigen::Dynamic, columns, Eigen::RowMajor> all(2 * static_cast<Eigen::Index>(points.size()),
                                                                      columns);
  Vec3d const middle = mean_of(points.world);
  for (std::size_t k = 0; k < points.size(); ++k) {
    ceres::AutoDiffCostFunction<Residual, 2, columns> const cost(
        new Residual{points.world[k], points.pixel[k], points.dot_radius, middle, points.lens});
    double const* const blocks[] = {parameters.data()};
    double residual[2];
    double* rows[] = {all.row(2 * static_cast<Eigen::Index>(k)).data()};
    cost.Evaluate(blocks, residual, rows);
  }
  return all;
}

/// Computes the covariance, which is the inverse of J^T J times the variance of the residuals, and the standard errors.
/// The columns of J are normalised first. If a combination of parameters is undetermined, its standard errors are
/// infinite.
void find_errors(CalibrationPoints const& points, PinholeFit& fit, double squares) {
  Eigen::MatrixXd J = jacobian(points, fit.camera.value);
  Eigen::VectorXd const shrink = J.colwise().norm().cwiseInverse();
  J = J * shrink.asDiagonal();
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> const solver(J.transpose() * J);
  Eigen::MatrixXd const axes = shrink.asDiagonal() * solver.eigenvectors();
  double const variance = squares / static_cast<double>(J.rows() - J.cols());
  Eigen::VectorXd const spread = variance * solver.eigenvalues().cwiseMax(0.0).cwiseInverse();
  Eigen::MatrixXd const covariance = axes * spread.asDiagonal() * axes.transpose();
  fit.covariance.assign(covariance.data(), covariance.data() + covariance.size());
  for (std::size_t i = 0; i < PinholeCamera::count; ++i) {
    auto const k = static_cast<Eigen::Index>(i);
    fit.standard_error[i] = std::sqrt(covariance(k, k));
  }
}

}  // namespace

Vec2d PinholeCamera::project(Vec3d world) const {
  double const point[3] = {world.x, world.y, world.z};
  double pixel[2];
  gladstone::project(value.data(), point, pixel);
  return {pixel[0], pixel[1]};
}

Vec2d PinholeCamera::image_of_dot(Vec3d centre, double radius, Vec3d middle, CalibratedLens const& lens) const {
  double pixel[2];
  project_dot(value.data(), centre, radius, middle, lens, pixel);
  return {pixel[0], pixel[1]};
}

PinholeFit fit_pinhole(CalibrationPoints const& points, Vec2d middle_px) {
  if (points.size() < least_points) throw std::invalid_argument("too few points for a pinhole camera");
  if (on_one_plane(points)) throw std::invalid_argument("points on one plane do not determine a pinhole camera");
  Parameters const linear = linear_pinhole(points).value;
  Parameters central = linear;
  central[2] = middle_px.x;
  central[3] = middle_px.y;
  PinholeFit fit;
  double least = std::numeric_limits<double>::infinity();
  for (Parameters start : {linear, central}) {
    Refinement const end = refine(points, start);
    if (!(end.cost < least)) continue;
    least = end.cost;
    fit.camera.value = start;
    fit.converged = end.converged;
  }
  if (!std::isfinite(least)) throw std::invalid_argument("no pinhole camera fits the points");
  double squares = 0;
  Vec3d const middle = mean_of(points.world);
  for (std::size_t k = 0; k < points.size(); ++k) {
    Vec2d const residual =
        points.pixel[k] - fit.camera.image_of_dot(points.world[k], points.dot_radius, middle, points.lens);
    fit.residual_px.push_back(residual);
    squares += dot(residual, residual);
  }
  fit.rms_px = std::sqrt(squares / (2.0 * static_cast<double>(points.size())));
  find_errors(points, fit, squares);
  return fit;
}

}  // namespace gladstone::inline calibration
