#include "analysis/calibration/pinhole_fit.h"

#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "analysis/calibration/linear_pinhole.h"

namespace gladstone {
namespace {

constexpr std::size_t least_points = 12;
using Parameters = std::array<double, PinholeCamera::count>;

/// PinholeCamera::project, for any scalar.
template <class T>
void project(T const* p, T const* world, T* pixel) {
  T d[3];
  ceres::AngleAxisRotatePoint(p + 8, world, d);
  T const depth = d[2] + p[13], x = (d[0] + p[11]) / depth, y = (d[1] + p[12]) / depth;
  T const r2 = x * x + y * y, radial = 1.0 + r2 * (p[4] + r2 * p[5]);
  pixel[0] = p[0] * (x * radial + 2.0 * p[6] * x * y + p[7] * (r2 + 2.0 * x * x)) + p[2];
  pixel[1] = p[1] * (y * radial + p[6] * (r2 + 2.0 * y * y) + 2.0 * p[7] * x * y) + p[3];
}

/// From the camera to a point of the world, in the camera's axes.
template <class T>
void look_at(T const* p, T const* world, T* d) {
  ceres::AngleAxisRotatePoint(p + 8, world, d);
  for (int axis = 0; axis < 3; ++axis) d[axis] += p[11 + axis];
}

template <class T>
T dot3(T const* a, T const* b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// The centroid of the image of a Lambertian dot: the mean of its disc_points' images, each weighted by the light that
/// it sends through the lens, cos(slant of the plane) cos(slant of the lens) / distance^2. The lens faces `middle`.
template <class T>
void project_dot(T const* p, Vec3d const& centre, double radius, Vec3d const& middle, T* pixel) {
  T const normal[3] = {T(0.0), T(0.0), T(1.0)}, faced[3] = {T(middle.x), T(middle.y), T(middle.z)};
  T across[3], axis[3], sum(0.0);
  ceres::AngleAxisRotatePoint(p + 8, normal, across);
  look_at(p, faced, axis);
  pixel[0] = pixel[1] = T(0.0);
  for (Vec2d const off : disc_points) {
    T const world[3] = {T(centre.x + radius * off.x), T(centre.y + radius * off.y), T(centre.z)};
    T one[2], way[3];
    project(p, world, one);
    look_at(p, world, way);
    T const distance2 = dot3(way, way), light = dot3(across, way) * dot3(axis, way) / (distance2 * distance2);
    pixel[0] += light * one[0];
    pixel[1] += light * one[1];
    sum += light;
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

  template <class T>
  bool operator()(T const* parameters, T* residual) const {
    project_dot(parameters, centre, radius, middle, residual);
    residual[0] = pixel.x - residual[0];
    residual[1] = pixel.y - residual[1];
    return true;
  }
};

/// Fits from a start; first without distortion, and with the principal point where it is.
/// @return half the sum of squares
double refine(CalibrationPoints const& points, Parameters& parameters) {
  double cost = 0;
  Vec3d const middle = mean_of(points.world);
  for (std::vector<int> const& held : {std::vector<int>{2, 3, 4, 5, 6, 7}, std::vector<int>{4, 5, 6, 7}, {}}) {
    ceres::Problem problem;
    for (std::size_t k = 0; k < points.size(); ++k) {
      problem.AddResidualBlock(new ceres::AutoDiffCostFunction<Residual, 2, static_cast<int>(PinholeCamera::count)>(
                                   new Residual{points.world[k], points.pixel[k], points.dot_radius, middle}),
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
    cost = summary.final_cost;
  }
  return cost;
}

/// Derivatives of all residuals by the parameters.
Eigen::MatrixXd jacobian(CalibrationPoints const& points, Parameters const& parameters) {
  constexpr auto columns = static_cast<int>(PinholeCamera::count);
  Eigen::Matrix<double, Eigen::Dynamic, columns, Eigen::RowMajor> all(2 * static_cast<Eigen::Index>(points.size()),
                                                                      columns);
  Vec3d const middle = mean_of(points.world);
  for (std::size_t k = 0; k < points.size(); ++k) {
    ceres::AutoDiffCostFunction<Residual, 2, columns> const cost(
        new Residual{points.world[k], points.pixel[k], points.dot_radius, middle});
    double const* const blocks[] = {parameters.data()};
    double residual[2];
    double* rows[] = {all.row(2 * static_cast<Eigen::Index>(k)).data()};
    cost.Evaluate(blocks, residual, rows);
  }
  return all;
}

/// Inverse of J^T J times the residuals' variance; columns are brought to one size first. Where the points leave a
/// combination of parameters open its standard errors are infinite.
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

Vec2d PinholeCamera::image_of_dot(Vec3d centre, double radius, Vec3d middle) const {
  double pixel[2];
  project_dot(value.data(), centre, radius, middle, pixel);
  return {pixel[0], pixel[1]};
}

PinholeFit fit_pinhole(CalibrationPoints const& points, Vec2d middle_px) {
  if (points.size() < least_points) throw std::invalid_argument("too few points for a pinhole camera");
  if (on_one_plane(points)) throw std::invalid_argument("points on one plane leave a pinhole camera open");
  Parameters const linear = linear_pinhole(points).value;
  Parameters central = linear;
  central[2] = middle_px.x;
  central[3] = middle_px.y;
  PinholeFit fit;
  double least = std::numeric_limits<double>::infinity();
  for (Parameters start : {linear, central}) {
    double const cost = refine(points, start);
    if (!(cost < least)) continue;
    least = cost;
    fit.camera.value = start;
  }
  if (!std::isfinite(least)) throw std::invalid_argument("no pinhole camera fits the points");
  double squares = 0;
  Vec3d const middle = mean_of(points.world);
  for (std::size_t k = 0; k < points.size(); ++k) {
    Vec2d const residual = points.pixel[k] - fit.camera.image_of_dot(points.world[k], points.dot_radius, middle);
    fit.residual_px.push_back(residual);
    squares += dot(residual, residual);
  }
  fit.rms_px = std::sqrt(squares / (2.0 * static_cast<double>(points.size())));
  find_errors(points, fit, squares);
  return fit;
}

}  // namespace gladstone
