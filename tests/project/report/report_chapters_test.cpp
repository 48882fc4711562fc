// A table as the summary prints it.
#include <gtest/gtest.h>

#include <sstream>

#include "project/report/report_chapters.hpp"
#include "report/page.hpp"

namespace bodesmith::project {
namespace {

/// Whichever cell is a column's widest: all lines end at one place, so do the cells of each column, and a marked row has its star.
TEST(ReportChapters, TablesAreSetInColumns) {
  const std::string longest = "0.123456";
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 1; column < 3; ++column) {
      report::Table table{{"", "1 Hz", "100 Hz"}, {{"one", "1", "2"}, {"another", "3", "4"}}, {1}};
      (row == 0 ? table.head : table.rows[row - 1])[column] = longest;
      std::istringstream text(text_of("design", table));
      const std::size_t first = std::string("  another").size() + 2 + (column == 1 ? longest : "1 Hz").size();
      const std::size_t second = first + 2 + (column == 2 ? longest : "100 Hz").size();
      std::string line;
      for (std::size_t i = 0; i < 3; ++i) {
        ASSERT_TRUE(std::getline(text, line));
        EXPECT_EQ(line.size(), second) << line;
        EXPECT_NE(line[first - 1], ' ') << line;
        EXPECT_EQ(line[first], ' ') << line;
        EXPECT_EQ(line.front(), i == 0 ? 'd' : i == 1 ? ' ' : '*') << line;
      }
      EXPECT_FALSE(std::getline(text, line));
    }
  }
}

}  // namespace
}  // namespace bodesmith::project
