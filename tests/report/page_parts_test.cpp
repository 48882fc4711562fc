// The page in a browser: what a reader clicks, presses and reads. check_live_page.py drives it and says what it expects.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/files.hpp"
#include "base/provenance.hpp"
#include "browser_check.hpp"
#include "report/page.hpp"
#include "report/page_parts.hpp"

namespace bodesmith::report {
namespace {

constexpr int kPoints = 31;

std::vector<Plot> gain_and_phase() {
  Plot gain;
  gain.title = "Gain";
  gain.x = {"frequency, Hz", true};
  gain.y = {"dB"};
  gain.series = {{"line", {}, {}},
                 {"marks", {10.0, 100.0}, {23.0, 43.0}, Series::Style::marks},
                 {"hidden", {1.0}, {0.0}}};
  gain.series[2].shown = false;
  Plot phase = gain;
  phase.title = "Phase";
  phase.y = {"degrees"};
  phase.series = {{"line", {}, {}}};
  for (int i = 0; i < kPoints; ++i) {
    const double f = std::pow(10.0, i / 10.0);
    gain.series[0].x.push_back(f);
    gain.series[0].y.push_back(20.0 * std::log10(f));
    phase.series[0].x.push_back(f);
    phase.series[0].y.push_back(-f / 10.0);
  }
  return {gain, phase};
}

Plot noise() {
  Plot out;
  out.title = "Noise";
  out.x = {"frequency, Hz", true};
  out.y = {"V", true};
  out.series = {{"</script><script>window.bad = 1</script>", {10.0, 100.0, 1e4}, {1.0, 0.1, 0.01}}};
  return out;
}

Plot circle() {
  Plot out;
  out.title = "Loop";
  out.x = {"input u"};
  out.y = {"V"};
  out.series = {{"", {}, {}}};
  for (int i = 0; i <= 100; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / 100.0;
    out.series[0].x.push_back(std::sin(angle));
    out.series[0].y.push_back(std::cos(angle));
  }
  return out;
}

std::vector<Choice> choices() {
  std::vector<Choice> out;
  for (const double k : {1.0, 2.0, 3.0}) {
    Plot plot = gain_and_phase().front();
    plot.series.resize(1);
    for (double& y : plot.series.front().y) y *= k;
    const std::string number = std::to_string(static_cast<int>(k));
    out.push_back({"choice " + number,
                   {{number + " dB", "error"}},
                   {plot},
                   k == 2.0 ? std::vector<std::string>{"<b>not bold</b>"} : std::vector<std::string>{},
                   {{{{"part", "value"}, {{"R1", number + " kΩ"}}, {}}, "Parts"}}});
  }
  return out;
}

std::string test_page() {
  Page page("A page", "to be clicked");
  page.chapter("Plots");
  page.plots(gain_and_phase(), "Two");
  page.plots({noise()}, "</script><script>window.bad = 1</script>");
  page.plots({circle()}, "A loop");
  page.choices({{"design"}, {{"one"}, {"two"}, {"three"}}, {1}}, "Designs", choices(), 1);
  page.table({{"name", "a rather long heading of a column"}, {{"some value that takes room", "1"}}, {}});
  return page.html();
}

TEST(LivePage, AnswersToMouseAndKeys) {
  if (const std::string why = no_browser(); !why.empty()) GTEST_SKIP() << why;
  const TemporaryFolder folder;
  const std::string page = (folder / "page.html").string();
  write_file(page, test_page());
  const ProgramResult result = drive_page("check_live_page.py", page);
  EXPECT_EQ(result.status, 0) << result.out << result.err;
}

// The licence of what is kept goes with every page; nothing in a script ends its own element.
TEST(LivePage, CarriesTheLicenceOfWhatItUses) {
  const std::string script = page_script();
  EXPECT_NE(script.find("Copyright (c) 2022 Leon Sorokin"), std::string::npos);
  EXPECT_EQ(script.find("</script"), std::string::npos);
  EXPECT_EQ(script.find("<!--"), std::string::npos);
}

TEST(LivePage, TheKeptLibraryIsTheOneThatIsNamed) {
  const std::string folder = BODESMITH_SOURCE_DIR "/templates/vendor/uPlot/";
  const std::string notes = read_file(folder + "README.md");
  for (const char* file : {"uPlot.iife.min.js", "uPlot.min.css", "LICENSE"}) {
    const std::string row = std::string("| ") + file + " | " + sha256_hex(read_file(folder + file)) + " |";
    EXPECT_NE(notes.find(row), std::string::npos) << row;
  }
}

// SHA-256 of nothing and of "abc" in base 64 (FIPS 180-4's examples).
TEST(LivePage, PolicyNamesScriptsByTheirHash) {
  const std::string policy = content_policy({""}, {"abc"});
  EXPECT_NE(policy.find("script-src 'sha256-47DEQpj8HBSa+/TImW+5JCeuQeRkm5NMpJWZG3hSuFU=';"),
            std::string::npos)
      << policy;
  EXPECT_NE(policy.find("style-src 'sha256-ungWv48Bz+pBQUDeXa4iI7ADYaOWF3qctBD/YfIAFa0=';"),
            std::string::npos)
      << policy;
  EXPECT_EQ(policy.find("unsafe"), std::string::npos);
}

}  // namespace
}  // namespace bodesmith::report
