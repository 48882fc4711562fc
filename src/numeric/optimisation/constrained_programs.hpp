#pragma once

#include <Eigen/Core>

namespace bodesmith {

/// The smallest t + cost'x with |error + slope x| <= t at every row, lower <= x <= upper and A x <= b: Chebyshev's problem
/// in first order. The bounds of a number that costs something and moves no error may be infinite above.
struct LevelProgram {
  Eigen::VectorXd error;
  Eigen::MatrixXd slope;
  Eigen::VectorXd cost;  ///< empty: none
  Eigen::VectorXd lower;
  Eigen::VectorXd upper;
  Eigen::MatrixXd a;
  Eigen::VectorXd b;
};

struct LevelResult {
  Eigen::VectorXd x;
  double level = 0.0;
  bool solved = false;  ///< otherwise x is of no use: rounding, or too many exchanges
};

/// The dual simplex method: a vertex of as many rows and bounds as there are unknowns, from which the row that is violated most
/// takes the place of one of them until none is (Stiefel's exchange, Numer. Math. 1 (1959) 1, with bounds). For few unknowns
/// (tens) and many rows: an exchange looks at those rows only that have stuck out once, and at all where none of them does.
LevelResult solve_least_level(const LevelProgram& program);

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
