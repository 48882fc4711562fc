#include "report/plot.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <regex>

namespace bodesmith::report {
namespace {

TEST(Plot, MapsDataLogarithmically) {
  Plot plot;
  plot.x.logarithmic = true;
  plot.series.push_back({"a", {1.0, 10.0, 100.0}, {0.0, 1.0, 0.0}});
  const std::string svg = to_svg(plot);
  std::smatch found;
  ASSERT_TRUE(
      std::regex_search(svg, found, std::regex("d=\"M([0-9.]+) [0-9.]+L([0-9.]+) [0-9.]+L([0-9.]+) ")));
  const double a = std::stod(found[1]);
  const double b = std::stod(found[2]);
  const double c = std::stod(found[3]);
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
  std::smatch size;
  ASSERT_TRUE(std::regex_search(svg, size, std::regex("width=\"(\\d+)\" height=\"(\\d+)\"")));
  const std::regex name("<text x=\"([0-9.]+)\" y=\"([0-9.]+)\"[^>]*>a name as long");
  int names = 0, rows = 0;
  double last = 0.0;
  for (std::sregex_iterator at(svg.begin(), svg.end(), name), end; at != end; ++at, ++names) {
    EXPECT_LT(std::stod((*at)[1]), std::stod(size[1]) - 6.0 * 29.0);
    const double y = std::stod((*at)[2]);
    EXPECT_GT(y, plot.height);
    EXPECT_LT(y, std::stod(size[2]));
    rows += y > last;
    EXPECT_GE(y, last);
    last = y;
  }
  EXPECT_EQ(names, 12);
  EXPECT_GT(rows, 2);
}

TEST(Plot, WhatIsWrittenStandsInThePicture) {
  Plot plot;
  plot.title = "title";
  plot.x = {"frequency in Hz", true};
  plot.y = {"gain in dB"};
  plot.series.push_back({"a", {1.0, 10.0, 100.0}, {-40.0, 3.0, 20.0}});
  const std::string svg = to_svg(plot);
  std::smatch size;
  ASSERT_TRUE(std::regex_search(svg, size, std::regex("width=\"(\\d+)\" height=\"(\\d+)\"")));
  const std::regex text("<text x=\"([-0-9.]+)\" y=\"([-0-9.]+)\"");
  int count = 0;
  for (std::sregex_iterator at(svg.begin(), svg.end(), text), end; at != end; ++at, ++count) {
    for (const std::size_t axis : {1u, 2u}) {
      EXPECT_GE(std::stod((*at)[axis]), 0.0) << at->str();
      EXPECT_LE(std::stod((*at)[axis]), std::stod(size[axis])) << at->str();
    }
  }
  EXPECT_GT(count, 8);
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
