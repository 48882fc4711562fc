#pragma once

#include <Eigen/Core>

namespace bodesmith {

/// min 1/2 x'Qx + c'x subject to A x <= b, Q symmetric positive semidefinite (0: a linear program).
struct QuadraticProgram {
  Eigen::MatrixXd q;
  Eigen::VectorXd c;
  Eigen::MatrixXd a;
  Eigen::VectorXd b;
};

struct QuadraticProgramResult {
  Eigen::VectorXd x;
  Eigen::VectorXd multiplier;  ///< of the inequalities, >= 0
  bool solved = false;         ///< to a relative gap of 1e-9; otherwise x is the best iterate
};

/// Mehrotra's predictor-corrector interior-point method with dense normal equations: for few variables (tens)
/// and many inequalities. `x` is the start; it need not satisfy the inequalities.
QuadraticProgramResult solve_quadratic_program(const QuadraticProgram& problem, const Eigen::VectorXd& start);

}  // namespace bodesmith
