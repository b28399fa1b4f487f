#include "analysis/calibration/linear_pinhole.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/QR>
#include <cmath>

namespace gladstone::inline calibration {
namespace {

using Camera = Eigen::Matrix<double, 3, 4>;

/// Returns the similarity transform (homogeneous coordinates) that shifts the mean of the points to 0 and scales their
/// mean distance from 0 to 1.
/// @param points  one point per column
Eigen::MatrixXd normalisation(Eigen::MatrixXd const& points) {
  Eigen::Index const size = points.rows();
  Eigen::VectorXd const mean = points.rowwise().mean();
  double const scale = 1 / (points.colwise() - mean).colwise().norm().mean();
  Eigen::MatrixXd similarity = scale * Eigen::MatrixXd::Identity(size + 1, size + 1);
  similarity(size, size) = 1;
  similarity.col(size).head(size) = -scale * mean;
  return similarity;
}

Eigen::MatrixXd world_matrix(CalibrationPoints const& points) {
  Eigen::MatrixXd world(3, static_cast<Eigen::Index>(points.size()));
  Eigen::Index column = 0;
  for (Vec3d const& point : points.world) world.col(column++) << point.x, point.y, point.z;
  return world;
}

Eigen::MatrixXd pixels_of(CalibrationPoints const& points) {
  Eigen::MatrixXd pixels(2, static_cast<Eigen::Index>(points.size()));
  Eigen::Index column = 0;
  for (Vec2d const& pixel : points.pixel) pixels.col(column++) << pixel.x, pixel.y;
  return pixels;
}

/// Returns the projection matrix, with the sign for which the third homogeneous coordinate (the depth) of the points is
/// positive.
Camera projection(CalibrationPoints const& points) {
  Eigen::MatrixXd const world = world_matrix(points), pixels = pixels_of(points);
  Eigen::MatrixXd const of_world = normalisation(world), of_pixels = normalisation(pixels);
  Eigen::MatrixXd const X = of_world * world.colwise().homogeneous(), x = of_pixels * pixels.colwise().homogeneous();
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(2 * X.cols(), 12);
  for (Eigen::Index i = 0; i < X.cols(); ++i) {
    for (Eigen::Index k = 0; k < 2; ++k) {
      rows.row(2 * i + k).segment(4 * k, 4) = X.col(i).transpose();
      rows.row(2 * i + k).segment(8, 4) = -x(k, i) * X.col(i).transpose();
    }
  }
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> const solver(rows.transpose() * rows);
  Eigen::VectorXd const p = solver.eigenvectors().col(0);
  Camera normal;
  for (Eigen::Index k = 0; k < 3; ++k) normal.row(k) = p.segment(4 * k, 4).transpose();
  Eigen::MatrixXd const camera = of_pixels.inverse() * normal * of_world;
  Eigen::VectorXd const mean = world.rowwise().mean();
  return camera.row(2).dot(mean.homogeneous()) < 0 ? Camera(-camera) : Camera(camera);
}

}  // namespace

PinholeCamera linear_pinhole(CalibrationPoints const& points) {
  Camera const camera = projection(points);
  // Split K (R | t) by an RQ decomposition: QR of the transpose with rows and columns reversed.
  Eigen::Matrix3d flip;
  flip << 0, 0, 1, 0, 1, 0, 1, 0, 0;
  Eigen::Matrix3d const turned = (flip * camera.leftCols<3>()).transpose();
  Eigen::HouseholderQR<Eigen::Matrix3d> const qr(turned);
  Eigen::Matrix3d const upper = qr.matrixQR().triangularView<Eigen::Upper>(), q = qr.householderQ();
  Eigen::Matrix3d K = flip * upper.transpose() * flip, R = flip * q.transpose();
  for (int i = 0; i < 3; ++i) {
    if (K(i, i) > 0) continue;
    K.col(i) = -K.col(i);
    R.row(i) = -R.row(i);
  }
  Eigen::Vector3d t = K.inverse() * camera.col(3);
  if (R.determinant() < 0) {  // the sign of a projection matrix is arbitrary
    R = -R;
    t = -t;
  }
  Eigen::AngleAxisd const turn(R);
  Eigen::Vector3d const r = turn.angle() * turn.axis();
  double const scale = K(2, 2);
  return {{K(0, 0) / scale, K(1, 1) / scale, K(0, 2) / scale, K(1, 2) / scale, 0, 0, 0, 0, r(0), r(1), r(2), t(0), t(1),
           t(2)}};
}

double linear_residual_px(CalibrationPoints const& points) {
  Eigen::MatrixXd const seen = projection(points) * world_matrix(points).colwise().homogeneous();
  Eigen::MatrixXd const fitted = seen.colwise().hnormalized();
  return (pixels_of(points) - fitted).norm() / std::sqrt(static_cast<double>(fitted.size()));
}

bool on_one_plane(CalibrationPoints const& points) {
  Eigen::MatrixXd world = world_matrix(points);
  Eigen::VectorXd const mean = world.rowwise().mean();
  world.colwise() -= mean;
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> const solver(world * world.transpose());
  return solver.eigenvalues()(0) < 1e-12 * solver.eigenvalues()(2);
}

}  // namespace gladstone::inline calibration
