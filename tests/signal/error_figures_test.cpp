// Errors of signals whose figures are known beforehand.
#include "signal/error_figures.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace bodesmith {
namespace {

TEST(ErrorFigures, OfAnErrorOfPlusAndMinusOneAboutAnOffset) {
  std::vector<double> wanted, got;
  for (int i = 0; i < 100; ++i) {
    wanted.push_back(0.1 * i - 2.0);
    got.push_back(wanted.back() + 3.0 + (i % 2 == 0 ? 1.0 : -1.0));
  }
  const ErrorFigures figures = error_figures(got, wanted);
  EXPECT_NEAR(figures.rms, std::sqrt(10.0), 1e-12);
  EXPECT_NEAR(figures.rms_free_offset, 1.0, 1e-12);
  EXPECT_NEAR(figures.max, 4.0, 1e-12);
  EXPECT_NEAR(figures.range, 9.9, 1e-12);
  EXPECT_NEAR(figures.rms_percent, 100.0 * std::sqrt(10.0) / 9.9, 1e-10);
  EXPECT_NEAR(figures.max_percent, 400.0 / 9.9, 1e-10);
  // What is left out counts neither in the error nor in the range.
  got[0] = wanted[0] = 1e6;
  const ErrorFigures later = error_figures(got, wanted, 2);
  EXPECT_NEAR(later.rms, std::sqrt(10.0), 1e-12);
  EXPECT_NEAR(later.range, 9.7, 1e-12);
}

TEST(ErrorFigures, EveryRecordHasAnOffsetOfItsOwn) {
  const std::vector<double> flat = {1.0, 1.0, 1.0, 1.0};
  ErrorSum sum;
  sum.add(std::vector<double>{3.0, 3.0, 3.0, 3.0}, flat);
  sum.add(std::vector<double>{0.0, -2.0, 0.0, -2.0}, flat);
  const ErrorFigures figures = sum.figures();
  EXPECT_NEAR(figures.rms, std::sqrt((4 * 4.0 + 1.0 + 9.0 + 1.0 + 9.0) / 8.0), 1e-12);
  EXPECT_NEAR(figures.rms_free_offset, std::sqrt(4.0 / 8.0), 1e-12);
  EXPECT_EQ(figures.range, 0.0);
  EXPECT_EQ(figures.rms_percent, 0.0);
  EXPECT_EQ(error_figures({}, {}).rms, 0.0);
}

}  // namespace
}  // namespace bodesmith
