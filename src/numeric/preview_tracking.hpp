#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace bodesmith {

/// A sampled linear system whose input is a straight line between samples: with z_i = (x_i, u_i, u_{i-1}),
///   z_{i+1} = a_i z_i + b_i u_{i+1},   y_i = g_i z_i.
/// The last two rows of a and b carry u along.
struct PreviewSystem {
  std::vector<Eigen::MatrixXd> a;  ///< one a step, or a single one that all steps share
  std::vector<Eigen::VectorXd> b;
  std::vector<Eigen::VectorXd> g;  ///< one a sample, or a single one

  const Eigen::MatrixXd& a_at(std::size_t i) const { return a.size() == 1 ? a[0] : a[i]; }
  const Eigen::VectorXd& b_at(std::size_t i) const { return b.size() == 1 ? b[0] : b[i]; }
  const Eigen::VectorXd& g_at(std::size_t i) const { return g.size() == 1 ? g[0] : g[i]; }
  /// z behind the first `steps` steps of the input u.
  Eigen::VectorXd state_after(Eigen::VectorXd z, const std::vector<double>& u, std::size_t steps) const;
};

/// Weights of the parts of
///   sum q_i (y_i - e_i)² + curvature (u_{i+1} - 2 u_i + u_{i-1} + d_i)² + value (u_i - v_i)²
///       + rate (u_{i+1} - u_i - w_i)².
struct PreviewWeights {
  std::vector<double> q;  ///< one a sample
  double curvature = 0.0;
  double value = 0.0;
  double rate = 0.0;
};

/// What u should be near to, each one a sample (d and w one a step); empty: zeros.
struct PreviewTargets {
  std::vector<double> e;
  std::vector<double> d;
  std::vector<double> v;
  std::vector<double> w;
};

/// The input that minimises the sum above, with all of the future known: the Riccati recursion of linear-quadratic
/// tracking (Anderson and Moore, Optimal Control: Linear Quadratic Methods, 1990, chapter 4), backwards once for the
/// weights and once more for each set of targets. Where the system's inverse is unstable (zeros outside the unit
/// circle) that is its bounded two-sided inverse.
class PreviewTracking {
 public:
  /// `system` must outlive this.
  PreviewTracking(const PreviewSystem& system, PreviewWeights weights);

  /// u for every sample. z_0 = `start` u_0 + `fixed`; u_0 is free when `start` is not empty.
  std::vector<double> solve(const PreviewTargets& targets, const Eigen::VectorXd& start,
                            const Eigen::VectorXd& fixed) const;

 private:
  const PreviewSystem& system_;
  PreviewWeights weights_;
  std::vector<Eigen::VectorXd> h_;  ///< of the quadratic h z u_{i+1} in the cost to go
  std::vector<double> curvature_;   ///< of u_{i+1}² in it
  Eigen::MatrixXd p0_;
};

}  // namespace bodesmith
