#pragma once

#include <Eigen/Core>
#include <vector>

#include "faults/board.hpp"

namespace bodesmith::faults {

/// What was measured less what a response says: ln |H| of all points, then the phases (within half a turn) of those
/// that have one. Below Board::floors() a response says no more than "nothing".
struct Residual {
  std::vector<double> gain;
  std::vector<double> phase;  ///< of each point; 0 where none was measured
  std::vector<char> has_phase;
  std::vector<double> below_floor;  ///< 0 … 1: share of the floor in the predicted power

  Eigen::VectorXd rows() const;
};
Residual residual_of(const Board& board, const Eigen::VectorXcd& response);
/// |measured/response - 1| in percent, a point each; gains alone where no phase was measured.
std::vector<double> differences_percent(const Board& board, const Eigen::VectorXcd& response);

/// Density of the measurement under one explanation, the parts' own errors x integrated out:
///   y - ln H = S x + n,  x normal with covariance 1, n with covariance V,
/// so y is normal with S S' + V. S also holds the error of a roughly known fault, most of it smooth over frequency. V holds
/// the noise, the floor, the rest of that error, and the square of the second order of x, sum |S|^2/2, which the linear
/// form leaves out.
class Likelihood {
 public:
  /// `part_spread`: of the parts' errors, in addition to what Spread says.
  Likelihood(const Board& board, const Prediction& prediction, const Noise& noise, double part_spread = 1.0);
  /// The same about parts' errors `around` at which `prediction` was made (0 for what is no part): where the linear form
  /// about 0 is not good enough. `left` is what they left open, for the second order.
  Likelihood(const Board& board, const Prediction& prediction, const Noise& noise, double part_spread,
             const Eigen::VectorXd& around, const Likelihood& left);

  double log_density() const;
  /// Rows, without gains at the floor.
  double rows() const { return rows_; }
  /// r'(S S' + V)^-1 r: about rows() when the explanation is right.
  double misfit() const { return inner(residual_, residual_); }
  double inner(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const;
  /// log_density() of another residual under the same covariance.
  double log_density_of(const Eigen::VectorXd& residual) const;
  const Eigen::VectorXd& residual() const { return residual_; }
  /// The most likely errors of everything that differs from board to board, in standard deviations; behind them those of the
  /// prediction's model (Prediction::model_error), where it has any.
  Eigen::VectorXd errors() const;
  /// What the most likely errors of the parts leave.
  Eigen::VectorXd remaining() const;

 private:
  void set(const Board& board, const Prediction& prediction, const Noise& noise, double part_spread,
           const Likelihood* left);
  /// sum |S|^2/2 of each point; with `left`, over what it leaves open of the parts' errors.
  Eigen::VectorXd second_order(const Board& board, const Eigen::MatrixXcd& slopes,
                               const Likelihood* left) const;
  Eigen::VectorXd solved(const Eigen::VectorXd& a) const;

  Eigen::VectorXd residual_;
  Eigen::VectorXd weight_;    ///< 1/V
  Eigen::MatrixXd slopes_;    ///< S
  Eigen::MatrixXd weighted_;  ///< S'V^-1
  Eigen::MatrixXd factor_;    ///< Cholesky factor of 1 + S'V^-1 S
  double log_determinant_ = 0.0;
  double rows_ = 0.0;
};

}  // namespace bodesmith::faults
