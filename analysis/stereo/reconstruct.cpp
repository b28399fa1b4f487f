#include "analysis/stereo/reconstruct.h"

#include <Eigen/Cholesky>
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "analysis/stereo/interpolated_field.h"
#include "render/base/contracts.h"
#include "render/base/not_a_number.h"
#include "render/base/parallel.h"

namespace gladstone::inline stereo {
namespace {

constexpr int parameter_count = static_cast<int>(PinholeCamera::count);
using Equations = Eigen::Matrix<double, 4, 3>;
using Residuals = Eigen::Vector4d;

/// A camera with its vectors.
struct View {
  CalibratedCamera const* calibration;
  InterpolatedField field;
  std::optional<Dewarping> const& dewarping;

  /// Projects a point into the image on which the vectors were measured. If images are dewarped, the dewarping uses the
  /// calibrated camera, even if `camera` differs from it.
  /// @param camera  camera that recorded the image
  Vec2d project(PinholeCamera const& camera, Vec3d at) const {
    Vec2d const pixel = camera.project(at);
    if (!dewarping) return pixel;
    std::optional<Vec2d> const on_plane = intersect_plane(calibration->camera, pixel, dewarping->plane);
    return on_plane ? dewarping->grid.pixel(*on_plane) : Vec2d{not_a_number, not_a_number};
  }
  Vec2d project(Vec3d at) const { return project(calibration->camera, at); }

  /// Computes the displacement of the image of a particle that moves from `at` - `moved` / 2 to `at` + `moved` / 2
  /// [px].
  Vec2d project_motion(PinholeCamera const& camera, Vec3d at, Vec3d moved) const {
    return project(camera, at + 0.5 * moved) - project(camera, at - 0.5 * moved);
  }
  Vec2d project_motion(Vec3d at, Vec3d moved) const { return project_motion(calibration->camera, at, moved); }
};

/// Computes the derivatives of a projected point with respect to its position by central differences [px/m].
Eigen::Matrix<double, 2, 3> differentiate_projection(View const& view, Vec3d at) {
  constexpr double step = 1e-5;  // step [m]; its square is negligible compared with the squared distance of the camera
  Eigen::Matrix<double, 2, 3> derivative;
  for (int axis = 0; axis < 3; ++axis) {
    Vec3d moved{};
    moved[axis] = 2.0 * step;
    Vec2d const change = view.project_motion(at, moved) / (2.0 * step);
    derivative.col(axis) << change.x, change.y;
  }
  return derivative;
}

Covariance pack(Eigen::Matrix3d const& matrix) {
  return {matrix(0, 0), matrix(1, 1), matrix(2, 2), matrix(0, 1), matrix(0, 2), matrix(1, 2)};
}

/// Derivatives of a camera's two residuals, measured minus projected, with respect to its parameters.
Eigen::Matrix<double, 2, parameter_count> differentiate_residual(View const& view, Vec3d at, Vec3d moved) {
  // step of the finite differences relative to the parameter's standard error, small enough for a linear response
  constexpr double step_fraction = 1e-3;
  Eigen::Matrix<double, 2, parameter_count> derivative = Eigen::Matrix<double, 2, parameter_count>::Zero();
  PinholeCamera const& nominal = view.calibration->camera;
  std::vector<double> const& covariance = view.calibration->covariance;
  for (std::size_t i = 0; i < PinholeCamera::count; ++i) {
    double const step = step_fraction * std::sqrt(covariance[i * (PinholeCamera::count + 1)]);
    if (!(step > 0.0)) continue;
    PinholeCamera above = nominal, below = nominal;
    above.value[i] += step;
    below.value[i] -= step;
    Vec2d change = view.project_motion(below, at, moved) - view.project_motion(above, at, moved);
    auto const high = view.field.displacement(view.project(above, at)),
               low = view.field.displacement(view.project(below, at));
    // the change of the interpolated vector is omitted at the border of the vectors
    if (high && low) change += *high - *low;
    derivative.col(static_cast<Eigen::Index>(i)) << change.x / (2.0 * step), change.y / (2.0 * step);
  }
  return derivative;
}

/// Covariance of the four residuals due to the errors of both calibrations [px^2].
Eigen::Matrix4d propagate_calibrations(View const& a, View const& b, Vec3d at, Vec3d moved) {
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();
  int first = 0;
  for (View const* view : {&a, &b}) {
    if (!view->calibration->covariance.empty()) {
      using Matrix = Eigen::Matrix<double, parameter_count, parameter_count, Eigen::RowMajor>;
      auto const derivative = differentiate_residual(*view, at, moved);
      Eigen::Map<Matrix const> const parameters(view->calibration->covariance.data());
      covariance.block<2, 2>(first, first) = derivative * parameters * derivative.transpose();
    }
    first += 2;
  }
  return covariance;
}

/// Solves the four equations at a node.
class NodeSolver {
 public:
  NodeSolver(View const& a, View const& b, Vec3d at) : a_(a), b_(b), at_(at) {}

  std::optional<StereoVector> solve() {
    auto const in_a = a_.field.vector(a_.project(at_)), in_b = b_.field.vector(b_.project(at_));
    if (!in_a || !in_b) return std::nullopt;
    measured_ << in_a->displacement_px.x, in_a->displacement_px.y, in_b->displacement_px.x, in_b->displacement_px.y;
    sigma_ << in_a->sigma_px.x, in_a->sigma_px.y, in_b->sigma_px.x, in_b->sigma_px.y;
    weighted_ = sigma_.allFinite() && sigma_.minCoeff() > 0.0;
    StereoVector result;
    result.image_a_px = in_a->displacement_px;
    result.image_b_px = in_b->displacement_px;
    if (!find_displacement()) return std::nullopt;
    result.displacement = moved_;
    add_uncertainty(result);
    return result;
  }

 private:
  Residuals find_residuals() const {
    Vec2d const a = a_.project_motion(at_, moved_), b = b_.project_motion(at_, moved_);
    return measured_ - Residuals(a.x, a.y, b.x, b.y);
  }

  /// Finds the displacement iteratively, always with the derivatives at the node. They suffice because the projection
  /// of a displacement symmetric about the node is linear except for terms of third order.
  bool find_displacement() {
    constexpr int max_iterations = 20;
    constexpr double tolerance = 1e-11;  // largest change in the last iteration [m]
    Equations equations;
    equations << differentiate_projection(a_, at_), differentiate_projection(b_, at_);
    Residuals const weight = weighted_ ? Residuals(sigma_.cwiseInverse()) : Residuals::Ones().eval();
    whitened_ = weight.asDiagonal() * equations;
    inverse_ = (whitened_.transpose() * whitened_).inverse();
    gain_ = inverse_ * whitened_.transpose() * weight.asDiagonal();
    for (int i = 0; i < max_iterations; ++i) {
      Eigen::Vector3d const change = gain_ * find_residuals();
      if (!change.allFinite()) return false;
      moved_ += Vec3d{change.x(), change.y(), change.z()};
      if (change.norm() <= tolerance) return true;
    }
    return false;
  }

  void add_uncertainty(StereoVector& result) const {
    Residuals const residuals = find_residuals();
    result.residual_px = residuals.norm();
    Eigen::Matrix4d const calibration = propagate_calibrations(a_, b_, at_, moved_);
    Eigen::Matrix3d const from_calibration = gain_ * calibration * gain_.transpose();
    result.from_calibration = pack(from_calibration);
    if (!weighted_) {
      result.covariance.fill(not_a_number);
      result.residual_ratio = not_a_number;
      return;
    }
    result.covariance = pack(inverse_ + from_calibration);
    // The weighted residual has one degree of freedom: its component perpendicular to the three columns.
    Residuals const direction = (sigma_.cwiseInverse().asDiagonal() * residuals).normalized();
    Residuals const scaled = sigma_.cwiseInverse().asDiagonal() * direction;
    double const variance = 1.0 + scaled.dot(calibration * scaled);
    result.residual_ratio = (sigma_.cwiseInverse().asDiagonal() * residuals).norm() / std::sqrt(variance);
  }

  View const& a_;
  View const& b_;
  Vec3d at_;
  Vec3d moved_{};
  Residuals measured_, sigma_;
  bool weighted_ = false;
  Equations whitened_;
  Eigen::Matrix3d inverse_;
  Eigen::Matrix<double, 3, 4> gain_;
};

/// Bounding box of a camera's vectors projected onto the plane, and the mean distance between neighbouring vectors on
/// the plane.
struct Footprint {
  Vec2d low{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  Vec2d high = -low;
  /// Mean distance of neighbouring vectors [m]; NaN: no lines of sight of neighbouring vectors meet the plane.
  double spacing = 0.0;
};

Footprint find_footprint(PinholeCamera const& camera, DisplacementField const& field, ObjectPlane const& plane,
                         std::optional<Dewarping> const& dewarping) {
  Footprint footprint;
  std::vector<std::optional<Vec2d>> at(field.size());
  for (std::size_t i = 0; i < field.size(); ++i) {
    at[i] = dewarping ? dewarping->grid.position_of_pixel(field.position_px[i])
                      : intersect_plane(camera, field.position_px[i], plane);
    if (!at[i] || !field.counts(i)) continue;
    footprint.low = {std::min(footprint.low.x, at[i]->x), std::min(footprint.low.y, at[i]->y)};
    footprint.high = {std::max(footprint.high.x, at[i]->x), std::max(footprint.high.y, at[i]->y)};
  }
  double area = 0.0, cells = 0.0;
  auto const columns = static_cast<std::size_t>(field.columns);
  for (std::size_t i = 0; i + columns < field.size(); ++i) {
    if (i % columns + 1 == columns || !at[i] || !at[i + 1] || !at[i + columns]) continue;
    Vec2d const right = *at[i + 1] - *at[i], down = *at[i + columns] - *at[i];
    area += std::abs(right.x * down.y - right.y * down.x);
    cells += 1.0;
  }
  footprint.spacing = std::sqrt(area / cells);
  return footprint;
}

}  // namespace

Vec3d StereoVector::sigma() const {
  return {std::sqrt(covariance[0]), std::sqrt(covariance[1]), std::sqrt(covariance[2])};
}

StereoField reconstruct(CalibratedCamera const& camera_a, DisplacementField const& field_a,
                        CalibratedCamera const& camera_b, DisplacementField const& field_b, ObjectPlane const& plane,
                        StereoSettings const& settings) {
  GLADSTONE_EXPECTS(camera_a.covariance.empty() ||
                    camera_a.covariance.size() == PinholeCamera::count * PinholeCamera::count);
  GLADSTONE_EXPECTS(camera_b.covariance.empty() ||
                    camera_b.covariance.size() == PinholeCamera::count * PinholeCamera::count);
  View const a{&camera_a, {field_a, settings.window_a_px}, settings.dewarping};
  View const b{&camera_b, {field_b, settings.window_b_px}, settings.dewarping};
  StereoField result;
  result.plane = plane;
  result.grid = find_common_grid(camera_a, field_a, camera_b, field_b, plane, settings.spacing, settings.dewarping);
  result.nodes.resize(result.grid.size());
  constexpr std::size_t nodes_per_chunk = 64;
  parallel_chunks(result.nodes.size(), nodes_per_chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t node = begin; node < end; ++node)
      result.nodes[node] = NodeSolver(a, b, plane.point(result.grid.position(node))).solve();
  });
  return result;
}

NodeGrid find_common_grid(CalibratedCamera const& camera_a, DisplacementField const& field_a,
                          CalibratedCamera const& camera_b, DisplacementField const& field_b, ObjectPlane const& plane,
                          double spacing, std::optional<Dewarping> const& dewarping) {
  Footprint const a = find_footprint(camera_a.camera, field_a, plane, dewarping);
  Footprint const b = find_footprint(camera_b.camera, field_b, plane, dewarping);
  double const distance = spacing > 0.0 ? spacing : 0.5 * (a.spacing + b.spacing);
  return NodeGrid::between({std::max(a.low.x, b.low.x), std::max(a.low.y, b.low.y)},
                           {std::min(a.high.x, b.high.x), std::min(a.high.y, b.high.y)}, distance);
}

}  // namespace gladstone::inline stereo
