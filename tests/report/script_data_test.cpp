#include "report/script_data.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "base/documents/json.hpp"
#include "texts.hpp"

namespace bodesmith::report {
namespace {

TEST(ScriptData, NoTextEndsItsElement) {
  const Json json = {{"name", "</script><!-- & \"\\ \xff"}};
  const std::string text = json_for_script(json);
  EXPECT_EQ(text.find_first_of("<>&"), std::string::npos) << text;
  const std::string back = parsed(text)["name"].get<std::string>();
  EXPECT_EQ(back.substr(0, back.size() - 3), "</script><!-- & \"\\ ");  // the last byte was no UTF-8
}

TEST(ScriptData, UnitsAreReadOffLabels) {
  EXPECT_EQ(unit_of_label("frequency, Hz"), "Hz");
  EXPECT_EQ(unit_of_label("dB"), "dB");
  EXPECT_EQ(unit_of_label("d, of range"), "");
  EXPECT_EQ(unit_of_label("input u"), "");
}

TEST(ScriptData, NumbersAreShortAndFinite) {
  EXPECT_EQ(plotted_number(1.0 / 3.0, 7).dump(), "0.3333333");
  EXPECT_EQ(plotted_number(100.0, 7).dump(), "100");
  EXPECT_TRUE(plotted_number(NAN, 7).is_null());
  EXPECT_TRUE(plotted_number(INFINITY, 7).is_null());
  EXPECT_EQ(plotted_number(1.23456789e300, 7).get<double>(), 1.234568e300);
}

TEST(ScriptData, TracesShareTheirColumnOfX) {
  Plot plot;
  plot.x = {"time, s"};
  plot.series = {{"a", {0.0, 1.0}, {1.0, NAN}}, {"b", {0.0, 1.0}, {3.0, 4.0}}, {"c", {0.0, 2.0}, {3.0, 4.0}}};
  plot.series[1].shown = false;
  const Json json = live_plots({plot, plot});
  EXPECT_EQ(json["columns"].dump(), "[[0,1],[0,2]]");
  const Json& traces = json["plots"][1]["traces"];
  EXPECT_EQ(traces[0]["y"].dump(), "[1,null]");
  EXPECT_EQ(traces[1]["x"], 0);
  EXPECT_EQ(traces[2]["x"], 1);
  EXPECT_EQ(traces[1]["shown"], false);
  EXPECT_EQ(json["plots"][0]["x"]["unit"], "s");
  EXPECT_EQ(json["plots"][0]["x"]["quantity"], "time");
}

TEST(Thin, KeepsPeaksAndGaps) {
  Series series;
  for (int i = 0; i < 100000; ++i) {
    series.x.push_back(i);
    series.y.push_back(i == 4321 ? 9.0 : i == 70001 ? -9.0 : i == 50000 ? NAN : std::sin(0.01 * i));
  }
  const Series thin = thinned(series, 1000);
  EXPECT_LE(thin.x.size(), 1001u);
  EXPECT_GE(thin.x.size(), 900u);
  double low = 0.0, high = 0.0;
  int gaps = 0;
  for (std::size_t i = 0; i < thin.y.size(); ++i) {
    if (i > 0) {
      EXPECT_LT(thin.x[i - 1], thin.x[i]);
    }
    if (!std::isfinite(thin.y[i])) {
      ++gaps;
      EXPECT_EQ(thin.x[i], 50000.0);
      continue;
    }
    low = std::min(low, thin.y[i]);
    high = std::max(high, thin.y[i]);
  }
  EXPECT_EQ(gaps, 1);
  EXPECT_EQ(low, -9.0);
  EXPECT_EQ(high, 9.0);
  EXPECT_EQ(thinned({"", {1.0, 2.0}, {3.0, 4.0}}, 10).x.size(), 2u);
}

// Along a logarithmic axis the few samples of the first decades all stay; what has no place there goes.
TEST(Thin, KeepsEveryDecade) {
  Series spectrum;
  for (int i = 0; i <= 100000; ++i) {
    spectrum.x.push_back(0.01 * i);
    spectrum.y.push_back(1.0 / (1 + i));
  }
  const Series thin = thinned(spectrum, 2000, true);
  EXPECT_LE(thin.x.size(), 2000u);
  ASSERT_GT(thin.x.size(), 100u);
  for (int i = 1; i <= 20; ++i) EXPECT_EQ(thin.x[static_cast<std::size_t>(i - 1)], 0.01 * i);
  EXPECT_EQ(thin.x.back(), spectrum.x.back());
}

TEST(Thin, LoopsAreCutByTheirSamples) {
  Series loop;
  for (int i = 0; i < 50000; ++i) {
    loop.x.push_back(std::sin(0.01 * i));
    loop.y.push_back(std::cos(0.01 * i));
  }
  const Series thin = thinned(loop, 4000);
  EXPECT_LE(thin.x.size(), 4000u);
  EXPECT_GE(thin.x.size(), 3900u);
  for (std::size_t i = 0; i < thin.x.size(); ++i) EXPECT_NEAR(std::hypot(thin.x[i], thin.y[i]), 1.0, 1e-9);
}

}  // namespace
}  // namespace bodesmith::report
