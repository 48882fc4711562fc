#pragma once

#include <string>
#include <vector>

#include "faults/likelihood.hpp"

namespace bodesmith::faults {

/// One explanation of the measurement: nothing wrong, one fault or two, each of its most likely size.
struct Finding {
  std::vector<const Fault*> faults;
  std::vector<double> sizes;
  double part_spread = 1.0;  ///< the parts' errors are so many times as large as stated
  double log_prior = 0.0;
  double log_evidence = 0.0;  ///< ln of the measurement's density, sizes and parts' errors integrated out
  double misfit = 0.0;        ///< about `rows` when right
  double rows = 0.0;

  double log_weight() const { return log_prior + log_evidence; }
  Effect effect() const;
  /// "R2_1", "R2_1 + C1_3"; empty: nothing is wrong.
  std::string site() const;
};

/// The sizes that explain the measurement best, by a comb of starts and Gauss-Newton; the integral over them by
/// Laplace's approximation (MacKay, Information Theory, 2003, chapter 27).
Finding fitted(const Board& board, const std::vector<const Fault*>& faults, double log_prior,
               const Noise& noise);
/// From given sizes on.
Finding polished(const Board& board, Finding start, const Noise& noise);

/// The evidence with the parts' errors found once more from where the linear form put them (`faults` is the list that the
/// finding points into); and with the noise known to within a factor of 1.6 only.
Finding refined(const Board& board, Finding finding, const std::vector<Fault>& faults, const Noise& noise);

/// Sizes at which a fault is tried first.
std::vector<double> comb(const Fault& fault, int count);

}  // namespace bodesmith::faults
