#include "fpaa/device/clock_tree.hpp"

#include <gtest/gtest.h>

#include <set>

namespace bodesmith::fpaa {
namespace {

TEST(ClockTree, DivisorsAreOneAndTheEvenNumbersTo510) {
  int count = 0;
  for (int d = -3; d < 1000; ++d) count += is_legal_divisor(d) ? 1 : 0;
  EXPECT_EQ(count, 256);  // one byte
  EXPECT_EQ(divisor_byte(1), 0);
  EXPECT_EQ(divisor_byte(510), 255);
  EXPECT_FALSE(is_legal_divisor(3));
  EXPECT_FALSE(is_legal_divisor(512));
}

TEST(ClockTree, EveryLegalClockIsMadeByItsDivisors) {
  const Board& board = an231k04_quad4();
  const auto clocks = legal_clocks(board, {100.0}, {16e6});
  ASSERT_GT(clocks.size(), 1000u);
  for (std::size_t i = 0; i < clocks.size(); ++i) {
    EXPECT_TRUE(is_legal_divisor(clocks[i].system_divisor));
    EXPECT_TRUE(is_legal_divisor(clocks[i].divisor));
    EXPECT_DOUBLE_EQ(clocks[i].frequency.value,
                     board.master_clock.value / clocks[i].system_divisor / clocks[i].divisor);
    if (i > 0) {
      EXPECT_LT(clocks[i - 1].frequency.value, clocks[i].frequency.value);
    }
  }
  // Counted independently: distinct products of two legal divisors below the cut.
  std::set<long> products;
  for (long a = 1; a <= 510; ++a) {
    for (long b = 1; b <= 510; ++b) {
      const bool legal = (a == 1 || a % 2 == 0) && (b == 1 || b % 2 == 0);
      if (legal && 16e6 / static_cast<double>(a * b) >= 100.0) products.insert(a * b);
    }
  }
  EXPECT_EQ(clocks.size(), products.size());
}

TEST(ClockTree, FindsTheSeedsTwoKilohertzAndRefusesWhatIsNotInTheTree) {
  const Board& board = an231k04_quad4();
  ASSERT_TRUE(find_clock(board, {2000.0}));
  EXPECT_DOUBLE_EQ(find_clock(board, {2000.0})->frequency.value, 2000.0);
  EXPECT_FALSE(find_clock(board, {16e6 / 3.0}));
  EXPECT_FALSE(find_clock(board, {2000.001}));
  EXPECT_DOUBLE_EQ(nearest_clock(board, {2000.001}).frequency.value, 2000.0);
  EXPECT_DOUBLE_EQ(nearest_clock(board, {1e12}).frequency.value, 16e6);
  EXPECT_DOUBLE_EQ(nearest_clock(board, {1e-6}).frequency.value, 16e6 / 510.0 / 510.0);
}

}  // namespace
}  // namespace bodesmith::fpaa
