#include "report/plot.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "texts.hpp"

namespace bodesmith::report {
namespace {

const char* const kSize = "width=\"(\\d+)\" height=\"(\\d+)\"";

/// Numbers in the groups of every match.
std::vector<std::vector<double>> all_of(const std::string& svg, const char* pattern) {
  std::vector<std::vector<double>> out;
  for (const auto& match : matches(svg, pattern)) {
    out.emplace_back();
    for (std::size_t i = 1; i < match.size(); ++i) out.back().push_back(std::stod(match[i]));
  }
  return out;
}

TEST(Plot, MapsDataLogarithmically) {
  Plot plot;
  plot.x.logarithmic = true;
  plot.series.push_back({"a", {1.0, 10.0, 100.0}, {0.0, 1.0, 0.0}});
  const std::string svg = to_svg(plot);
  const auto found = all_of(svg, "d=\"M([0-9.]+) [0-9.]+L([0-9.]+) [0-9.]+L([0-9.]+) ");
  ASSERT_FALSE(found.empty());
  const double a = found[0][0], b = found[0][1], c = found[0][2];
  EXPECT_NEAR(b - a, c - b, 0.02) << "decades are not equally wide";
}

TEST(Plot, NothingNotFiniteReachesThePicture) {
  Plot plot;
  plot.title = "<&>";
  plot.series.push_back({"n", {0.0, 1.0, 2.0, 3.0}, {0.0, NAN, INFINITY, 1.0}});
  plot.series.push_back({"", {}, {}});
  const std::string svg = to_svg(plot);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_EQ(svg.find("inf"), std::string::npos);
  EXPECT_NE(svg.find("&lt;&amp;&gt;"), std::string::npos);
}

TEST(Plot, EveryNameInTheLegendStandsInThePictureAndUnderThePlot) {
  Plot plot;
  for (int i = 0; i < 12; ++i)
    plot.series.push_back({fmt::format("a name as long as this one, {}", i), {0.0, 1.0}, {0.0, 1.0}});
  const std::string svg = to_svg(plot);
  const auto size = all_of(svg, kSize);
  ASSERT_FALSE(size.empty());
  const auto names = all_of(svg, "<text x=\"([0-9.]+)\" y=\"([0-9.]+)\"[^>]*>a name as long");
  int rows = 0;
  double last = 0.0;
  for (const auto& name : names) {
    EXPECT_LT(name[0], size[0][0] - 6.0 * 29.0);
    const double y = name[1];
    EXPECT_GT(y, plot.height);
    EXPECT_LT(y, size[0][1]);
    rows += y > last;
    EXPECT_GE(y, last);
    last = y;
  }
  EXPECT_EQ(names.size(), 12u);
  EXPECT_GT(rows, 2);
}

TEST(Plot, WhatIsWrittenStandsInThePicture) {
  Plot plot;
  plot.title = "title";
  plot.x = {"frequency in Hz", true};
  plot.y = {"gain in dB"};
  plot.series.push_back({"a", {1.0, 10.0, 100.0}, {-40.0, 3.0, 20.0}});
  const std::string svg = to_svg(plot);
  const auto size = all_of(svg, kSize);
  ASSERT_FALSE(size.empty());
  const auto texts = all_of(svg, "<text x=\"([-0-9.]+)\" y=\"([-0-9.]+)\"");
  for (const auto& text : texts) {
    for (const std::size_t axis : {0u, 1u}) {
      EXPECT_GE(text[axis], 0.0);
      EXPECT_LE(text[axis], size[0][axis]);
    }
  }
  EXPECT_GT(texts.size(), 8u);
}

/// Border, clip, grid, ticks, curves and marks: all by the two scales of the axes, which are given.
TEST(Plot, EverythingStandsWhereItsAxesSay) {
  for (const bool logarithmic : {false, true}) {
    Plot plot;
    plot.width = 700;
    plot.height = 300;
    plot.x = {"t", logarithmic, true, 1.0, 100.0};
    plot.y = {"y", false, true, -3.0, 5.0};
    const std::vector<double> x = {1.0, 4.0, 20.0, 100.0}, y = {-3.0, 2.0, 5.0, 0.0};
    plot.series.push_back({"line", x, y});
    plot.series.push_back({"marks", x, y, Series::Style::marks});
    const std::string svg = to_svg(plot);
    const auto border = all_of(
        svg, "<rect x=\"([0-9.]+)\" y=\"([0-9.]+)\" width=\"([0-9.]+)\" height=\"([0-9.]+)\" fill=\"none\"");
    ASSERT_EQ(border.size(), 1u);
    const double left = border[0][0], top = border[0][1], right = left + border[0][2],
                 bottom = top + border[0][3];
    EXPECT_TRUE(0.0 < left && left < 100.0 && 0.0 < top && top < 50.0) << left << " " << top;
    EXPECT_TRUE(670.0 < right && right < 700.0 && 230.0 < bottom && bottom < 280.0) << right << " " << bottom;
    EXPECT_EQ(
        all_of(
            svg,
            "<clipPath id=\"[^\"]*\"><rect x=\"([0-9.]+)\" y=\"([0-9.]+)\" width=\"([0-9.]+)\" height=\"([0-9.]+)\"/>"),
        border);
    const auto at_x = [&](double value) {
      return left + (right - left) * (logarithmic ? std::log10(value) / 2.0 : (value - 1.0) / 99.0);
    };
    const auto at_y = [&](double value) { return bottom - (bottom - top) * (value + 3.0) / 8.0; };
    const auto path =
        all_of(svg, "d=\"M([0-9.]+) ([0-9.]+)L([0-9.]+) ([0-9.]+)L([0-9.]+) ([0-9.]+)L([0-9.]+) ([0-9.]+)\"");
    const auto marks = all_of(svg, "<circle cx=\"([0-9.]+)\" cy=\"([0-9.]+)\"");
    ASSERT_EQ(path.size(), 1u);
    ASSERT_EQ(marks.size(), 5u);  // and one in the legend
    for (std::size_t i = 0; i < x.size(); ++i) {
      EXPECT_NEAR(path[0][2 * i], at_x(x[i]), 0.006);
      EXPECT_NEAR(path[0][2 * i + 1], at_y(y[i]), 0.006);
      EXPECT_NEAR(marks[i][0], at_x(x[i]), 0.006);
      EXPECT_NEAR(marks[i][1], at_y(y[i]), 0.006);
    }
    // Each label beside the line of its value.
    const auto lines_up = all_of(svg, "<path d=\"M([0-9.]+) ([0-9.]+)V([0-9.]+)\" stroke=\"#dcdfe4\"");
    const auto x_labels =
        all_of(svg, "<text x=\"([0-9.]+)\" y=\"([0-9.]+)\" text-anchor=\"middle\">([-0-9.]+)<");
    ASSERT_EQ(x_labels.size(), lines_up.size());
    EXPECT_GE(x_labels.size(), 3u);
    for (std::size_t i = 0; i < x_labels.size(); ++i) {
      EXPECT_EQ(lines_up[i], (std::vector{x_labels[i][0], top, bottom}));
      EXPECT_NEAR(x_labels[i][0], at_x(x_labels[i][2]), 0.006);
      EXPECT_TRUE(bottom + 5.0 < x_labels[i][1] && x_labels[i][1] < 300.0 - 12.0 - 9.0);
    }
    const auto across = all_of(svg, "<path d=\"M([0-9.]+) ([0-9.]+)H([0-9.]+)\"");
    const auto y_labels =
        all_of(svg, "<text x=\"([0-9.]+)\" y=\"([0-9.]+)\" text-anchor=\"end\">([-0-9.]+)<");
    ASSERT_EQ(y_labels.size(), across.size());
    EXPECT_GE(y_labels.size(), 3u);
    for (std::size_t i = 0; i < y_labels.size(); ++i) {
      EXPECT_EQ(across[i], (std::vector{left, y_labels[i][1] - 4.0, right}));
      EXPECT_NEAR(across[i][1], at_y(y_labels[i][2]), 0.006);
      EXPECT_TRUE(left - 15.0 < y_labels[i][0] && y_labels[i][0] < left);
    }
    for (const auto& fine : all_of(svg, "<path d=\"M([0-9.]+) ([0-9.]+)V([0-9.]+)\" stroke=\"#f0f1f3\""))
      EXPECT_TRUE(left < fine[0] && fine[0] < right && fine[1] == top && fine[2] == bottom);
    // What the axes are: in the middle of each.
    EXPECT_NEAR(all_of(svg, "<text x=\"([0-9.]+)\" y=\"[0-9.]+\" text-anchor=\"middle\" fill")[0][0],
                0.5 * (left + right), 0.06);
    EXPECT_NEAR(all_of(svg, "translate\\(16 ([0-9.]+)\\) rotate")[0][0], 0.5 * (top + bottom), 0.06);
  }
}

/// Plots below one another, each under the last one's legend; names of a legend beside one another.
TEST(Plot, StackedPlotsDoNotMeet) {
  std::vector<Plot> plots(3);
  for (std::size_t i = 0; i < plots.size(); ++i) {
    for (std::size_t k = 0; k < 5 * i; ++k)
      plots[i].series.push_back({fmt::format("name {} of a series", k), {0.0, 1.0}, {0.0, 1.0}});
  }
  const std::string svg = stack_svg(plots);
  const auto begins = all_of(svg, "<g transform=\"translate\\(0 ([0-9.]+)\\)\"");
  ASSERT_EQ(begins.size(), 3u);
  const auto names = all_of(svg, "<text x=\"([0-9.]+)\" y=\"([0-9.]+)\" fill=\"#1b1f24\">name ([0-9]+)");
  ASSERT_EQ(names.size(), 15u);
  EXPECT_EQ(begins[1][0], plots[0].height);  // without a name there is no legend
  const double last = std::max_element(names.begin(), names.begin() + 5, [](const auto& a, const auto& b) {
                        return a[1] < b[1];
                      })->at(1);
  EXPECT_TRUE(begins[2][0] > begins[1][0] + last + 3.0 && begins[2][0] < begins[1][0] + last + 25.0);
  const auto size = all_of(svg, "viewBox=\"0 0 ([0-9]+) ([0-9]+)\" width=\"([0-9]+)\" height=\"([0-9]+)\"");
  EXPECT_EQ(size[0][0], plots[0].width);
  EXPECT_EQ(size[0][2], size[0][0]);
  EXPECT_EQ(size[0][3], size[0][1]);
  EXPECT_GT(size[0][1], begins[2][0] + names.back()[1] + 3.0);
  for (std::size_t i = 1; i < names.size(); ++i) {
    if (names[i][1] == names[i - 1][1] && names[i][2] > names[i - 1][2]) {
      EXPECT_GT(names[i][0], names[i - 1][0] + 100.0);
    }
  }
}

TEST(Plot, ALongRecordIsThinnedToWhatCanBeSeen) {
  Plot plot;
  Series series;
  for (int i = 0; i < 200000; ++i) {
    series.x.push_back(i);
    series.y.push_back(i == 77777 ? 5.0 : std::sin(i * 0.001));
  }
  plot.series.push_back(series);
  plot.y = {"", false, true, -2.0, 6.0};
  const std::string svg = to_svg(plot);
  EXPECT_LT(svg.size(), 200000u);
  // The one spike is still there: y = 5 on the axis -2..6 of a plot 340 high.
  EXPECT_NE(svg.find(" 66.25"), std::string::npos);
}

}  // namespace
}  // namespace bodesmith::report
