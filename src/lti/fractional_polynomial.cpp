#include "lti/fractional_polynomial.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace bodesmith {

std::complex<double> evaluate(const FractionalPolynomial& polynomial, RadPerSecond w) {
  std::complex<double> out = 0.0;
  for (const FractionalPower& term : polynomial) {
    out += term.coefficient * std::polar(std::pow(w.value, term.power), 0.5 * std::numbers::pi * term.power);
  }
  return out;
}

FractionalPolynomial collect_powers(FractionalPolynomial polynomial) {
  std::sort(polynomial.begin(), polynomial.end(),
            [](const FractionalPower& a, const FractionalPower& b) { return a.power < b.power; });
  FractionalPolynomial out;
  for (const FractionalPower& term : polynomial) {
    if (!out.empty() && std::abs(out.back().power - term.power) < 1e-12)
      out.back().coefficient += term.coefficient;
    else
      out.push_back(term);
  }
  std::erase_if(out, [](const FractionalPower& term) { return term.coefficient == 0.0; });
  return out;
}

}  // namespace bodesmith
