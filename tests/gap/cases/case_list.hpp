#pragma once

#include <cstdint>
#include <vector>

#include "gap/cases/case.hpp"

namespace hidden {

/// Which cases a batch holds.
struct CaseOptions {
  std::uint64_t seed = 1;
  std::vector<double> ratios = {
      5.0};                  ///< sizes of the hidden effects over the noise, each effect once a size
  int repeats = 1;           ///< variants of each case
  int pairs = 0;             ///< pairs of hidden effects (World::formulas)
  double pair_ratio = 10.0;  ///< size of the smaller of the two over the noise
  double controls = 0.5;     ///< controls per effect case (0.5: a third of all)
  int outside = 0;           ///< times every kind of thing outside the catalogue
  std::vector<World> worlds = {World::formulas};
};

std::vector<Specification> list_cases(const CaseOptions& options);

Case make_case(const Specification& specification);

}  // namespace hidden
