// Boards of the program's own equations with parts of 1 %: what is named, tied, refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <string_view>

#include "base/documents/json.hpp"
#include "base/text.hpp"
#include "circuits.hpp"
#include "faults/circuit_board.hpp"
#include "faults/diagnosis.hpp"
#include "faults/report.hpp"
#include "kept_text.hpp"
#include "schematic/analysis/response.hpp"

namespace bodesmith::faults {
namespace {

using testing::HasSubstr;
using testing::Not;

/// What is said of it in every form: the same parts, the same numbers.
void expect_told(const Diagnosis& d, const Board& board) {
  const Json json = to_json(d, board, Spread(), Priors());
  const std::string page = report_page(d, board, "board"), summary = summary_text(d);
  const bool named = d.verdict == Verdict::one_fault || d.verdict == Verdict::two_faults;
  EXPECT_EQ(json["named"].empty(), !named);
  EXPECT_EQ(json["tied"].size(), d.verdict == Verdict::tie ? d.tied : 0u);
  double before = 1.0, sum = json["nothing_wrong_probability"];
  for (std::size_t i = 0; i < json["suspects"].size(); ++i) {
    const Json& one = json["suspects"][i];
    EXPECT_EQ(one["site"], d.suspects[i].site);
    EXPECT_EQ(one["faults"].size(), d.suspects[i].best.faults.size());
    EXPECT_LE(one["probability"], before);
    sum += before = one["probability"];
  }
  EXPECT_LE(sum, 1.0 + 1e-9);
  EXPECT_GE(json["suspects"].size(), std::min<std::size_t>(d.tied, 20));
  if (named || d.verdict == Verdict::tie) {
    for (const std::string& text : {page, summary, json["sentence"].get<std::string>()})
      EXPECT_THAT(text, HasSubstr(d.suspects[0].best.faults[0]->parts[0]));
  }
  for (const std::string& step : next_steps(d)) EXPECT_THAT(summary, HasSubstr(step));
  EXPECT_EQ(json["next"].size(), next_steps(d).size());
  EXPECT_EQ(json["measured"][0]["points_used"], board.measured().channels[0].grid.size());
  EXPECT_NEAR(json["noise"]["magnitude_db"], d.noise.gain * 20.0 / std::log(10.0), 1e-12);
  EXPECT_NEAR(json["noise"]["phase_deg"], d.noise.phase * 180.0 / M_PI, 1e-12);
  EXPECT_THAT(page, HasSubstr("as designed"));
}

Diagnosis diagnosed(const synthesis::Circuit& designed, const synthesis::Circuit& built,
                    bool with_phase = true, const std::string& kept = "") {
  const std::vector<Hertz> grid = small_grid();
  Measurement measurement;
  measurement.channels.push_back(seen(grid, schematic::network_response(built, grid), 5, with_phase));
  const CircuitBoard board(designed, measurement, Spread());
  DiagnosisOptions options;
  double share = 0.0;
  options.progress = [&](double now) {
    EXPECT_GE(now, share);  // it never goes back
    share = now;
  };
  Diagnosis out = diagnose_board(board, options);
  EXPECT_LE(share, 1.0);
  expect_told(out, board);
  if (!kept.empty())
    expect_kept(kept, line_a_key(to_json(out, board, Spread(), Priors())) + summary_text(out) +
                          digest(few_digits(report_page(out, board, "board"))) + " page\n");
  return out;
}

bool among_tied(const Diagnosis& d, const std::string& part) {
  for (std::size_t i = 0; i < d.tied; ++i) {
    for (const Fault* fault : d.suspects[i].best.faults) {
      if (std::find(fault->parts.begin(), fault->parts.end(), part) != fault->parts.end()) return true;
    }
  }
  return false;
}

TEST(BoardDiagnosis, AGoodBoardIsNotAccused) {
  const synthesis::Circuit circuit = small_circuit();
  const Diagnosis d = diagnosed(circuit, drawn_parts(circuit, 1), true, "faults/kept_good.txt");
  EXPECT_EQ(d.verdict, Verdict::nothing_wrong);
  EXPECT_GT(d.good_probability, 0.5);
}

TEST(BoardDiagnosis, ACapacitorOfAnotherValueIsNamedOrTied) {
  const synthesis::Circuit circuit = small_circuit();
  std::size_t capacitors = 0;
  for (std::size_t i = 0; i < circuit.parts.size(); ++i) {
    if (circuit.parts[i].kind != schematic::Part::Kind::capacitor || capacitors++ % 4 != 0) continue;
    synthesis::Circuit built = drawn_parts(circuit, 7 + i);
    built.parts[i].realised *= 1.47;
    const Diagnosis d = diagnosed(circuit, built, true, capacitors == 1 ? "faults/kept_capacitor.txt" : "");
    EXPECT_TRUE(d.verdict == Verdict::one_fault || d.verdict == Verdict::tie) << circuit.parts[i].name;
    EXPECT_TRUE(among_tied(d, circuit.parts[i].name)) << circuit.parts[i].name;
    if (d.verdict != Verdict::one_fault) continue;
    EXPECT_NEAR(std::exp(std::exp(d.suspects[0].best.sizes[0])), 1.47, 0.05) << circuit.parts[i].name;
    EXPECT_FALSE(d.rework.empty());
  }
}

TEST(BoardDiagnosis, MagnitudeAloneIsEnoughForAWrongDecade) {
  const synthesis::Circuit circuit = small_circuit();
  synthesis::Circuit built = drawn_parts(circuit, 3);
  built.parts[2].realised *= 10.0;
  const Diagnosis d = diagnosed(circuit, built, false);
  EXPECT_TRUE(among_tied(d, built.parts[2].name));
}

TEST(BoardDiagnosis, TwoFaultsAtOnce) {
  const synthesis::Circuit circuit = small_circuit();
  synthesis::Circuit built = drawn_parts(circuit, 4);
  std::vector<std::size_t> capacitors;
  for (std::size_t i = 0; i < built.parts.size(); ++i) {
    if (built.parts[i].kind == schematic::Part::Kind::capacitor) capacitors.push_back(i);
  }
  built.parts[capacitors.front()].realised *= 1.6;
  built.parts[capacitors.back()].realised *= 0.55;
  const Diagnosis d = diagnosed(circuit, built, true, "faults/kept_two.txt");
  EXPECT_TRUE(d.verdict == Verdict::two_faults || d.verdict == Verdict::tie);
  EXPECT_EQ(d.suspects[0].best.faults.size(), 2u);
  EXPECT_TRUE(among_tied(d, built.parts[capacitors.front()].name));
  EXPECT_TRUE(among_tied(d, built.parts[capacitors.back()].name));
}

/// A roughly known fault (a floating input, a slow op-amp) fits two others to within its model's error, and is not named
/// before these have been tried.
TEST(BoardDiagnosis, ARoughlyKnownFaultDoesNotPassForTwoOthers) {
  const synthesis::Circuit circuit = small_circuit();
  synthesis::Circuit built = drawn_parts(circuit, 6);
  for (schematic::Part& part : built.parts) {
    if (part.name == "Rq_4") part.realised *= 0.6;
    if (part.name == "R1_1") part.realised *= 0.1;
  }
  const Diagnosis d = diagnosed(circuit, built);
  EXPECT_TRUE(d.verdict == Verdict::two_faults || d.verdict == Verdict::tie);
  EXPECT_EQ(d.suspects[0].best.faults.size(), 2u) << d.suspects[0].site;
  EXPECT_TRUE(among_tied(d, "Rq_4")) << d.suspects[0].site;
  EXPECT_TRUE(among_tied(d, "R1_1")) << d.suspects[0].site;
}

TEST(BoardDiagnosis, EveryOpAmpIsNoSecondFaultOfOneOfThem) {
  const synthesis::Circuit circuit = small_circuit();
  synthesis::Circuit built = drawn_parts(circuit, 8);
  built.opamp.gain_bandwidth.value *= 0.004;
  built.parts[1].realised *= 1.4;
  const Diagnosis d = diagnosed(circuit, built);
  for (const Suspect& suspect : d.suspects) {
    if (suspect.best.faults.size() < 2) continue;
    const bool all = suspect.site.find("every op-amp") != std::string::npos;
    const auto is_slow = [](const Fault* fault) { return fault->kind->name() == "opamp_too_slow"; };
    const auto slow = std::count_if(suspect.best.faults.begin(), suspect.best.faults.end(), is_slow);
    EXPECT_FALSE(all && slow > 1) << suspect.site;
  }
  EXPECT_TRUE(among_tied(d, "every op-amp")) << d.suspects[0].site;
}

/// An input that is not connected says nothing of the stages before it; another value of a part hides none.
TEST(BoardDiagnosis, WhatIsHiddenBehindAFaultIsSaid) {
  const synthesis::Circuit circuit = small_circuit();
  const std::vector<Hertz> grid = small_grid();
  const Measurement measurement{{seen(grid, schematic::network_response(circuit, grid), 5)}};
  const CircuitBoard board(circuit, measurement, Spread());
  const std::vector<Fault> faults = board.faults();
  const auto hidden_by = [&](const std::string& site, std::string_view kind, double t) {
    const auto at = std::find_if(faults.begin(), faults.end(), [&](const Fault& fault) {
      return fault.site == site && fault.kind->name() == kind;
    });
    EXPECT_NE(at, faults.end()) << site;
    Suspect suspect;
    suspect.best.faults = {&*at};
    suspect.best.sizes = {t};
    return hidden_behind(board, faults, std::span(&suspect, 1));
  };
  std::vector<std::string> inputs;
  for (const schematic::Part& part : circuit.parts) {
    if (part.group + 1 == circuit.stages.size() && part.from == circuit.stages.back().in)
      inputs.push_back(part.name);
  }
  ASSERT_EQ(inputs.size(), 1u);
  const std::vector<std::string> hidden = hidden_by(inputs[0], "open", 0.0);
  for (const schematic::Part& part : circuit.parts) {
    const bool is_hidden = std::find(hidden.begin(), hidden.end(), part.name) != hidden.end();
    if (part.name == "R1_1" || part.name == "R2_1") {
      EXPECT_TRUE(is_hidden) << part.name;
    }
    if (part.name == inputs[0]) {
      EXPECT_FALSE(is_hidden);
    }
  }
  EXPECT_TRUE(hidden_by("R1_1", "value_off", std::log(0.3)).empty());
}

/// Parts thousands of tolerances off would make a dead board of a good one.
TEST(BoardDiagnosis, ADeadOutputIsNoGoodBoard) {
  const synthesis::Circuit circuit = small_circuit();
  const std::vector<Hertz> grid = small_grid();
  Channel nothing = seen(grid, schematic::network_response(circuit, grid), 5, true);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    nothing.log_gain[i] = std::log(1e-5);
    nothing.phase_rad[i] = std::fmod(2.4 * static_cast<double>(i * i), 3.0);
  }
  const CircuitBoard board(circuit, Measurement{{nothing}}, Spread());
  const Diagnosis d = diagnose_board(board, DiagnosisOptions());
  EXPECT_TRUE(d.verdict == Verdict::tie || d.verdict == Verdict::one_fault);
  EXPECT_LT(d.good_probability, 1e-3);
}

TEST(BoardDiagnosis, WhatNoFaultExplainsIsSaidToBeUnexplained) {
  const synthesis::Circuit circuit = small_circuit();
  const std::vector<Hertz> grid = small_grid(64);
  auto response = schematic::network_response(circuit, grid);
  for (std::size_t k = 0; k < grid.size(); ++k)  // a comb: no circuit of these parts makes it
    response[k] *= std::exp(std::complex<double>(0.3 * std::sin(1.7 * std::log(grid[k].value) * 2.0), 0.2));
  Measurement measurement;
  measurement.channels.push_back(seen(grid, response, 9));
  const CircuitBoard board(circuit, measurement, Spread());
  const Diagnosis d = diagnose_board(board, DiagnosisOptions());
  EXPECT_EQ(d.verdict, Verdict::unexplained);
  EXPECT_TRUE(d.rework.empty());
}

TEST(BoardDiagnosis, TheSecondMeasurementOfANodeIsUsed) {
  const synthesis::Circuit circuit = small_circuit();
  synthesis::Circuit built = drawn_parts(circuit, 11);
  // Gain of a stage: which of them, the output alone may not say.
  built.parts[0].realised *= 1.3;
  const std::vector<Hertz> grid = small_grid();
  Measurement measurement;
  measurement.channels.push_back(seen(grid, schematic::network_response(built, grid), 5));
  const CircuitBoard outside(circuit, measurement, Spread());
  const Diagnosis first = diagnose_board(outside, DiagnosisOptions());
  ASSERT_TRUE(among_tied(first, built.parts[0].name));
  // The node after the first stage, of the board as it was built.
  const std::string node = circuit.stages[0].out;
  const CircuitBoard truth(built, measurement, Spread());
  const Eigen::VectorXcd inside = truth.at_node(node, {});
  Channel more = seen(grid, {inside.data(), inside.data() + inside.size()}, 6);
  more.node = node;
  measurement.channels.push_back(more);
  const CircuitBoard both(circuit, measurement, Spread());
  const Diagnosis second = diagnose_board(both, DiagnosisOptions());
  EXPECT_TRUE(among_tied(second, built.parts[0].name));
  EXPECT_LE(second.tied, first.tied);
}

/// The sentence of each verdict.
TEST(FaultReport, EveryVerdictHasItsSentence) {
  Diagnosis d;
  for (const auto& [site, probability] :
       {std::pair("C1", 0.6), std::pair("R2", 0.39), std::pair("U1", 0.01)}) {
    d.suspects.emplace_back().site = site;
    d.suspects.back().probability = probability;
  }
  d.tied = 2;
  d.verdict = Verdict::tie;
  EXPECT_THAT(verdict_sentence(d), HasSubstr("C1, or R2"));
  EXPECT_THAT(verdict_sentence(d), Not(HasSubstr("U1")));
  EXPECT_THAT(next_steps(d).at(0), HasSubstr("lift one end"));
  d.probe = Probe{"n3", Hertz{2000.0}, 4.0, 30.0, 9.0, {}};
  EXPECT_THAT(next_steps(d).at(0), HasSubstr("probe node n3 next: at 2 kHz"));
  d.probe.reset();
  d.verdict = Verdict::uncertain;
  EXPECT_THAT(verdict_sentence(d), HasSubstr("C1 (60 %)"));
  EXPECT_THAT(next_steps(d).at(0), HasSubstr("measure again"));
  d.verdict = Verdict::unexplained;
  EXPECT_THAT(verdict_sentence(d), HasSubstr("no part is named"));
  EXPECT_THAT(summary_text(d), HasSubstr("nearest, and not enough"));
  d.verdict = Verdict::nothing_wrong;
  d.good_probability = 0.9;
  d.wider_probability = 0.8;
  EXPECT_THAT(verdict_sentence(d), HasSubstr("spread wider"));
  EXPECT_THAT(summary_text(d), HasSubstr("10 %"));
}

}  // namespace
}  // namespace bodesmith::faults
