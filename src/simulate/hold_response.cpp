#include "simulate/hold_response.hpp"

#include "numeric/matrix_exponential.hpp"

namespace bodesmith::simulate {

void HoldResponseSolver::solve(const StateSpace& system, const std::vector<const double*>& inputs, double h,
                               const HoldNodes& nodes, double s, HoldResponse& out) {
  const int n = static_cast<int>(system.order());
  const int p = nodes.degree;
  const int q_count = static_cast<int>(inputs.size());
  const bool constant = !system.constant.empty();
  const int size = n + q_count * (p + 1) + (constant ? 1 : 0);
  out.order = n;
  out.e.assign(static_cast<size_t>(n * n), 0.0);
  out.g.assign(inputs.size(), std::vector<double>(static_cast<size_t>(n * (p + 1)), 0.0));
  out.k.assign(static_cast<size_t>(n), 0.0);
  if (n == 0) return;
  matrix_.assign(static_cast<size_t>(size * size), 0.0);
  const auto at = [&](int i, int j) -> double& { return matrix_[static_cast<size_t>(i * size + j)]; };
  // Time runs from 0 to 1 over the hold; v = sum a_k s^k/k! is the first of a chain of integrators.
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) at(i, j) = system.a[static_cast<size_t>(i * n + j)] * h * s;
    for (int q = 0; q < q_count; ++q) at(i, n + q * (p + 1)) = inputs[static_cast<size_t>(q)][i] * h * s;
    if (constant) at(i, size - 1) = system.constant[static_cast<size_t>(i)] * h * s;
  }
  for (int q = 0; q < q_count; ++q) {
    for (int k = 0; k < p; ++k) at(n + q * (p + 1) + k, n + q * (p + 1) + k + 1) = s;
  }
  matrix_exponential(matrix_.data(), size, work_);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) out.e[static_cast<size_t>(i * n + j)] = at(i, j);
    for (int q = 0; q < q_count; ++q) {
      double factorial = 1.0;
      for (int k = 0; k <= p; ++k) {
        if (k > 0) factorial *= k;
        const double weight = at(i, n + q * (p + 1) + k) * factorial;
        for (int j = 0; j <= p; ++j) {
          out.g[static_cast<size_t>(q)][static_cast<size_t>(i * (p + 1) + j)] +=
              weight * nodes.monomial[k][j];
        }
      }
    }
    if (constant) out.k[static_cast<size_t>(i)] = at(i, size - 1);
  }
}

}  // namespace bodesmith::simulate
