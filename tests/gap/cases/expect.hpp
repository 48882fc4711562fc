#pragma once

#include <gtest/gtest.h>

#include <ostream>
#include <string>
#include <vector>

#include "gap/cases/case_list.hpp"
#include "gap/cases/solve.hpp"

namespace hidden {

/// One hidden thing on one base, for tests with a case each.
struct Hidden {
  const char* base;
  const char* what;
  std::uint64_t seed;
};

inline void PrintTo(const Hidden& h, std::ostream* out) {
  *out << h.what << " on " << h.base << ", seed " << h.seed;
}

/// "gain_saturation".
struct HiddenName {
  std::string operator()(const testing::TestParamInfo<Hidden>& info) const {
    return std::string(info.param.base) + "_" + info.param.what;
  }
};

/// Of a model beside what is in no catalogue: every effect is tried there, the expensive ones too, round after round.
constexpr int kOutsiderTerms = 1;

/// Solved, and expected to be right: named (or tied), or rightly silent.
inline Outcome expect_right(World world, Kind kind, const Hidden& h, std::size_t rows,
                            const SolveOptions& options = {}) {
  constexpr double kTimesNoise = 10.0;
  auto outcome = solve(make_case({world, kind, h.base, {h.what}, kTimesNoise, h.seed, rows}), options);
  EXPECT_TRUE(outcome.right) << line_of(outcome);
  return outcome;
}

}  // namespace hidden
