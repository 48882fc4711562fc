#include "report/bars.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "texts.hpp"

namespace bodesmith::report {
namespace {

std::vector<double> bar_widths(const std::string& svg) {
  std::vector<double> out;
  for (const auto& bar : matches(svg, "<rect x=\"[0-9]+\" y=\"[0-9]+\" width=\"([0-9.]+)\" height=\"11\""))
    out.push_back(std::stod(bar[1]));
  return out;
}

TEST(Bars, LengthsAreAsTheValuesAndEachHasItsFigure) {
  Bars bars{"Gap", "rms", {"training", "held-out"}, {}, 1.0, "floor <1>"};
  bars.groups = {{"base model", {8.0, 4.0}, {"8.00", "4.00"}}, {"+ creep", {2.0, NAN}, {"2.00", "none"}}};
  const std::string svg = to_svg(bars);
  const std::vector<double> widths = bar_widths(svg);
  ASSERT_EQ(widths.size(), 3u);
  EXPECT_NEAR(widths[1] / widths[0], 0.5, 1e-3);
  EXPECT_NEAR(widths[2] / widths[0], 0.25, 1e-3);
  for (const char* text : {">+ creep<", ">8.00<", ">held-out<", ">floor &lt;1&gt;<", "stroke-dasharray"})
    EXPECT_THAT(svg, testing::HasSubstr(text));
  EXPECT_THAT(svg, testing::Not(testing::HasSubstr(">none<")));
}

TEST(Bars, NothingButZerosIsDrawnToo) {
  EXPECT_EQ(bar_widths(to_svg({"Gap", "rms", {"training"}, {{"base", {0.0}, {"0"}}}, 0.0, ""})),
            std::vector<double>{0.0});
}

}  // namespace
}  // namespace bodesmith::report
