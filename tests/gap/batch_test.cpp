#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <string>

#include "base/text.hpp"
#include "gap/batch.hpp"

namespace {

double setting(const char* name, double otherwise) {
  const char* text = std::getenv(name);
  double value = otherwise;
  if (text != nullptr && !bodesmith::parse_number(text, value)) return otherwise;
  return value;
}

// The big batch; run with --gtest_also_run_disabled_tests. Settings by environment: GAP_SEED, GAP_RATIO (0: 3, 5, 10, 50),
// GAP_REPEATS, GAP_PAIRS, GAP_CONTROLS (a case), GAP_OUTSIDE, GAP_ONLY (part of a case's name).
TEST(GapBatch, DISABLED_Confusion) {
  hidden::BatchOptions options;
  options.seed = static_cast<std::uint64_t>(setting("GAP_SEED", 1));
  const double ratio = setting("GAP_RATIO", 5.0);
  options.ratios = ratio > 0.0 ? std::vector<double>{ratio} : std::vector<double>{3.0, 5.0, 10.0, 50.0};
  options.repeats = static_cast<int>(setting("GAP_REPEATS", 1));
  options.pairs = static_cast<int>(setting("GAP_PAIRS", 12));
  options.controls = setting("GAP_CONTROLS", 0.5);
  options.outside = static_cast<int>(setting("GAP_OUTSIDE", 16));
  const char* only = std::getenv("GAP_ONLY");
  const char* base = std::getenv("GAP_BASE");
  const auto cases = hidden::make_cases(options);
  std::vector<hidden::Outcome> outcomes;
  for (const auto& c : cases) {
    if (only != nullptr && c.name.find(only) == std::string::npos) continue;
    if (base != nullptr && c.base != base) continue;
    outcomes.push_back(hidden::solve(c));
    std::printf("%s\n", hidden::line_of(outcomes.back()).c_str());
    std::fflush(stdout);
  }
  std::printf("\n%s\n", hidden::confusion_table(outcomes).c_str());
  EXPECT_FALSE(outcomes.empty());
}

}  // namespace
