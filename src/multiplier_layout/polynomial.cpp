#include "multiplier_layout/polynomial.hpp"

#include <algorithm>
#include <cmath>

namespace bodesmith::multiplier_layout {

double polynomial(const std::vector<double>& a, double x) {
  double out = 0.0;
  for (std::size_t k = a.size(); k-- > 0;) out = (out + a[k]) * x;
  return out;
}

double peak(const std::vector<double>& a) {
  double out = 0.0;
  for (int i = 0; i <= kPolynomialPoints; ++i)
    out = std::max(out, std::abs(polynomial(a, static_cast<double>(i) / kPolynomialPoints)));
  return out;
}

int degree(const std::vector<double>& a) {
  std::size_t n = a.size();
  while (n > 0 && a[n - 1] == 0.0) --n;
  return static_cast<int>(n);
}

}  // namespace bodesmith::multiplier_layout
