#include "fpaa/grid_arithmetic.hpp"

#include "numeric/clones.hpp"
#include "numeric/four.hpp"

namespace bodesmith::fpaa {
namespace {

/// Two complex numbers, real and imaginary parts by turns.
using Two = Four;

// By reference: a vector that is returned would need the processor's own registers for it.
[[gnu::always_inline]] inline void product(const Two& a, const Two& b, Two& out) {
  const Two re = __builtin_shufflevector(a, a, 0, 0, 2, 2), im = __builtin_shufflevector(a, a, 1, 1, 3, 3);
  const Two crossed = im * __builtin_shufflevector(b, b, 1, 0, 3, 2);
  out = re * b + crossed * Two{-1.0, 1.0, -1.0, 1.0};
}
[[gnu::always_inline]] inline void at(const InD& f, const Two& d, Two& out) {
  product(d, Two{f.a1, 0.0, f.a1, 0.0} + f.a2 * d, out);
  out += Two{f.a0, 0.0, f.a0, 0.0};
}

/// The last point of an odd number of them stands alone; `points` is even here.
BODESMITH_CLONES void multiply_pairs(double* to, const double* by, std::size_t points) {
  for (std::size_t k = 0; k < 2 * points; k += 4)
    product(*four_at(to + k), *four_at(by + k), *four_at(to + k));
}
BODESMITH_CLONES void add_pairs(double* to, const double* a, const double* b, std::size_t points) {
  for (std::size_t k = 0; k < 2 * points; k += 4) {
    Two share;
    product(*four_at(a + k), *four_at(b + k), share);
    *four_at(to + k) += share;
  }
}
BODESMITH_CLONES void invert_pairs(const InD& f, const double* d, double* to, std::size_t points) {
  for (std::size_t k = 0; k < 2 * points; k += 4) {
    Two below;
    at(f, *four_at(d + k), below);
    const Two squares = below * below;
    const Two norm = squares + __builtin_shufflevector(squares, squares, 1, 0, 3, 2);
    *four_at(to + k) = below * Two{1.0, -1.0, 1.0, -1.0} / norm;
  }
}
BODESMITH_CLONES void divide_pairs(const InD& f, const double* d, const double* inverse, double* to,
                                   std::size_t points) {
  for (std::size_t k = 0; k < 2 * points; k += 4) {
    Two above, quotient;
    at(f, *four_at(d + k), above);
    product(above, *four_at(inverse + k), quotient);
    *four_at(to + k) = -quotient;
  }
}
BODESMITH_CLONES void change_pairs(const InD& dn, const InD& dm, const double* d, const double* response,
                                   const double* inverse, double* to, std::size_t points) {
  for (std::size_t k = 0; k < 2 * points; k += 4) {
    Two above, below, quotient;
    at(dn, *four_at(d + k), above);
    at(dm, *four_at(d + k), below);
    product(*four_at(response + k), below, below);
    product(above + below, *four_at(inverse + k), quotient);
    *four_at(to + k) = -quotient;
  }
}

/// As numbers, real and imaginary parts by turns (which the standard promises).
const double* numbers(const GridValues& x) {
  return reinterpret_cast<const double*>(x.data());
}
double* numbers(GridValues& x) {
  return reinterpret_cast<double*>(x.data());
}
std::size_t pairs(const GridValues& x) {
  return x.size() / 2 * 2;
}

}  // namespace

void multiply(GridValues& to, const GridValues& by) {
  multiply_pairs(numbers(to), numbers(by), pairs(to));
  if (to.size() % 2 != 0) to.back() = product(to.back(), by.back());
}

void add_product(GridValues& to, const GridValues& a, const GridValues& b) {
  add_pairs(numbers(to), numbers(a), numbers(b), pairs(to));
  if (to.size() % 2 != 0) to.back() += product(a.back(), b.back());
}

GridValues inverse_of(const InD& denominator, const GridValues& d) {
  GridValues out(d.size());
  invert_pairs(denominator, numbers(d), numbers(out), pairs(d));
  if (d.size() % 2 != 0) {
    const std::complex<double> below = denominator.at(d.back());
    out.back() = std::conj(below) / std::norm(below);
  }
  return out;
}

GridValues negative_quotient(const InD& numerator, const GridValues& d, const GridValues& inverse) {
  GridValues out(d.size());
  divide_pairs(numerator, numbers(d), numbers(inverse), numbers(out), pairs(d));
  if (d.size() % 2 != 0) out.back() = -product(numerator.at(d.back()), inverse.back());
  return out;
}

GridValues negative_change(const InD& dn, const InD& dm, const GridValues& d, const GridValues& response,
                           const GridValues& inverse) {
  GridValues out(d.size());
  change_pairs(dn, dm, numbers(d), numbers(response), numbers(inverse), numbers(out), pairs(d));
  if (d.size() % 2 != 0)
    out.back() = -product(dn.at(d.back()) + product(response.back(), dm.at(d.back())), inverse.back());
  return out;
}

}  // namespace bodesmith::fpaa
