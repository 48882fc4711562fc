#include "simulate/hold_nodes.hpp"

#include <cmath>
#include <stdexcept>

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
    case 2:
      n.at = {0.0, 0.5, 1.0};
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
  static const std::array<HoldNodes, kMaxDegree> all = {nodes_of_degree(1), nodes_of_degree(2),
                                                        nodes_of_degree(3), nodes_of_degree(4)};
  if (degree < 1 || degree > kMaxDegree) throw std::logic_error("hold degree out of range");
  return all[degree - 1];
}

}  // namespace bodesmith::simulate
