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
