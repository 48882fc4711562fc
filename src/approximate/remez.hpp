#pragma once

#include <optional>
#include <vector>

namespace bodesmith {

/// Remez exchange on log pole and zero positions zeta_k (log_symmetric.hpp) for ((1 + r s)/(1 + s/r))^beta. The unique
/// best approximation shares the symmetry of the term (mirror it and exchange poles with zeros), so the error is odd in
/// v = 2 ln w and only v >= 0 is looked at: n positions and the level E make the error
///   e(v) = sum_k half_lead(v, zeta_k) - beta half_lead(v, ln kappa)
/// alternate on n + 1 points there, the last of them at the end (w infinite).
class Remez {
 public:
  /// What the unknowns stand for: first `pairs` conjugate pairs (two numbers each, real and imaginary part of zeta),
  /// then real positions, the first of them counted `multiplicity` times.
  struct Shape {
    int pairs = 0;
    int multiplicity = 1;
  };

  /// `order` unknowns.
  Remez(long double log_kappa, int order, Shape shape);

  struct Result {
    std::vector<long double> zeta;
    long double error = 0.0L;  ///< largest |error|, Np
  };

  /// From starting positions, until the largest error is within `tolerance` of the level; nothing when the exchange
  /// does not settle.
  std::optional<Result> solve(long double beta, std::vector<long double> zeta,
                              long double tolerance = kTolerance) const;

  /// Largest |error| of given positions, on the grid.
  long double grid_error(long double beta, const std::vector<long double>& zeta) const;

  static constexpr long double kTolerance = 1e-4L;  ///< of the level, relative: a ten-thousandth of the error
  static constexpr long double kRounding = 1e-15L;  ///< Np: about what rounding the roots to doubles does

 private:
  struct Extremum {
    long double v;
    long double error;
  };

  /// One Newton step towards errors of one height on the reference points; the level it predicts, nothing when the
  /// equations break down.
  std::optional<long double> equalise(long double beta, std::vector<long double>& zeta,
                                      const std::vector<long double>& reference) const;
  /// The alternating extrema of the error over the grid, each the largest of its sign.
  std::vector<Extremum> alternating_extrema(long double beta, const std::vector<long double>& zeta) const;
  /// Where the error turns between two points, by bisection of its slope.
  long double turning_point(long double beta, const std::vector<long double>& zeta, long double low,
                            long double high) const;

  long double error(long double beta, const std::vector<long double>& zeta, long double v) const;
  long double error_slope(long double beta, const std::vector<long double>& zeta, long double v) const;
  /// The error's derivatives by the unknowns.
  std::vector<long double> slopes(const std::vector<long double>& zeta, long double v) const;

  long double log_kappa_;
  Shape shape_;
  std::vector<long double> start_;  ///< first reference
  std::vector<long double> grid_;
};

}  // namespace bodesmith
