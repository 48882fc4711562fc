#pragma once

#include <Eigen/Core>

namespace bodesmith {

/// min 1/2 x'Qx + c'x subject to A x <= b, Q symmetric positive semidefinite (0: a linear program).
struct QuadraticProgram {
  Eigen::MatrixXd q;
  Eigen::VectorXd c;
  Eigen::MatrixXd a;
  Eigen::VectorXd b;
  double gap = 1e-9;  ///< relative, at which it counts as solved
  /// Of a smallest largest error the first 2 pairs rows: row pairs + i is row i with the other sign, but for the column
  /// `level`, where both are alike.
  Eigen::Index pairs = 0;
  Eigen::Index level = 0;
};

struct QuadraticProgramResult {
  Eigen::VectorXd x;
  Eigen::VectorXd multiplier;  ///< of the inequalities, >= 0
  bool solved = false;         ///< to the relative gap asked for; otherwise x is the best iterate
};

/// Mehrotra's predictor-corrector interior-point method with dense normal equations: for few variables (tens)
/// and many inequalities. `x` is the start; it need not satisfy the inequalities.
QuadraticProgramResult solve_quadratic_program(const QuadraticProgram& problem, const Eigen::VectorXd& start);

}  // namespace bodesmith
