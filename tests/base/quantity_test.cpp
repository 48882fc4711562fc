#include "base/quantity.hpp"

#include <gtest/gtest.h>

#include "base/document.hpp"
#include "base/error.hpp"

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
}  // namespace bodesmith
