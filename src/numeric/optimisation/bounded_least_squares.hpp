#pragma once

#include <vector>

namespace bodesmith {

/// A dense matrix by rows, long double: the fits here are small and their conditioning is the user's.
using LongMatrix = std::vector<std::vector<long double>>;
using LongVector = std::vector<long double>;

struct BoundedSolution {
  LongVector x;
  std::vector<int> bound;  ///< -1 at the lower bound, +1 at the upper, 0 free
  /// Largest violation of the Karush-Kuhn-Tucker conditions: |gradient| where free, gradient of the wrong
  /// sign at a bound. 0 up to rounding proves the global minimum (the problem is convex; strictly, with
  /// independent columns).
  long double optimality_residual = 0.0L;
};

/// min |A x - b|^2 subject to lower_i <= x_i <= upper_i, by the active-set method BVLS (Stark and Parker 1995):
/// finite and exact up to rounding. A has at least as many rows as columns, independent columns.
BoundedSolution bounded_least_squares(const LongMatrix& a, const LongVector& b, const LongVector& lower,
                                      const LongVector& upper);
/// The same bounds for all.
BoundedSolution bounded_least_squares(const LongMatrix& a, const LongVector& b, long double lower,
                                      long double upper);

/// A x = b, square or overdetermined in the least-squares sense, by QR with column exchange and one step of
/// refinement.
LongVector least_squares(const LongMatrix& a, const LongVector& b);

/// The matrix that least_squares applies to b: row i gives x_i.
LongMatrix least_squares_inverse(const LongMatrix& a);

/// Ratio of the largest to the smallest singular value; infinite when singular.
double condition_number(const LongMatrix& a);

}  // namespace bodesmith
