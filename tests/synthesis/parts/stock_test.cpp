#include "synthesis/parts/stock.hpp"

#include <gtest/gtest.h>

#include "base/error.hpp"
#include "synthesis/seed_sections.hpp"

namespace bodesmith::synthesis {
namespace {

std::string complaint(const std::string& text, bool csv) {
  try {
    if (csv) {
      StockList::parse_csv(text, "drawer");
    } else {
      StockList::parse_toml(text, "drawer");
    }
  } catch (const InputError& error) {
    return error.what();
  }
  return "none";
}

TEST(Stock, BothFormatsSayTheSame) {
  const StockList toml = StockList::parse_toml(
      "schema = \"bodesmith.stock/1\"\n[resistors]\nvalues_ohm = [4700, 1e3]\nleast_ohm = 500\n"
      "[capacitors]\nvalues_f = [1e-8]\ngreatest_f = 2e-8\n",
      "drawer");
  const StockList csv = StockList::parse_csv(
      "\xEF\xBB\xBF# drawer\r\nresistance_ohm,capacitance_f\r\n4700,\r\n\r\n1e3,\r\n, 1e-8\r\n", "drawer");
  EXPECT_EQ(toml.resistors->values(1, 1e9), (std::vector<double>{1e3, 4700}));
  EXPECT_EQ(csv.resistors->values(1, 1e9), toml.resistors->values(1, 1e9));
  EXPECT_EQ(csv.capacitors->values(1e-12, 1), toml.capacitors->values(1e-12, 1));
  RealiseOptions options;
  const double greatest_ohm = options.limits.max_ohm;
  toml.apply_to(options);
  EXPECT_EQ(options.limits.min_ohm, 500);
  EXPECT_EQ(options.limits.max_f, 2e-8);
  EXPECT_EQ(options.limits.max_ohm, greatest_ohm);
  const StockList half = StockList::parse_csv("capacitance_f\n1e-9\n", "drawer");
  EXPECT_FALSE(half.resistors.has_value());
  EXPECT_TRUE(half.capacitors.has_value());
}

TEST(Stock, ComplaintsNameTheLine) {
  const std::string head = "schema = \"bodesmith.stock/1\"\n[resistors]\n";
  EXPECT_EQ(complaint("resistance_ohm\n4700\n4q7\n", true),
            "drawer:3: '4q7' is not a value above 0, expected ohm such as 4700 or 4k7");
  EXPECT_EQ(complaint("resistance_ohm\n4700\n4k7\n", true), "none");
  for (const char* csv : {"resistance_ohm\n-1\n", "resistance_ohm\nnan\n",
                          "resistance_ohm,capacitance_f\n1,2\n", "resistance_ohm,capacitance_f\n1\n"})
    EXPECT_EQ(complaint(csv, true).substr(0, 9), "drawer:2:") << csv;
  for (const char* csv : {"ohm\n1\n", "resistance_ohm,resistance_ohm\n1,\n"})
    EXPECT_EQ(complaint(csv, true).substr(0, 9), "drawer:1:") << csv;
  EXPECT_NE(complaint("resistance_ohm\n", true), "none");
  for (const char* toml : {"values_ohm = []\n", "values_ohm = [0]\n", "values_ohm = [\"4q7\"]\n",
                           "value_ohm = [1]\n", "series = \"E97\"\n"})
    EXPECT_EQ(complaint(head + toml, false).substr(0, 9), "drawer:3:") << complaint(head + toml, false);
  EXPECT_EQ(complaint(head + "series = \"E12\"\nvalues_ohm = [1]\n", false).substr(0, 7), "drawer:");
  EXPECT_EQ(complaint(head + "least_ohm = 10\ngreatest_ohm = 1\n", false).substr(0, 9), "drawer:4:");
  EXPECT_EQ(complaint("[resistors]\n", false).substr(0, 7), "drawer:");
}

TEST(Stock, OnlyPartsOfTheListAreUsed) {
  // E24 resistors without a third of them, seven capacitors.
  std::vector<double> ohm;
  for (const double value : Series::named("E24").values(1e3, 2.2e6)) {
    if (std::lround(value) % 7 != 0) ohm.push_back(value);
  }
  const std::vector<double> farad = {1e-9, 2.2e-9, 4.7e-9, 10e-9, 22e-9, 47e-9, 100e-9};
  RealiseOptions options;
  options.resistors = Series::stock("stock", ohm);
  options.capacitors = Series::stock("stock", farad);
  options.isolation_ohm = 0.0;
  const Realised made = realise(seed_sections(), options);
  for (const Part& part : made.circuit.parts) {
    const auto& list = part.kind == Part::Kind::resistor ? ohm : farad;
    EXPECT_NE(std::find(list.begin(), list.end(), part.realised), list.end()) << part.name;
    EXPECT_EQ(part.series, "stock");
  }
  EXPECT_LT(made.report.parts.max_magnitude_db, 0.2);
  EXPECT_LT(made.report.parts.max_magnitude_db, 0.5 * made.report.nearest.max_magnitude_db);
}

}  // namespace
}  // namespace bodesmith::synthesis
