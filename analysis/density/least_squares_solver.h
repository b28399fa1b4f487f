#pragma once

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCholesky>
#include <cstddef>
#include <memory>

namespace gladstone::inline density {

/// Solver of the normal equations N x = b for many right-hand sides, with N sparse, symmetric and positive definite.
/// Sparse Cholesky factorisation (Eigen SimplicialLDLT, approximate minimum degree) up to `direct_limit` unknowns; for
/// more unknowns, conjugate gradients with an incomplete Cholesky preconditioner, to a relative residual of 1e-10.
/// Calls of solve() may run in parallel.
class NormalEquations {
 public:
  using Matrix = Eigen::SparseMatrix<double>;
  /// @throws DataError  if the factorisation fails
  NormalEquations(Matrix const& matrix, std::size_t direct_limit);
  /// @throws DataError  if the conjugate gradients do not converge
  Eigen::VectorXd solve(Eigen::VectorXd const& right_side) const;

 private:
  using Direct = Eigen::SimplicialLDLT<Matrix>;
  using Preconditioner = Eigen::IncompleteCholesky<double>;
  Matrix matrix_;
  std::unique_ptr<Direct> direct_;
  std::unique_ptr<Preconditioner> preconditioner_;
};

}  // namespace gladstone::inline density
