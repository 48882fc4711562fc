#include "circuit/realise_search.hpp"

#include <gtest/gtest.h>

#include "base/document.hpp"
#include "base/error.hpp"
#include "base/json.hpp"
#include "base/quantity.hpp"
#include "circuit/built_circuit.hpp"
#include "circuit/json.hpp"
#include "circuit/response.hpp"
#include "circuit/stated_band.hpp"
#include "seed_sections.hpp"

namespace bodesmith::circuit {
namespace {

/// A lag of .05 rad/s: far below what 2.2 Mohm and 220 nF make.
Sections slow_lag() {
  Sections out;
  out.sections = {Section::pole_zero(10.0, {0.5}, {0.05})};
  return out;
}

TEST(RealiseSearch, WhatTheUsualFormCannotMakeALadderDoes) {
  BuildSearch search;
  search.may_choose = true;
  const auto outcome = realise_for_building(slow_lag(), search);
  ASSERT_EQ(refusal_of(outcome), nullptr);
  const auto& choice = std::get<BuildChoice>(outcome);
  EXPECT_NE(choice.best.realisation, "opamp-rc");
  EXPECT_LT(choice.best.judged.max_magnitude_db, 0.2);
  ASSERT_EQ(choice.passed_over.size(), 1u);
  EXPECT_NE(choice.passed_over[0].find("cannot be made"), std::string::npos);
}

TEST(RealiseSearch, ARefusalNamesTheLimitThatWouldDo) {
  BuildSearch search;
  const auto outcome = realise_for_building(slow_lag(), search);
  const Refusal* refusal = refusal_of(outcome);
  ASSERT_NE(refusal, nullptr);
  EXPECT_NE(refusal->reason.find("would do"), std::string::npos) << refusal->reason;
  const auto limits = limits_that_do(slow_lag(), search.options);
  ASSERT_TRUE(limits);
  // What it names does.
  ASSERT_EQ(limits->substr(0, 8), "--max-f ");
  ASSERT_TRUE(parse_quantity(limits->substr(8), search.options.limits.max_f)) << *limits;
  EXPECT_EQ(refusal_of(realise_for_building(slow_lag(), search)), nullptr);
}

TEST(RealiseSearch, ErrorAndMarginAreJudgedInTheSectionsOwnBand) {
  Sections sections = seed_sections();
  EXPECT_LT(judged_band(sections).from.value, 3.0);
  sections.error = Sections::Error{{Hertz{1.0}, Hertz{20.0}}, 0.0, 0.0, 0.0};
  EXPECT_EQ(judged_band(sections).to.value, 20.0);
  EXPECT_LE(searched_band(sections).to.value, 200.0 * (1 + 1e-9));
  BuildSearch search;
  search.limits.max_error_db = 1e-9;
  const auto outcome = realise_for_building(sections, search);
  const auto& best = std::get<BuildChoice>(outcome).best;
  ASSERT_EQ(best.shortfalls.size(), 1u);
  EXPECT_NE(best.shortfalls[0].find("between 1 Hz and 20 Hz"), std::string::npos) << best.shortfalls[0];
}

TEST(CircuitFile, ComesBackAsItWasBuilt) {
  for (const char* form : {"opamp-rc", "foster1", "cauer2"}) {
    SCOPED_TRACE(form);
    RealiseOptions options;
    options.realisation = form;
    if (std::string(form) != "opamp-rc") options.limits = {100.0, 10e6, 47e-12, 4.7e-6};
    const Realised made = realise(seed_sections(), options);
    Json json = to_json(made);
    json["schema"] = "bodesmith.circuit/1";
    const std::string text = to_text(json);
    const CircuitFile file = CircuitFile::from_node(parse_json(text, "circuit.json"));
    EXPECT_EQ(file.circuit.parts.size(), made.circuit.parts.size());
    EXPECT_EQ(file.circuit.opamps.size(), made.circuit.opamps.size());
    const std::vector<Hertz> grid = {Hertz{2.0}, Hertz{30.0}, Hertz{1e5}};
    const auto before = network_response(made.circuit, grid, made.circuit.model);
    const auto after = network_response(file.circuit, grid, file.circuit.model);
    for (std::size_t i = 0; i < grid.size(); ++i) {
      EXPECT_NEAR(std::abs(after[i] / before[i] - 1.0), 0.0, 1e-9);
      EXPECT_NEAR(std::abs(file.wanted(grid[i].rad_s()) / seed_sections().response(grid[i].rad_s()) - 1.0),
                  0.0, 1e-6);
    }
    // A part that was changed by hand no longer makes what the file says.
    std::string forged = text;
    const std::size_t at = forged.find("realised_f\": ");
    forged.insert(at + 13, "1");
    EXPECT_THROW(CircuitFile::from_node(parse_json(forged, "circuit.json")), InputError);
  }
}

}  // namespace
}  // namespace bodesmith::circuit
