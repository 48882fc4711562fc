#include "simulate/hold_response.hpp"

#include <cmath>

#include "numeric/linear_algebra/dense.hpp"

namespace bodesmith::simulate {
namespace {

HoldNodes nodes_of_degree(std::size_t degree) {
  HoldNodes n;
  n.degree = degree;
  const double r = std::sqrt(1.0 / 5.0);
  const double q = std::sqrt(3.0 / 7.0);
  switch (degree) {
    case 1:
      n.at = {0.0, 1.0};
      break;
    case 3:
      n.at = {0.0, 0.5 - 0.5 * r, 0.5 + 0.5 * r, 1.0};
      break;
    default:
      n.at = {0.0, 0.5 - 0.5 * q, 0.5, 0.5 + 0.5 * q, 1.0};
      break;
  }
  for (std::size_t j = 0; j <= degree; ++j) {
    // Lagrange polynomial of node j, multiplied out.
    std::array<double, kMaxDegree + 2> c{};
    c[0] = 1.0;
    std::size_t order = 0;
    for (std::size_t i = 0; i <= degree; ++i) {
      if (i == j) continue;
      const double scale = 1.0 / (n.at[j] - n.at[i]);
      for (std::size_t k = order + 2; k-- > 0;) c[k] = ((k > 0 ? c[k - 1] : 0.0) - n.at[i] * c[k]) * scale;
      ++order;
    }
    for (std::size_t k = 0; k <= degree; ++k) n.monomial[k][j] = c[k];
    n.scale[j] = c[degree];
  }
  return n;
}

}  // namespace

void HoldNodes::weights(double s, double* out) const {
  for (std::size_t j = 0; j <= degree; ++j) {
    double w = scale[j];
    for (std::size_t i = 0; i <= degree; ++i) {
      if (i != j) w *= s - at[i];
    }
    out[j] = w;
  }
}

double HoldNodes::value(const double* nodes, double s) const {
  if (degree == 1) return nodes[0] + s * (nodes[1] - nodes[0]);
  double w[kMaxDegree + 1];
  weights(s, w);
  double sum = 0.0;
  for (std::size_t j = 0; j <= degree; ++j) sum += w[j] * nodes[j];
  return sum;
}

double HoldNodes::slope(const double* nodes, double s) const {
  double sum = 0.0;
  for (std::size_t k = degree; k >= 1; --k) {
    double c = 0.0;
    for (std::size_t j = 0; j <= degree; ++j) c += monomial[k][j] * nodes[j];
    sum = sum * s + static_cast<double>(k) * c;
  }
  return sum;
}

const HoldNodes& hold_nodes(std::size_t degree) {
  static const HoldNodes straight = nodes_of_degree(1), cubic = nodes_of_degree(3),
                         quartic = nodes_of_degree(4);
  return degree == 1 ? straight : degree == 3 ? cubic : quartic;
}

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
