#include "fpaa/trim/trim_search.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "numeric/random.hpp"

namespace bodesmith::fpaa {
namespace {

using Complex = std::complex<double>;

TEST(TrimSearch, FindsWholeCapacitorsThatUndoAKnownError) {
  // ln(a/b): 200/100 is off by the error that 203/100 has; slopes of a ratio.
  TrimProblem problem;
  problem.built = problem.units = {203, 100};
  problem.excess = {0.0, 0.0};
  problem.error = {std::log(203.0 / 200.0)};
  problem.slope = {{1.0}, {-1.0}};
  const std::vector<int> units = search_trim(problem);
  EXPECT_NEAR(std::log(units[0] / 200.0) - std::log(units[1] / 100.0), 0.0, 1e-3);
  // One that is not there stays so, and so do those that reach no other unit.
  problem.built = problem.units = {0, 3};
  EXPECT_EQ(search_trim(problem), (std::vector<int>{0, 3}));
}

/// The largest error, two standard deviations with it, and a tenth of the mean: by the capacitors one by one.
double trim_cost(const TrimProblem& p, const std::vector<int>& units) {
  const auto capacitor = [&](std::size_t c, int n) {
    const ExchangedUnits x = exchanged_units(p.built[c], n, p.array, p.unit_variance);
    return std::pair(n + p.excess[c] * x.kept + p.systematic_units, x.variance);
  };
  double worst = 0.0, squares = 0.0;
  for (std::size_t k = 0; k < p.error.size(); ++k) {
    Complex error = p.error[k];
    double variance = 0.0;
    for (std::size_t c = 0; c < units.size(); ++c) {
      const auto [size, spread] = capacitor(c, units[c]);
      error += std::log(size / capacitor(c, p.units[c]).first) * p.slope[c][k];
      variance += spread / (size * size) * std::norm(p.slope[c][k]);
    }
    const double here = std::abs(error) + 2.0 * std::sqrt(variance);
    worst = std::max(worst, here);
    squares += here * here;
  }
  return worst + 0.1 * std::sqrt(squares / static_cast<double>(p.error.size()));
}

TEST(TrimSearch, NoExchangeOfOneOrTwoCapacitorsBettersWhatItFinds) {
  Random random(3);
  for (const UnitArray array : {UnitArray::nested, UnitArray::binary}) {
    for (int draw = 0; draw < 4; ++draw) {
      TrimProblem p;
      p.array = array;
      p.unit_variance = draw == 0 ? 0.0 : 2.5e-5;
      p.systematic_units = 0.1 * draw;
      p.built = {37, 96, 130, 11, 250};
      p.units = p.built;
      if (draw > 1) p.units = {40, 90, 127, 11, 255};
      for (std::size_t c = 0; c < p.built.size(); ++c) {
        p.excess.push_back(0.3 * random.normal());
        p.slope.emplace_back();
        for (int k = 0; k < 3; ++k) p.slope[c].emplace_back(random.normal(), random.normal());
      }
      for (int k = 0; k < 3; ++k) p.error.emplace_back(0.02 * random.normal(), 0.02 * random.normal());
      const std::vector<int> found = search_trim(p);
      const auto is_allowed = [&](std::size_t c, int n) {
        // A quarter of what was built, and of what it is; at least a unit.
        const int most = p.built[c] / 4;
        const int reach = std::max(1, static_cast<int>(0.25 * p.units[c]));
        return n >= std::min(p.units[c], std::max(p.built[c] - most, p.units[c] - reach)) &&
               n <= std::max(p.units[c], std::min({255, p.built[c] + most, p.units[c] + reach}));
      };
      const double least = trim_cost(p, found);
      EXPECT_LE(least, trim_cost(p, p.units) * (1.0 + 1e-12));
      for (std::size_t a = 0; a < found.size(); ++a) {
        EXPECT_TRUE(is_allowed(a, found[a])) << a << " " << found[a];
        for (int by_a = -4; by_a <= 4; ++by_a) {
          std::vector<int> other = found;
          other[a] += by_a;
          if (by_a == 0 || !is_allowed(a, other[a])) continue;
          EXPECT_GE(trim_cost(p, other), least * (1.0 - 2e-9)) << a << by_a;
          for (std::size_t b = a + 1; b < found.size() && std::abs(by_a) <= 2; ++b) {
            for (const int by_b : {-2, -1, 1, 2}) {
              other[b] = found[b] + by_b;
              if (is_allowed(b, other[b])) {
                EXPECT_GE(trim_cost(p, other), least * (1.0 - 2e-9)) << a << by_a << b << by_b;
              }
            }
            other[b] = found[b];
          }
        }
      }
      p.reach = 0.0;  // still a unit
      const std::vector<int> near = search_trim(p);
      for (std::size_t c = 0; c < near.size(); ++c) EXPECT_LE(std::abs(near[c] - p.units[c]), 1);
    }
  }
}

}  // namespace
}  // namespace bodesmith::fpaa
