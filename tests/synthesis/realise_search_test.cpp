#include "synthesis/realise_search.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "base/documents/document.hpp"
#include "base/documents/json.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/text.hpp"
#include "schematic/analysis/response.hpp"
#include "schematic/opamp_library.hpp"
#include "seed_sections.hpp"
#include "synthesis/circuit.hpp"
#include "synthesis/circuit_file.hpp"
#include "temporary_folder.hpp"

namespace bodesmith::synthesis {
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
  constexpr std::string_view kWhat = "capacitors up to ";
  ASSERT_TRUE(limits->starts_with(kWhat)) << *limits;
  ASSERT_TRUE(parse_quantity(limits->substr(kWhat.size()), search.options.limits.max_f)) << *limits;
  EXPECT_EQ(refusal_of(realise_for_building(slow_lag(), search)), nullptr);
}

// Of a list the first that leaves nothing to say, cheapest first; where none does, the one that falls short least.
TEST(RealiseSearch, TheFirstOpAmpThatDoesIsTaken) {
  const TemporaryFolder folder;
  const auto listed = [&](const std::string& name, double hz) {
    return fmt::format("[[opamp]]\nname = \"{}\"\ngain_bandwidth_hz = {}\nslew_v_per_s = {}\n", name, hz,
                       20.0 * hz);
  };
  write_file(folder / "list.toml", "schema = \"bodesmith.opamps/1\"\n" + listed("slow", 3e3) +
                                       listed("slower", 1e3) + listed("good", 1e7) + listed("better", 1e8));
  Provenance from;
  const schematic::OpAmpLibrary library = schematic::OpAmpLibrary::read(folder / "list.toml", from);
  BuildSearch search;
  search.opamps = &library;
  search.limits.max_error_db = 0.1;
  const auto outcome = realise_for_building(seed_sections(), search);
  const auto& best = std::get<BuildChoice>(outcome).best;
  EXPECT_EQ(best.made.circuit.opamp.name, "good");
  EXPECT_TRUE(best.shortfalls.empty());
  EXPECT_LT(best.judged.max_magnitude_db, 0.1);
  // None reaches a hundred-thousandth of a dB: the one with the smallest error of all.
  search.limits.max_error_db = 1e-5;
  const auto none = realise_for_building(seed_sections(), search);
  const auto& least = std::get<BuildChoice>(none).best;
  ASSERT_EQ(least.shortfalls.size(), 1u);
  EXPECT_LE(least.judged.max_magnitude_db, best.judged.max_magnitude_db);
  // A margin that none has is said with the margin.
  search.limits = {.min_phase_margin_deg = 100.0, .max_error_db = 3.0};
  const auto shy = realise_for_building(seed_sections(), search);
  EXPECT_NE(std::get<BuildChoice>(shy).best.shortfalls.at(0).find("expected 100 or more"), std::string::npos);
}

// Free to choose, other forms are tried, with isolating resistors and with wider parts, and nothing that falls short more is taken.
TEST(RealiseSearch, AFreeChoiceNeverFallsShortMore) {
  BuildSearch search;
  search.limits = {.min_phase_margin_deg = 100.0, .max_error_db = 1e-3};
  const auto asked = realise_for_building(seed_sections(), search);
  search.may_choose = true;
  const auto chosen = realise_for_building(seed_sections(), search);
  const auto& one = std::get<BuildChoice>(asked).best;
  const auto& other = std::get<BuildChoice>(chosen);
  EXPECT_LE(other.best.shortfalls.size(), one.shortfalls.size());
  EXPECT_TRUE(other.best.shortfalls.size() < one.shortfalls.size() ||
              other.best.judged.max_magnitude_db <= one.judged.max_magnitude_db);
  EXPECT_EQ(other.passed_over.size(), other.best.how == "opamp-rc" ? 0u : 1u);
}

/// A peaking equaliser's pole and zero at 700 Hz differ in their last digits.
TEST(RealiseSearch, OneCornerIsJudgedADecadeToEitherSideHoweverItRounds) {
  Sections one;
  one.sections.push_back(Section::pole_zero(1.0, RadPerSecond{1000.0 * (1.0 + 1e-15)}, RadPerSecond{1000.0}));
  const Band band = judged_band(one);
  EXPECT_NEAR(band.from.value, 100.0 / (2.0 * M_PI), 1e-9);
  EXPECT_NEAR(band.to.value, 10000.0 / (2.0 * M_PI), 1e-9);
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
    const auto before = schematic::network_response(made.circuit, grid);
    const auto after = schematic::network_response(file.circuit, grid);
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

/// Notches on the axis, in a form whose parts find no finite error there: a reason, not a crash.
TEST(RealiseSearch, WhatNoValuesDescribeIsRefused) {
  // An elliptic band stop, 900 to 1100 Hz.
  Sections stop;
  stop.sections.push_back(
      {0.834829080407534,
       {{0.0, 6251.690445656587}, {0.0, -6251.690445656587}},
       {{-144.8183031270501, 5710.269819634079}, {-144.8183031270501, -5710.269819634079}}});
  stop.sections.push_back(
      {1.0669083806131492,
       {{0.0, 6052.487516774252}, {0.0, -6052.487516774252}},
       {{-953.3077225076864, 6178.578947826197}, {-953.3077225076864, -6178.578947826197}}});
  stop.sections.push_back(
      {1.1227299410491356,
       {{0.0, 6457.449655202918}, {0.0, -6457.449655202918}},
       {{-173.47060197801792, 6840.046607919464}, {-173.47060197801792, -6840.046607919464}}});
  BuildSearch search;
  search.options.realisation = "khn";
  const auto outcome = realise_for_building(stop, search);
  const Refusal* refusal = refusal_of(outcome);
  ASSERT_NE(refusal, nullptr);
  EXPECT_FALSE(refusal->reason.empty());
}

}  // namespace
}  // namespace bodesmith::synthesis
