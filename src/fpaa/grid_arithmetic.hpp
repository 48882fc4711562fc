#pragma once

#include <complex>
#include <vector>

#include "fpaa/network.hpp"

/// Complex numbers at the points of a grid, two of them at a time: the bits of product() and InD::at() point by point.
namespace bodesmith::fpaa {

using GridValues = std::vector<std::complex<double>>;

/// to *= by.
void multiply(GridValues& to, const GridValues& by);
/// to += a b.
void add_product(GridValues& to, const GridValues& a, const GridValues& b);
/// conj(x)/|x|^2 of a0 + a1 D + a2 D^2.
GridValues inverse_of(const InD& denominator, const GridValues& d);
/// -(a0 + a1 D + a2 D^2) inverse.
GridValues negative_quotient(const InD& numerator, const GridValues& d, const GridValues& inverse);
/// -(dn(D) + response dm(D)) inverse.
GridValues negative_change(const InD& dn, const InD& dm, const GridValues& d, const GridValues& response,
                           const GridValues& inverse);

}  // namespace bodesmith::fpaa
