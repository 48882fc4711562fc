#include <gtest/gtest.h>

#include "gap/report/figures.hpp"
#include "gap/report/words.hpp"

namespace bodesmith::gap {
namespace {

TEST(PageWords, NamesAndUnits) {
  EXPECT_EQ(parameter_words("corner_hz"), "corner");
  EXPECT_EQ(parameter_words("natural_frequency_hz"), "natural frequency");
  EXPECT_EQ(parameter_words("w[2]"), "weight 2");
  EXPECT_EQ(parameter_words("gains[0]"), "creep gain 0");
  EXPECT_EQ(parameter_words("lower"), "lower");
  EXPECT_EQ(parameter_text("corner_hz", 60.12), "60.12 Hz");
  EXPECT_EQ(parameter_text("delay_s", 2.5e-5), "25 µs");
  EXPECT_EQ(parameter_text("time_constants_s[0]", 0.25), "250 ms");
  EXPECT_EQ(parameter_text("rate_per_s", 3.0), "3 1/s");
  EXPECT_EQ(parameter_text("lower", -0.77), "-0.77");
}

// One value stands in the sentence; of a bank of weights it says how many there are.
TEST(PageWords, StepsInSentences) {
  DiagnosedStep lag;
  lag.effect = "amplifier_pole";
  lag.placed = "after block 1";
  lag.parameters = {{"corner_hz", 60.0, 59.0, 61.0}};
  EXPECT_EQ(step_in_words(lag),
            "amplifier_pole (after block 1): a first-order lag. Corner 60 Hz (59 Hz to 61 Hz).");
  DiagnosedStep memory;
  memory.effect = "hysteresis";
  memory.placed = "before block 1";
  memory.parameters = {{"w[1]", 0.0171, 0.0, 0.03}, {"w[2]", 0.0, 0.0, 0.0}, {"w[3]", 0.2, 0.1, 0.3}};
  memory.tied_with = {"backlash"};
  const std::string text = step_in_words(memory);
  EXPECT_EQ(text.find("0.0171"), std::string::npos) << text;
  EXPECT_NE(text.find("3 parameters, 3 of them weights, of which 2 not zero"), std::string::npos) << text;
  EXPECT_NE(text.find("cannot tell it from backlash"), std::string::npos) << text;
  Diagnosis d;
  d.steps = {memory};
  const report::Table table = parameters_table(d);
  ASSERT_EQ(table.rows.size(), 3u);
  EXPECT_EQ(table.rows[0][2], "weight 1");
  EXPECT_EQ(table.rows[0][3], "0.0171");
}

TEST(PageWords, RelativeFiguresSayTheirUnit) {
  Diagnosis d;
  EXPECT_EQ(rms_text(d, 0.031), "0.031");
  d.relative = true;
  EXPECT_EQ(rms_text(d, 0.031), "3.1 %");
  EXPECT_NE(rms_unit_sentence(d).find("in percent"), std::string::npos);
}

TEST(PageWords, TheNameThatWasChosenIsMarked) {
  Model model;
  Term term;
  term.unknowns.resize(2);
  term.write = [](Model&, std::span<const double>) {};
  model.add(term);
  Ranked named;
  named.effect = &effect_registry().get("offset");
  named.model = model;
  named.log_evidence = 12.34;
  named.outcome = CandidateOutcome::named;
  Ranked other = named;
  other.outcome = CandidateOutcome::worse;
  const report::Table table = ranking_table({other, named}, false);
  EXPECT_EQ(table.marked, (std::vector<std::size_t>{1}));
  EXPECT_EQ(table.rows[1][2], "2");
  EXPECT_EQ(table.rows[1][6], "12.3");
  EXPECT_EQ(table.rows[1].back(), "named");
}

}  // namespace
}  // namespace bodesmith::gap
