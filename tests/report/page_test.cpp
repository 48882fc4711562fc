#include "report/page.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/files.hpp"
#include "base/provenance.hpp"
#include "browser_check.hpp"
#include "report/svg.hpp"
#include "texts.hpp"

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

namespace {

Page sample_page() {
  Page page("A & B", "x < y");
  page.chapter("Fit");
  page.paragraph("gain < 1 & phase > 0");
  page.warning("a \"limit\" was not met");
  page.key_figures({{"0.5 %", "worst error"}});
  page.table({{"f", "dB"}, {{"1", "0"}, {"<2>", "3"}}, {1}}, "Points");
  page.chapter("Listing");
  page.listing("if (a < b) {}");
  page.figure("<svg/>", "caption & more");
  return page;
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

// What a reader's browser needs: one self-contained document whose elements close.
TEST(Page, IsOneClosedDocument) {
  const std::string html = sample_page().html();
  for (const char* element : {"html", "body", "section", "table", "thead", "tbody", "tr", "th", "td", "p",
                              "pre", "figure", "figcaption", "div", "main", "nav"}) {
    const std::size_t opened = matches(html, "<" + std::string(element) + "[ >]").size();
    EXPECT_EQ(opened, count(html, "</" + std::string(element) + ">")) << element;
    EXPECT_GT(opened, 0u) << element;
  }
  for (const char* outside : {" src=", "@import", "<link", "url(", " onclick", " onload", " style=\""})
    EXPECT_EQ(html.find(outside), std::string::npos) << outside;
  EXPECT_NE(html.find("content=\"default-src &apos;none&apos;; script-src &apos;sha256-"), std::string::npos);
}

TEST(Page, TextIsEscapedAndFiguresAreNot) {
  const std::string html = sample_page().html();
  EXPECT_NE(html.find("<p>gain &lt; 1 &amp; phase &gt; 0</p>"), std::string::npos);
  EXPECT_NE(html.find("<p class=\"warning\">a &quot;limit&quot; was not met</p>"), std::string::npos);
  EXPECT_NE(html.find("<td>&lt;2&gt;</td>"), std::string::npos);
  EXPECT_NE(html.find("<pre>if (a &lt; b) {}</pre>"), std::string::npos);
  EXPECT_NE(
      html.find(
          "<figure><div class=\"still\"><svg/></div><figcaption>caption &amp; more</figcaption></figure>"),
      std::string::npos);
  EXPECT_NE(html.find("A &amp; B"), std::string::npos);
}

TEST(Page, ChaptersAreListedAtTheTop) {
  const std::string html = sample_page().html();
  EXPECT_NE(html.find("<a href=\"#chapter-1\">Fit</a>"), std::string::npos);
  EXPECT_NE(html.find("<a href=\"#chapter-2\">Listing</a>"), std::string::npos);
  EXPECT_LT(html.find("id=\"chapter-1\""), html.find("id=\"chapter-2\""));
  EXPECT_EQ(count(html, "<section"), 2u);
}

TEST(Page, MarkedRowsAreSetOff) {
  const std::string html = sample_page().html();
  EXPECT_EQ(count(html, "<tr class=\"marked\">"), 1u);
  EXPECT_LT(html.find("<td>0</td>"), html.find("<tr class=\"marked\">"));
}

TEST(InlinedSvg, KeepsItsStylesAndIdsToItself) {
  const std::string drawing =
      "<svg width=\"9\"><style>\n.name{fill:#fff} .a, .b { fill: red; }\nsvg{font-size:9px}\n</style>"
      "<marker id=\"tip\"/><path class=\"name\" marker-end=\"url(#tip)\"/></svg>";
  EXPECT_EQ(inlined_svg(drawing, "f1"),
            "<svg id=\"f1\" width=\"9\"><style>\n#f1 .name{fill:#fff}\n#f1 .a,#f1 .b{ fill: red; }\n"
            "#f1{font-size:9px}\n</style><marker id=\"f1-tip\"/>"
            "<path class=\"name\" marker-end=\"url(#f1-tip)\"/></svg>");
  Page page("p", "");
  page.figure(drawing, "one");
  page.figure(drawing, "two");
  EXPECT_EQ(count(page.html(), "<svg id=\"figure-1\""), 1u);
  EXPECT_EQ(count(page.html(), "url(#figure-2-tip)"), 1u);
}

TEST(Svg, PaletteGoesRound) {
  EXPECT_EQ(palette_colour(0), palette_colour(8));
  EXPECT_NE(palette_colour(0), palette_colour(1));
  EXPECT_EQ(palette_colour(3).size(), 7u);
}

}  // namespace

}  // namespace bodesmith::report
