#include "report/page.hpp"

#include <gtest/gtest.h>

#include <regex>

#include "report/svg.hpp"

namespace bodesmith::report {
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
    const std::regex open("<" + std::string(element) + "[ >]");
    const auto begin = std::sregex_iterator(html.begin(), html.end(), open);
    const auto opened = static_cast<std::size_t>(std::distance(begin, std::sregex_iterator()));
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
