#include "base/text.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "base/documents/document.hpp"
#include "base/error.hpp"
#include "base/progress.hpp"

namespace bodesmith {
namespace {

TEST(Quantity, ReadsWhatPeopleWrite) {
  const std::pair<const char*, double> known[] = {
      {"4700", 4700.0},     {"47k", 47e3},         {"4k7", 4700.0},  {"4R7", 4.7},          {"0R1", 0.1},
      {"10n", 10e-9},       {"2n2", 2.2e-9},       {"4.7u", 4.7e-6}, {"1\xC2\xB5 F", 1e-6}, {"220nF", 220e-9},
      {"13.2 kHz", 13.2e3}, {"1M", 1e6},           {"1meg", 1e6},    {"-3 dB", -3.0},       {"5%", 5.0},
      {"1e3 Hz", 1e3},      {"10k\xCE\xA9", 10e3}, {"47 ohm", 47.0}, {"+5k", 5e3},          {" 2m ", 2e-3}};
  for (const auto& [text, expected] : known) {
    double value = 0.0;
    EXPECT_TRUE(parse_quantity(text, value)) << text;
    EXPECT_EQ(value, expected) << text;
  }
}

TEST(Quantity, RefusesTheRest) {
  double value = 0.0;
  for (const char* text :
       {"", "k", "4k7k", "4.7k7", "1e3k", "x", "12a", "4 7", "nan", "inf", "1..2", "Hz", "1e400", "5k %k"})
    EXPECT_FALSE(parse_quantity(text, value)) << text;
}

TEST(Quantity, IsUnderstoodInDocuments) {
  const Node node = parse_toml("a = \"4k7\"\nb = \"12\"\nc = \"large\"\n", "t.toml");
  EXPECT_EQ(node.at("a").number(), 4700.0);
  EXPECT_THROW(node.at("b").number(), InputError);
  EXPECT_THROW(node.at("c").number(), InputError);
}

}  // namespace

namespace {

TEST(Text, SplitAndTrimmed) {
  using Parts = std::vector<std::string_view>;
  EXPECT_EQ(split("a,,b", ','), (Parts{"a", "", "b"}));
  EXPECT_EQ(split("", ','), Parts{""});
  EXPECT_EQ(split("a,", ','), (Parts{"a", ""}));
  EXPECT_EQ(split_words("  one\ttwo \r three"), (Parts{"one", "two", "three"}));
  EXPECT_TRUE(split_words(" \t").empty());
  EXPECT_EQ(trim(" \n x y\r\n"), "x y");
  EXPECT_EQ(trim(" \t "), "");
}

/// No line is longer than 100 columns unless one word is, the words stay, and what goes on stands two columns further in, or
/// below the text of its label.
TEST(Text, FoldedLinesKeepTheirWordsAndTheirIndent) {
  std::string words;
  for (int i = 0; i < 60; ++i)
    words += (i == 0 ? "" : " ") + std::string(static_cast<std::size_t>(1 + i * 7 % 11), 'w');
  for (const auto& [begin, indent] : {std::pair<std::string, std::size_t>{"", 2},
                                      {"   ", 5},
                                      {"label:   ", 11},
                                      {std::string(18, 'l') + "  ", 22},
                                      {std::string(19, 'l') + "  ", 2}}) {
    const std::string folded = folded_text(begin + words);
    std::string joined;
    std::size_t lines = 0;
    for (const std::string_view line : split(folded, '\n')) {
      EXPECT_LE(line.size(), 100u);
      EXPECT_EQ(lines > 0 ? line.find_first_not_of(' ') : indent, indent) << folded;
      joined += lines > 0 ? " " + std::string(trim(line)) : std::string(line);
      ++lines;
    }
    EXPECT_EQ(joined, begin + words);
    EXPECT_GE(lines, 4u) << folded;
  }
  const std::string path(130, 'p');
  EXPECT_EQ(folded_text("file " + path + " there"), "file\n  " + path + " there");
  EXPECT_EQ(folded_text("short\nlines"), "short\nlines");
}

TEST(NearestWord, CountsSingleChanges) {
  EXPECT_EQ(edit_distance("order", "order"), 0u);
  EXPECT_EQ(edit_distance("oder", "order"), 1u);
  EXPECT_EQ(edit_distance("ordre", "order"), 1u);  // neighbours swapped
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3u);
  EXPECT_EQ(edit_distance("", "abc"), 3u);
  EXPECT_EQ(edit_distance("ca", "abc"), 3u);  // no change between two that were swapped
}

TEST(NearestWord, FindsWhatWasMeant) {
  const std::vector<std::string> words = {"order", "output", "max-error-db", "from-hz", "to-hz", "corner_hz"};
  EXPECT_EQ(nearest_word("oder", words), "order");
  EXPECT_EQ(nearest_word("ORDER", words), "order");
  EXPECT_EQ(nearest_word("max_eror_db", words), "max-error-db");
  EXPECT_EQ(nearest_word("max", words), "max-error-db");  // the only one that begins so
  EXPECT_EQ(nearest_word("corner", words), "corner_hz");
  EXPECT_EQ(nearest_word("zzzzz", words), std::nullopt);
  EXPECT_EQ(nearest_word("o", words), std::nullopt);
  EXPECT_EQ(nearest_word("", words), std::nullopt);
  EXPECT_EQ(nearest_word(std::string(100000, 'o'), words), std::nullopt);
  EXPECT_EQ(did_you_mean("oder", words, "--"), " (did you mean '--order'?)");
  EXPECT_EQ(did_you_mean("zzzzz", words), "");
}

/// What reading `text` says is wrong.
std::string complaint(const std::string& text, const std::function<void(const Node&)>& read) {
  try {
    read(parse_json(text, "x.json"));
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(NearestWord, DocumentsNameTheKeyThatWasMeant) {
  const auto known = [](const Node& node) { node.allow_only({"lower", "upper"}); };
  EXPECT_EQ(complaint("{\"uper\": 1}", known),
            "x.json:1: 'uper' is not known here (did you mean 'upper'?), expected one of: lower, upper");
  EXPECT_EQ(complaint("{\"$schema\": \"x\", \"upper\": 1}", known), "");
  EXPECT_EQ(complaint("{\n\"lamda_s\": 1}", [](const Node& node) { node.at("lambda_s"); }),
            "x.json:2: 'lambda_s' is missing (did you mean it by 'lamda_s'?)");
  // Another key that a document may have beside it is no misspelling of it.
  EXPECT_EQ(complaint("{\"descending\": 1}", [](const Node& node) { node.at("ascending"); }),
            "x.json:1: 'ascending' is missing");
  // "$schema" is for editors at the top of a file alone.
  EXPECT_NE(complaint("{\"a\": {\"$schema\": 1}}", [](const Node& node) { node.at("a").allow_only({"b"}); }),
            "");
}

TEST(ProgressLine, ShowsBarAndTimeWithinTheWidth) {
  EXPECT_EQ(progress_line("run: tracking", 0.5, 3.0, 120),
            "[############------------]  50 %  run: tracking, 3 s left");
  EXPECT_EQ(progress_line("run", 0.0, 1.0, 120), "[------------------------]   0 %  run");
  EXPECT_EQ(progress_line("run", 1.0, 1.0, 120), "[########################] 100 %  run, 0 s left");
  EXPECT_EQ(progress_line("spice", -1.0, 12.4, 120), "spice, 12 s");
  EXPECT_EQ(progress_line("fit", 0.1, 600.0, 120), "[##----------------------]  10 %  fit, 90 min left");
  EXPECT_EQ(progress_line("spice", -1.0, 12.4, 6), "spice");
  EXPECT_EQ(progress_line("aβb", -1.0, 1.0, 3), "a");  // not half a letter
}

}  // namespace

}  // namespace bodesmith
