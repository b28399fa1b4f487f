#include "analysis/tracking/dot_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "render/base/contracts.h"

namespace gladstone::inline tracking {
namespace {

constexpr double smallest_variance = 0.02;  // lower bound of a dot's second moments [px^2]
constexpr int most_iterations = 40;
// largest component of the scaled gradient at which the fit has converged [1]
constexpr double gradient_tolerance = 1e-9;
// relative change of the sum of squares at which the fit has converged [1]
constexpr double cost_tolerance = 1e-7;
constexpr double parameter_tolerance = 1e-7;  // relative change of the parameters at which the fit has converged [1]

/// Returns the residual whose square is -2 ln of Student's t density with four degrees of freedom, apart from a factor
/// of 4/5 and a constant. It equals z near zero and increases only as the root of a logarithm for large z.
double student_residual(double z) { return std::copysign(2 * std::sqrt(std::log1p(0.25 * z * z)), z); }

double student_slope(double z) {
  double const residual = student_residual(z);
  return std::abs(z) < 1e-4 ? 1.0 : z / (residual * (1 + 0.25 * z * z));
}

/// Residuals of a joint fit. Positions are relative to the first dot and levels to the largest flux, so that the
/// parameters have the same order of magnitude.
class JointDotCost {
 public:
  JointDotCost(std::span<FitPixel const> pixels, std::span<GaussianDot const> start, DotShape shape,
               DotPrior const& prior)
      : pixels_(pixels), box_(bounding_box(pixels)), count_(start.size()), shape_(shape), prior_(prior) {
    origin_ = start.front().centre;
    for (GaussianDot const& dot : start) scale_ = std::max(scale_, std::abs(dot.flux));
  }

  int per_dot() const { return 3 + shape_parameters(shape_); }
  int parameter_count() const { return static_cast<int>(count_) * per_dot() + 1; }
  int residual_count() const {
    return static_cast<int>(pixels_.size()) + static_cast<int>(count_) * (shape_parameters(shape_) + 1);
  }
  double scale() const { return scale_; }

  Eigen::VectorXd parameters(std::span<GaussianDot const> dots) const {
    Eigen::VectorXd x = Eigen::VectorXd::Zero(parameter_count());
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

  GaussianDot dot(Eigen::VectorXd const& x, std::size_t k) const {
    double const* const p = x.data() + k * per_dot();
    GaussianDot dot{origin_ + Vec2d{p[0], p[1]}, p[2] * scale_, p[3], 0, p[3]};
    if (shape_ == DotShape::elliptic) {
      dot.xy = p[4];
      dot.yy = p[5];
    }
    return dot;
  }

  /// Sets the parameters at which residuals and derivatives are evaluated.
  /// @return false if a parameter is out of range; residuals and derivatives must not be evaluated in that case
  bool set(Eigen::VectorXd const& x) {
    background_ = x[x.size() - 1] * scale_;
    dots_.clear();
    lights_.clear();
    for (std::size_t k = 0; k < count_; ++k) {
      GaussianDot const one = dot(x, k);
      Vec2d const moved = one.centre - origin_;
      bool const valid = one.xx > smallest_variance && one.yy > smallest_variance && one.xx < 1e6 && one.yy < 1e6 &&
                         one.xy * one.xy < 0.9 * one.xx * one.yy && std::abs(moved.x) < 1e4 && std::abs(moved.y) < 1e4;
      if (!valid) return false;
      dots_.push_back(one);
      lights_.emplace_back(one, shape_, prior_.profile, box_);
    }
    return true;
  }

  /// Computes the residuals at the parameters of set(): first the residuals of the pixels, then those of each dot's
  /// priors.
  void residuals(Eigen::VectorXd& values) const {
    for (std::size_t i = 0; i < pixels_.size(); ++i) {
      FitPixel const& pixel = pixels_[i];
      double level = background_ - pixel.level;
      for (DotLight const& light : lights_) level += light.at(pixel.column, pixel.row).value;
      values[static_cast<Eigen::Index>(i)] = level * pixel.per_sigma;
    }
    auto row = static_cast<Eigen::Index>(pixels_.size());
    for (GaussianDot const& one : dots_) {
      std::array<double, 3> const shape{one.xx, one.xy, one.yy};
      for (int s = 0; s < shape_parameters(shape_); ++s) values[row++] = (shape[s] - prior_.mean[s]) / prior_.sigma[s];
      values[row++] = prior_.flux_sigma > 0 ? student_residual(flux_deviation(one)) : 0.0;
    }
  }

  /// Computes the derivatives of the residuals with respect to the parameters.
  void jacobian(Eigen::MatrixXd& values) const {
    int const shapes = shape_parameters(shape_);
    values.setZero();
    for (std::size_t i = 0; i < pixels_.size(); ++i)
      values(static_cast<Eigen::Index>(i), values.cols() - 1) = scale_ * pixels_[i].per_sigma;
    auto row = static_cast<Eigen::Index>(pixels_.size());
    for (std::size_t k = 0; k < count_; ++k) {
      Eigen::Index const first = static_cast<Eigen::Index>(k) * per_dot();
      for (std::size_t i = 0; i < pixels_.size(); ++i) {
        FitPixel const& pixel = pixels_[i];
        DotLevel const level = lights_[k].at(pixel.column, pixel.row);
        auto const at = static_cast<Eigen::Index>(i);
        values(at, first) = level.by_x * pixel.per_sigma;
        values(at, first + 1) = level.by_y * pixel.per_sigma;
        values(at, first + 2) = level.by_flux * scale_ * pixel.per_sigma;
        for (int s = 0; s < shapes; ++s) values(at, first + 3 + s) = level.by_shape[s] * pixel.per_sigma;
      }
      for (int s = 0; s < shapes; ++s) values(row++, first + 3 + s) = 1 / prior_.sigma[s];
      if (prior_.flux_sigma > 0)
        values(row, first + 2) = student_slope(flux_deviation(dots_[k])) * scale_ / prior_.flux_sigma;
      ++row;
    }
  }

 private:
  double flux_deviation(GaussianDot const& one) const { return (one.flux - prior_.flux_mean) / prior_.flux_sigma; }

  std::span<FitPixel const> pixels_;
  PixelBox box_;
  std::size_t count_;
  DotShape shape_;
  DotPrior const& prior_;
  Vec2d origin_{};
  double scale_ = std::numeric_limits<double>::min();
  // Values for the parameters of the last set():
  double background_ = 0;
  std::vector<GaussianDot> dots_;
  std::vector<DotLight> lights_;
};

/// Least-squares fit of the parameters of a JointDotCost by the method of Levenberg and Marquardt, with Jacobi scaling
/// and the damping of Madsen, Nielsen & Tingleff, "Methods for non-linear least squares problems" (2004), like
/// ceres::TinySolver. Unlike TinySolver, it computes the light of accepted parameters once for residuals and
/// derivatives, and stops early if the cost is not expected to fall below a given limit.
class JointFit {
 public:
  /// @param cost  must outlive this object
  explicit JointFit(JointDotCost& cost)
      : cost_(cost),
        residuals_(cost.residual_count()),
        jacobian_(cost.residual_count(), cost.parameter_count()),
        normal_(Eigen::MatrixXd::Zero(cost.parameter_count(), cost.parameter_count())),
        gradient_(cost.parameter_count()) {}

  /// Minimises the sum of squares. @return false if the minimum exceeds most_cost, or if the start values are out of
  /// range
  bool run(Eigen::VectorXd& x, double most_cost) {
    if (!cost_.set(x)) return false;
    cost_.residuals(residuals_);
    squares_ = residuals_.squaredNorm();
    linearise();
    scaling_ = (1.0 + normal_.diagonal().array().sqrt()).inverse();
    scale();
    double damping = 1e-4, growth = 2;
    Eigen::VectorXd trial_residuals(residuals_.size());
    Eigen::MatrixXd regular;
    for (int iteration = 1; iteration < most_iterations; ++iteration) {
      if (gradient_.lpNorm<Eigen::Infinity>() < gradient_tolerance) break;
      regular = normal_;
      regular.diagonal().array() += damping * normal_.diagonal().array().max(1e-6);
      Eigen::LLT<Eigen::MatrixXd> const solver(regular);
      Eigen::VectorXd const step = solver.solve(gradient_), change = scaling_.cwiseProduct(step);
      if (change.norm() < parameter_tolerance * (x.norm() + parameter_tolerance)) break;
      Eigen::VectorXd const trial = x + change;
      double decrease = -std::numeric_limits<double>::infinity();
      if (solver.info() == Eigen::Success && cost_.set(trial)) {
        cost_.residuals(trial_residuals);
        decrease = squares_ - trial_residuals.squaredNorm();
      }
      double const expected = step.dot(2 * gradient_ - normal_.selfadjointView<Eigen::Lower>() * step);
      double const gain = decrease / expected;
      bool const accepted = gain > 0;
      if (accepted) {
        x = trial;
        residuals_.swap(trial_residuals);
        squares_ -= decrease;
      }
      if (std::abs(decrease) < cost_tolerance) break;
      if (!accepted) {
        damping *= growth;
        growth *= 2;
        continue;
      }
      if (iteration >= 4 && squares_ - most_cost > hopeless * decrease) return false;
      linearise();
      scale();
      damping *= std::max(1.0 / 3, 1 - std::pow(2 * gain - 1, 3));
      growth = 2;
    }
    return residuals_.squaredNorm() <= most_cost;
  }

 private:
  /// Multiple of the last decrease of the cost. The fit is stopped if its cost exceeds the limit by more than this: if
  /// each decrease is 5 % smaller than the previous one, all further decreases sum to 20 times the last one.
  static constexpr double hopeless = 20;

  /// Computes the lower triangle of the normal equations at the parameters of the last JointDotCost::set().
  void linearise() {
    cost_.jacobian(jacobian_);
    for (Eigen::Index j = 0; j < normal_.cols(); ++j) {
      for (Eigen::Index i = j; i < normal_.rows(); ++i) normal_(i, j) = jacobian_.col(i).dot(jacobian_.col(j));
      gradient_[j] = -jacobian_.col(j).dot(residuals_);
    }
  }

  void scale() {
    normal_ = scaling_.asDiagonal() * normal_ * scaling_.asDiagonal();
    gradient_ = scaling_.cwiseProduct(gradient_);
  }

  JointDotCost& cost_;
  Eigen::VectorXd residuals_;
  Eigen::MatrixXd jacobian_, normal_;
  Eigen::VectorXd gradient_, scaling_;
  double squares_ = 0;
};

}  // namespace

PixelBox bounding_box(std::span<FitPixel const> pixels) {
  PixelBox box{pixels.front().column, pixels.front().column, pixels.front().row, pixels.front().row};
  for (FitPixel const& pixel : pixels) {
    box.left = std::min(box.left, pixel.column);
    box.right = std::max(box.right, pixel.column);
    box.top = std::min(box.top, pixel.row);
    box.bottom = std::max(box.bottom, pixel.row);
  }
  return box;
}

DotFit fit_dots(std::span<FitPixel const> pixels, std::span<GaussianDot const> start, DotShape shape,
                DotPrior const& prior, double most_cost) {
  GLADSTONE_EXPECTS(!pixels.empty() && !start.empty());
  JointDotCost cost(pixels, start, shape, prior);
  Eigen::VectorXd x = cost.parameters(start);
  bool const fitted = JointFit(cost).run(x, most_cost);

  DotFit fit;
  for (std::size_t k = 0; k < start.size(); ++k) fit.dots.push_back(cost.dot(x, k));
  fit.background = x[x.size() - 1] * cost.scale();
  fit.cost = std::numeric_limits<double>::infinity();
  if (!fitted || !x.allFinite() || !cost.set(x)) return fit;
  Eigen::VectorXd residuals(cost.residual_count());
  Eigen::MatrixXd jacobian(cost.residual_count(), cost.parameter_count());
  cost.residuals(residuals);
  cost.jacobian(jacobian);
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
    fit.residual.push_back(-residuals[static_cast<Eigen::Index>(i)] / pixels[i].per_sigma);
    if (start.size() == 1) fit.leverage.push_back(row.dot(row * covariance));
  }
  return fit;
}

}  // namespace gladstone::inline tracking
