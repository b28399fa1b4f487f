#include "analysis/calibration/soloff_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

namespace gladstone::inline calibration {
namespace {

constexpr int cubic = 3;

double power(double base, int exponent) {
  double product = 1;
  for (int i = 0; i < exponent; ++i) product *= base;
  return product;
}

/// Returns the exponents of all terms of up to third order in which the exponent of Z is at most `most_z`.
std::vector<std::array<int, 3>> terms(int most_z) {
  std::vector<std::array<int, 3>> all;
  for (int order = 0; order <= cubic; ++order) {
    for (int z = 0; z <= std::min(order, most_z); ++z) {
      for (int y = 0; y <= order - z; ++y) all.push_back({order - z - y, y, z});
    }
  }
  return all;
}

/// Returns the mean of a term over a dot, see disc_points.
double mean_of_term(std::array<int, 3> const& term, Vec3d centre, double radius) {
  double sum = 0;
  for (Vec2d const off : disc_points) {
    sum += power(centre.x + radius * off.x, term[0]) * power(centre.y + radius * off.y, term[1]);
  }
  return 0.25 * sum * power(centre.z, term[2]);
}

}  // namespace

SoloffFit fit_soloff(CalibrationPoints const& points) {
  std::set<double> planes;
  for (Vec3d const& point : points.world) planes.insert(point.z);
  if (planes.size() < 2) throw std::invalid_argument("points on one plane do not determine the terms with Z");
  SoloffFit fit;
  fit.polynomial.exponents = terms(planes.size() == 2 ? 1 : 2);
  std::vector<std::array<int, 3>> const& exponents = fit.polynomial.exponents;
  auto const rows = static_cast<Eigen::Index>(points.size()), columns = static_cast<Eigen::Index>(exponents.size());
  if (rows <= columns) throw std::invalid_argument("too few points for a polynomial of the third order");
  Eigen::MatrixXd A(rows, columns);
  Eigen::MatrixX2d b(rows, 2);
  for (Eigen::Index row = 0; row < rows; ++row) {
    auto const k = static_cast<std::size_t>(row);
    b.row(row) << points.pixel[k].x, points.pixel[k].y;
    for (Eigen::Index column = 0; column < columns; ++column) {
      A(row, column) = mean_of_term(exponents[static_cast<std::size_t>(column)], points.world[k], points.dot_radius);
    }
  }
  Eigen::VectorXd const size = A.colwise().norm();
  Eigen::MatrixXd const scaled = A * size.cwiseInverse().asDiagonal();
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(scaled);
  qr.setThreshold(1e-10);
  if (!size.allFinite() || size.minCoeff() == 0 || qr.rank() < columns) {
    throw std::invalid_argument("the points do not determine a term of the polynomial");
  }
  Eigen::MatrixX2d const x = size.cwiseInverse().asDiagonal() * qr.solve(b);
  Eigen::MatrixX2d const left = b - A * x;
  Eigen::MatrixXd const inverse =
      (scaled.transpose() * scaled).ldlt().solve(Eigen::MatrixXd::Identity(columns, columns));
  Eigen::RowVector2d const variance = left.colwise().squaredNorm() / static_cast<double>(rows - columns);
  for (Eigen::Index i = 0; i < columns; ++i) {
    double const spread = std::sqrt(std::max(0.0, inverse(i, i))) / size(i);
    fit.polynomial.coefficients.push_back({x(i, 0), x(i, 1)});
    fit.standard_error.push_back({spread * std::sqrt(variance(0)), spread * std::sqrt(variance(1))});
  }
  for (Eigen::Index i = 0; i < rows; ++i) fit.residual_px.push_back({left(i, 0), left(i, 1)});
  fit.rms_px = std::sqrt(left.squaredNorm() / (2.0 * static_cast<double>(rows)));
  return fit;
}

}  // namespace gladstone::inline calibration
