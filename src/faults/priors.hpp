#pragma once

#include <cstddef>
#include <vector>

#include "faults/fault.hpp"

namespace bodesmith::faults {

/// What is believed before anything is measured; docs/faults.md states the same.
struct Priors {
  double good = 0.50;
  double one_fault = 0.44;
  double two_faults = 0.06;
  /// Of the good boards: all parts' errors so many times as large as stated.
  double wider_spread[2] = {2.5, 6.0};
  double wider_share = 0.04;  ///< each
};

/// ln of every fault's share among single faults: the kinds' priors, normalised over those that are there, each shared
/// by its faults evenly.
std::vector<double> log_priors(const std::vector<Fault>& faults);

}  // namespace bodesmith::faults
