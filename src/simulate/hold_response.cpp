#include "simulate/hold_response.hpp"

#include "numeric/matrix_exponential.hpp"

namespace bodesmith::simulate {

void HoldResponseSolver::solve(const DrivenSystem& system, double h, const HoldNodes& nodes, double s,
                               HoldResponse& out) {
  const std::size_t n = system.order;
  const std::size_t width = nodes.size();
  const std::size_t input_count = system.inputs.size();
  const bool constant = system.constant != nullptr;
  const std::size_t size = n + input_count * width + (constant ? 1 : 0);
  out.e.assign(n * n, 0.0);
  out.g.assign(input_count, std::vector<double>(n * width, 0.0));
  out.k.assign(n, 0.0);
  if (n == 0) return;
  matrix_.assign(size * size, 0.0);
  const auto at = [&](std::size_t i, std::size_t j) -> double& { return matrix_[i * size + j]; };
  // Time runs from 0 to 1 over the hold; v = sum a_k s^k/k! is the first of a chain of integrators.
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) at(i, j) = system.a[i * n + j] * h * s;
    for (std::size_t q = 0; q < input_count; ++q) at(i, n + q * width) = system.inputs[q][i] * h * s;
    if (constant) at(i, size - 1) = system.constant[i] * h * s;
  }
  for (std::size_t q = 0; q < input_count; ++q) {
    for (std::size_t k = 0; k + 1 < width; ++k) at(n + q * width + k, n + q * width + k + 1) = s;
  }
  matrix_exponential(matrix_.data(), static_cast<int>(size), work_);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) out.e[i * n + j] = at(i, j);
    for (std::size_t q = 0; q < input_count; ++q) {
      double factorial = 1.0;
      for (std::size_t k = 0; k < width; ++k) {
        if (k > 0) factorial *= static_cast<double>(k);
        const double weight = at(i, n + q * width + k) * factorial;
        for (std::size_t j = 0; j < width; ++j) out.g[q][i * width + j] += weight * nodes.monomial[k][j];
      }
    }
    if (constant) out.k[i] = at(i, size - 1);
  }
}

}  // namespace bodesmith::simulate
