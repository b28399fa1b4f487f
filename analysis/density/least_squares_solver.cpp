#include "analysis/density/least_squares_solver.h"

#include <fmt/format.h>

#include <utility>

#include "render/base/error.h"

namespace gladstone::density {

NormalEquations::NormalEquations(Matrix matrix, std::size_t direct_limit) : matrix_(std::move(matrix)) {
  if (static_cast<std::size_t>(matrix_.rows()) <= direct_limit) {
    direct_ = std::make_unique<Direct>(matrix_);
    if (direct_->info() == Eigen::Success) return;
    throw DataError("density gradient",
                    "the equations of the density are singular (weights differ too much); check the uncertainties");
  }
  preconditioner_ = std::make_unique<Preconditioner>(matrix_);
}

Eigen::VectorXd NormalEquations::solve(Eigen::VectorXd const& right_side) const {
  if (direct_) return direct_->solve(right_side);
  // Eigen's own loop: its class ConjugateGradient keeps its state in mutable members and cannot be shared by threads
  Eigen::VectorXd x = Eigen::VectorXd::Zero(right_side.size());
  Eigen::Index iterations = 20 * 1000;
  double error = 1e-10;
  Eigen::internal::conjugate_gradient(matrix_, right_side, x, *preconditioner_, iterations, error);
  if (error <= 1e-8) return x;
  throw DataError("density gradient", fmt::format("the integration did not converge (relative residual {:.1e} after {} "
                                                  "iterations); check the uncertainties, or use fewer vectors",
                                                  error, iterations));
}

}  // namespace gladstone::density
