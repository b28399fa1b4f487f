#include "analysis/density/least_squares_solver.h"

#include <fmt/format.h>

#include "render/base/error.h"

namespace gladstone::inline density {

NormalEquations::NormalEquations(Matrix const& matrix, std::size_t direct_limit) : matrix_(matrix) {
  if (static_cast<std::size_t>(matrix_.rows()) <= direct_limit) {
    direct_ = std::make_unique<Direct>(matrix_);
    if (direct_->info() == Eigen::Success) return;
    throw DataError(ErrorCode::undetermined, "density gradient",
                    "the equations of the density are singular (the weights of the vectors differ too much); check the "
                    "uncertainties");
  }
  preconditioner_ = std::make_unique<Preconditioner>(matrix_);
}

Eigen::VectorXd NormalEquations::solve(Eigen::VectorXd const& right_side) const {
  if (direct_) return direct_->solve(right_side);
  // Preconditioned conjugate gradients. Eigen's class is not used, because it stores its state in members and cannot be
  // shared by threads.
  Eigen::VectorXd x = Eigen::VectorXd::Zero(right_side.size()), residual = right_side;
  Eigen::VectorXd preconditioned = preconditioner_->solve(residual), direction = preconditioned;
  double const goal = 1e-10 * right_side.norm();
  double product = residual.dot(preconditioned);
  for (int iteration = 0; iteration < 20'000; ++iteration) {
    if (residual.norm() <= goal) return x;
    Eigen::VectorXd const mapped = matrix_ * direction;
    double const step = product / direction.dot(mapped);
    x += step * direction;
    residual -= step * mapped;
    preconditioned = preconditioner_->solve(residual);
    double const next = residual.dot(preconditioned);
    direction = preconditioned + (next / product) * direction;
    product = next;
  }
  throw DataError(ErrorCode::undetermined, "density gradient",
                  fmt::format("the integration did not converge (relative residual {:.1e}); check "
                              "the uncertainties, or use fewer vectors",
                              residual.norm() / right_side.norm()));
}

}  // namespace gladstone::inline density
