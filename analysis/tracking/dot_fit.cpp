#include "analysis/tracking/dot_fit.h"

#include <ceres/tiny_solver.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "render/base/contracts.h"

namespace gladstone::tracking {
namespace {

constexpr double smallest_variance = 0.02;  // [px^2]
constexpr double forbidden = 1e10;          // residual of parameters outside of their range

/// Residual whose square is -2 ln of Student's t density with four degrees of freedom, up to a factor of 4/5 and a
/// constant: z near zero, growing as the root of a logarithm.
double student_residual(double z) { return std::copysign(2 * std::sqrt(std::log1p(0.25 * z * z)), z); }

double student_slope(double z) {
  double const residual = student_residual(z);
  return std::abs(z) < 1e-4 ? 1.0 : z / (residual * (1 + 0.25 * z * z));
}

/// Residuals of a joint fit, for ceres::TinySolver. Positions are relative to the first dot and levels to the largest
/// flux, so that the parameters have the same order of magnitude.
class JointDotCost {
 public:
  using Scalar = double;
  enum { NUM_RESIDUALS = Eigen::Dynamic, NUM_PARAMETERS = Eigen::Dynamic };
  using Parameters = Eigen::VectorXd;

  JointDotCost(std::span<FitPixel const> pixels, std::span<GaussianDot const> start, DotShape shape,
               DotPrior const& prior)
      : pixels_(pixels), count_(start.size()), shape_(shape), prior_(prior) {
    origin_ = start.front().centre;
    for (GaussianDot const& dot : start) scale_ = std::max(scale_, std::abs(dot.flux));
  }

  int per_dot() const { return 3 + shape_parameters(shape_); }
  int NumParameters() const { return static_cast<int>(count_) * per_dot() + 1; }
  int NumResiduals() const {
    return static_cast<int>(pixels_.size()) + static_cast<int>(count_) * (shape_parameters(shape_) + 1);
  }
  double scale() const { return scale_; }

  Parameters parameters(std::span<GaussianDot const> dots) const {
    Parameters x = Parameters::Zero(NumParameters());
    for (std::size_t k = 0; k < count_; ++k) {
      double* const p = x.data() + k * per_dot();
      p[0] = dots[k].centre.x - origin_.x;
      p[1] = dots[k].centre.y - origin_.y;
      p[2] = dots[k].flux / scale_;
      p[3] = dots[k].xx;
      if (shape_ == DotShape::elliptic) {
        p[4] = dots[k].xy;
        p[5] = dots[k].yy;
      }
    }
    return x;
  }

  GaussianDot dot(double const* x, std::size_t k) const {
    double const* const p = x + k * per_dot();
    GaussianDot dot{origin_ + Vec2d{p[0], p[1]}, p[2] * scale_, p[3], 0, p[3]};
    if (shape_ == DotShape::elliptic) {
      dot.xy = p[4];
      dot.yy = p[5];
    }
    return dot;
  }

  bool operator()(double const* x, double* residuals, double* jacobian) const {
    int const rows = NumResiduals(), columns = NumParameters(), shapes = shape_parameters(shape_);
    if (jacobian) std::fill_n(jacobian, static_cast<std::size_t>(rows) * columns, 0.0);
    auto const derivative = [&](std::size_t row, std::size_t column) -> double& {
      return jacobian[column * static_cast<std::size_t>(rows) + row];
    };
    double const background = x[columns - 1] * scale_;
    for (std::size_t i = 0; i < pixels_.size(); ++i) {
      residuals[i] = (background - pixels_[i].level) * pixels_[i].per_sigma;
      if (jacobian) derivative(i, columns - 1) = scale_ * pixels_[i].per_sigma;
    }
    for (std::size_t k = 0; k < count_; ++k) {
      GaussianDot const one = dot(x, k);
      bool const valid = one.xx > smallest_variance && one.yy > smallest_variance && one.xx < 1e6 && one.yy < 1e6 &&
                         one.xy * one.xy < 0.9 * one.xx * one.yy && std::abs(x[k * per_dot()]) < 1e4 &&
                         std::abs(x[k * per_dot() + 1]) < 1e4;
      if (!valid) {
        std::fill_n(residuals, rows, forbidden);
        return false;
      }
      DotLight const light(one, shape_, prior_.profile);
      std::size_t const first = k * per_dot();
      for (std::size_t i = 0; i < pixels_.size(); ++i) {
        FitPixel const& pixel = pixels_[i];
        DotLevel const level = light.at(pixel.column, pixel.row);
        residuals[i] += level.value * pixel.per_sigma;
        if (!jacobian) continue;
        derivative(i, first) = level.by_x * pixel.per_sigma;
        derivative(i, first + 1) = level.by_y * pixel.per_sigma;
        derivative(i, first + 2) = level.by_flux * scale_ * pixel.per_sigma;
        for (int s = 0; s < shapes; ++s) derivative(i, first + 3 + s) = level.by_shape[s] * pixel.per_sigma;
      }
      for (int s = 0; s < shapes; ++s) {
        std::size_t const row = pixels_.size() + k * (shapes + 1) + s;
        residuals[row] = (x[first + 3 + s] - prior_.mean[s]) / prior_.sigma[s];
        if (jacobian) derivative(row, first + 3 + s) = 1 / prior_.sigma[s];
      }
      std::size_t const row = pixels_.size() + k * (shapes + 1) + shapes;
      residuals[row] = 0;
      if (!(prior_.flux_sigma > 0)) continue;
      double const z = (one.flux - prior_.flux_mean) / prior_.flux_sigma;
      residuals[row] = student_residual(z);
      if (jacobian) derivative(row, first + 2) = student_slope(z) * scale_ / prior_.flux_sigma;
    }
    return true;
  }

 private:
  std::span<FitPixel const> pixels_;
  std::size_t count_;
  DotShape shape_;
  DotPrior const& prior_;
  Vec2d origin_{};
  double scale_ = std::numeric_limits<double>::min();
};

}  // namespace

DotFit fit_dots(std::span<FitPixel const> pixels, std::span<GaussianDot const> start, DotShape shape,
                DotPrior const& prior) {
  GLADSTONE_EXPECTS(!pixels.empty() && !start.empty());
  JointDotCost const cost(pixels, start, shape, prior);
  JointDotCost::Parameters x = cost.parameters(start);
  ceres::TinySolver<JointDotCost> solver;
  solver.options.max_num_iterations = 40;
  solver.options.gradient_tolerance = 1e-9;
  solver.options.function_tolerance = 1e-7;
  solver.options.parameter_tolerance = 1e-7;
  solver.Solve(cost, &x);

  DotFit fit;
  for (std::size_t k = 0; k < start.size(); ++k) fit.dots.push_back(cost.dot(x.data(), k));
  fit.background = x[x.size() - 1] * cost.scale();
  Eigen::VectorXd residuals(cost.NumResiduals());
  Eigen::MatrixXd jacobian(cost.NumResiduals(), cost.NumParameters());
  fit.cost = std::numeric_limits<double>::infinity();
  if (!x.allFinite() || !cost(x.data(), residuals.data(), jacobian.data())) return fit;
  Eigen::LDLT<Eigen::MatrixXd> const information(jacobian.transpose() * jacobian);
  if (information.info() != Eigen::Success || !information.isPositive() || !(information.rcond() > 1e-13)) return fit;
  Eigen::MatrixXd const covariance = information.solve(Eigen::MatrixXd::Identity(x.size(), x.size()));
  for (std::size_t k = 0; k < start.size(); ++k) {
    auto const first = static_cast<Eigen::Index>(k) * cost.per_dot();
    fit.sigma.push_back({std::sqrt(covariance(first, first)), std::sqrt(covariance(first + 1, first + 1))});
    fit.flux_sigma.push_back(std::sqrt(covariance(first + 2, first + 2)) * cost.scale());
  }
  fit.cost = residuals.squaredNorm();
  fit.chi2 = residuals.head(static_cast<Eigen::Index>(pixels.size())).squaredNorm();
  fit.freedom = static_cast<int>(pixels.size()) - 3 * static_cast<int>(start.size()) - 1;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    auto const row = jacobian.row(static_cast<Eigen::Index>(i));
    fit.residual.push_back(-residuals[i] / pixels[i].per_sigma);
    fit.leverage.push_back(row.dot(row * covariance));
  }
  return fit;
}

}  // namespace gladstone::tracking
