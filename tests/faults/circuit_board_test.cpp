// The quick equations against solving the changed circuit anew.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>

#include "base/error.hpp"
#include "base/text.hpp"
#include "circuits.hpp"
#include "faults/circuit_board.hpp"
#include "schematic/analysis/response.hpp"
#include "schematic/writers/spice_library.hpp"
#include "synthesis/decks/compensator_files.hpp"

namespace bodesmith::faults {
namespace {

using Complex = std::complex<double>;

std::vector<Complex> solved(const synthesis::Circuit& circuit, const std::vector<Hertz>& grid) {
  return schematic::network_response(circuit, grid);
}

CircuitBoard board_of(const synthesis::Circuit& circuit, const std::vector<Hertz>& grid) {
  Measurement measurement;
  measurement.channels.push_back(seen(grid, solved(circuit, grid), 1));
  return CircuitBoard(circuit, measurement, Spread());
}

void expect_same(const Eigen::VectorXcd& quick, const std::vector<Complex>& anew, double tolerance = 1e-8) {
  ASSERT_EQ(static_cast<std::size_t>(quick.size()), anew.size());
  for (std::size_t k = 0; k < anew.size(); ++k)
    EXPECT_LT(std::abs(quick(static_cast<Eigen::Index>(k)) / anew[k] - 1.0), tolerance) << k;
}

TEST(CircuitBoard, AChangedPartIsWhatSolvingAnewFinds) {
  const synthesis::Circuit circuit = small_circuit();
  const std::vector<Hertz> grid = small_grid(12);
  const CircuitBoard board = board_of(circuit, grid);
  expect_same(board.response({}), solved(circuit, grid));
  for (std::size_t i = 0; i < circuit.parts.size(); ++i) {
    synthesis::Circuit changed = circuit;
    changed.parts[i].realised *= 3.0;
    expect_same(board.response(board.changed(i, 3.0)), solved(changed, grid));
  }
}

// A floating input that takes a third of the board's input: as if a divider from there, which nothing loads, drove it.
TEST(CircuitBoard, AnInputThatFollowsTheBoardsInputIsADividerFromThere) {
  const synthesis::Circuit circuit = small_circuit();
  const std::vector<Hertz> grid = small_grid(12);
  const CircuitBoard board = board_of(circuit, grid);
  const auto resistor =
      std::find_if(circuit.parts.begin(), circuit.parts.end(),
                   [](const schematic::Part& part) { return part.kind == schematic::Part::Kind::resistor; });
  for (std::size_t i = 0; i < circuit.opamps.size(); ++i) {
    if (circuit.opamps[i].plus != "0") continue;
    synthesis::Circuit changed = circuit;
    changed.opamps[i].plus = "floating";
    for (const auto& [to, ohm] : {std::pair{"in", 2000.0}, std::pair{"0", 1000.0}}) {
      schematic::Part arm = *resistor;
      arm.name += to;
      arm.from = "floating";
      arm.to = to;
      arm.realised = ohm;
      changed.parts.push_back(arm);
    }
    Effect effect;
    effect.stamps = {board.plus_follows(i, "in", 1.0 / 3.0)};
    expect_same(board.response(effect), solved(changed, grid));
    effect.stamps = {board.plus_follows(i, "0", 1.0 / 3.0)};
    expect_same(board.response(effect), solved(circuit, grid));
  }
}

TEST(CircuitBoard, ThePrintedNetlistIsTheSameBoard) {
  const synthesis::Circuit circuit = small_circuit();
  const schematic::SpiceLibrary library = schematic::read_spice(
      schematic::spice_text(synthesis::compensator_library(circuit, "small")), "compensator.sub");
  const auto grid = small_grid(12);
  Measurement measurement;
  measurement.channels = {seen(grid, schematic::network_response(circuit, grid), 1)};
  const CircuitBoard designed(circuit, measurement, Spread());
  const CircuitBoard printed(library.flat(library.top), measurement, Spread());
  ASSERT_EQ(printed.unknowns(), designed.unknowns());
  EXPECT_LT((printed.response({}) - designed.response({})).norm(), 1e-9 * designed.response({}).norm());
  EXPECT_EQ(printed.faults().size(), designed.faults().size());
  EXPECT_EQ(printed.nodes(), designed.nodes());
}

TEST(CircuitBoard, TwoChangesAtOnceAndANodeInside) {
  const synthesis::Circuit circuit = small_circuit();
  const std::vector<Hertz> grid = small_grid(12);
  const CircuitBoard board = board_of(circuit, grid);
  synthesis::Circuit changed = circuit;
  changed.parts[0].realised *= 0.2;
  changed.parts[3].realised *= 7.0;
  schematic::Part load;
  load.kind = schematic::Part::Kind::capacitor;
  load.name = "Cload";
  load.from = "out";
  load.to = "0";
  load.realised = 2e-7;
  changed.parts.push_back(load);
  Effect effect = joined(board.changed(0, 0.2), board.changed(3, 7.0));
  effect.stamps.push_back(board.admittance("out", "0", 0.0, 2e-7));
  expect_same(board.response(effect), solved(changed, grid));
  expect_same(board.at_node("out", effect), solved(changed, grid));
  expect_same(board.predict(effect).response, solved(changed, grid));
}

TEST(CircuitBoard, WhatIsBuiltInAndWhatComesOnTopAreBothAtOnce) {
  const synthesis::Circuit circuit = small_circuit();
  const std::vector<Hertz> grid = small_grid(12);
  const CircuitBoard board = board_of(circuit, grid);
  const Effect first = joined(board.changed(0, 0.2), board.slowed(1, 0.01, true));
  const auto changed = board.changed_by(first);
  for (std::size_t i = 1; i < circuit.parts.size(); ++i) {
    const Effect second = joined(board.changed(i, 5.0), board.replaced(2, 1e-12));
    const Eigen::VectorXcd both = board.response(joined(first, second));
    const Eigen::VectorXcd on_top = changed->response(second);
    EXPECT_LT((on_top - both).norm(), 1e-7 * both.norm()) << i;
    const Eigen::VectorXcd one = board.response(joined(first, board.changed(i, 5.0)));
    EXPECT_LT((changed->response(board.changed(i, 5.0)) - one).norm(), 1e-7 * one.norm()) << i;
  }
}

/// What is not known of a slow op-amp is a share of what it changes, not of what another fault changes beside it.
TEST(CircuitBoard, TheModelErrorOfARoughFaultIsCountedFromTheOtherOne) {
  const synthesis::Circuit circuit = small_circuit();
  const CircuitBoard board = board_of(circuit, small_grid(12));
  Effect slow = board.slowed(0, 0.01, true);
  slow.model_error = 0.02;
  for (Stamp& stamp : slow.stamps) stamp.rough = true;
  const Effect decade = board.changed(0, 10.0);
  const Eigen::VectorXcd beside = board.response(decade);
  EXPECT_LT((board.predict(joined(decade, slow)).reference - beside).norm(), 1e-12 * beside.norm());
  EXPECT_EQ(board.predict(slow).reference.size(), 0);
  EXPECT_EQ(board.predict(decade).reference.size(), 0);
}

TEST(CircuitBoard, OnlyALoadAtAnOpAmpIsKnownRoughly) {
  const synthesis::Circuit circuit = small_circuit();
  const CircuitBoard board = board_of(circuit, small_grid(12));
  int rough = 0;
  int exact = 0;
  for (const Fault& fault : board.faults()) {
    if (!fault.kind->name().ends_with("_load")) continue;
    const std::string node =
        fault.site == "the output" ? "out" : fault.site.substr(std::string("node ").size());
    const bool driven = std::any_of(circuit.opamps.begin(), circuit.opamps.end(),
                                    [&](const schematic::OpAmp& one) { return one.out == node; });
    const Effect effect = fault.effect(fault.from);
    EXPECT_EQ(effect.model_error > 0.0, driven) << fault.site;
    EXPECT_EQ(effect.stamps[0].rough, driven) << fault.site;
    ++(driven ? rough : exact);
  }
  EXPECT_GT(rough, 0);
  EXPECT_GT(exact, 0);
}

TEST(CircuitBoard, ASlowerOpAmpIsWhatSolvingAnewFinds) {
  const synthesis::Circuit circuit = small_circuit();
  const std::vector<Hertz> grid = small_grid(12);
  const CircuitBoard board = board_of(circuit, grid);
  synthesis::Circuit slow = circuit;
  slow.opamp.gain_bandwidth.value *= 0.01;
  Effect effect;
  const double ft = circuit.opamp.gain_bandwidth.rad_s().value;
  for (std::size_t i = 0; i < circuit.opamps.size(); ++i)
    effect.stamps.push_back(board.slower(i, 0.0, 99.0 / ft));
  expect_same(board.response(effect), solved(slow, grid));
}

TEST(CircuitBoard, SlopesAreThoseOfFiniteDifferences) {
  const synthesis::Circuit circuit = small_circuit();
  const std::vector<Hertz> grid = small_grid(8);
  const CircuitBoard board = board_of(circuit, grid);
  // On a board with a fault: the slopes belong to it, not to the good one.
  const Effect fault = board.changed(1, 4.0);
  const Prediction at = board.predict(fault);
  for (std::size_t i = 0; i < circuit.parts.size(); ++i) {
    if (i == 1) continue;
    const double sigma = 0.6 * board.tolerance(i);
    const double step = 1e-5;
    const auto up = board.response(joined(fault, board.changed(i, 1.0 + step)));
    for (Eigen::Index k = 0; k < up.size(); ++k) {
      const Complex slope = std::log(up(k) / at.response(k)) / step * sigma;
      EXPECT_LT(std::abs(slope - at.slopes(k, static_cast<Eigen::Index>(i))), 1e-4 * sigma * 10.0) << i;
    }
  }
}

/// The size that files and words give is the value that, soldered in, shows what the fault's effect shows.
TEST(FaultKinds, WhatAFaultSaysIsWhatItDoes) {
  const synthesis::Circuit circuit = small_circuit();
  const std::vector<Hertz> grid = small_grid(6);
  const CircuitBoard board = board_of(circuit, grid);
  std::map<std::string_view, int> seen_of;
  for (const Fault& fault : board.faults()) {
    for (const double share : {0.0, 0.3, 1.0}) {
      const double t = fault.from + share * (fault.to - fault.from);
      const FaultSize size = fault.size(t);
      if (size.key.empty()) continue;
      SCOPED_TRACE(fault.words(t));
      ++seen_of[fault.kind->name()];
      const std::map<std::string, std::string> units = {
          {"value_ohm", "Ω"}, {"value_f", "F"}, {"gain_bandwidth_hz", "Hz"}};
      EXPECT_NE(fault.words(t).find(engineering_text(size.value, units.at(size.key))), std::string::npos);
      synthesis::Circuit changed = circuit;
      if (size.key == "gain_bandwidth_hz") {
        EXPECT_NEAR(size.value, circuit.opamp.gain_bandwidth.value * std::exp(t), 1e-9 * size.value);
        if (fault.covers.empty()) continue;  // a single one has no model of its own in a circuit
        changed.opamp.gain_bandwidth.value = size.value;
      } else if (const auto part = std::find_if(changed.parts.begin(), changed.parts.end(),
                                                [&](const auto& one) { return one.name == fault.parts[0]; });
                 part != changed.parts.end()) {
        EXPECT_EQ(size.key, part->kind == schematic::Part::Kind::resistor ? "value_ohm" : "value_f");
        part->realised = size.value;
      } else {
        const bool ohm = size.key == "value_ohm";
        const std::string node =
            fault.site == "the output" ? "out" : fault.site.substr(std::string("node ").size());
        changed.parts.push_back({ohm ? schematic::Part::Kind::resistor : schematic::Part::Kind::capacitor,
                                 "Zload", "", 0, node, "0", "exact", size.value, size.value});
      }
      // Dead op-amps leave little of the numbers.
      expect_same(board.response(fault.effect(t)), solved(changed, grid), fault.covers.empty() ? 1e-8 : 1e-4);
    }
  }
  for (const char* kind :
       {"value_off", "wrong_decade", "opamp_too_slow", "capacitive_load", "resistive_load"})
    EXPECT_GT(seen_of[kind], 0) << kind;
}

TEST(CircuitBoard, ANodeThatIsNotThereIsRefused) {
  const synthesis::Circuit circuit = small_circuit();
  Measurement measurement;
  measurement.channels.push_back(seen(small_grid(8), solved(circuit, small_grid(8)), 1));
  measurement.channels[0].node = "nowhere";
  EXPECT_THROW(CircuitBoard(circuit, measurement, Spread()), InputError);
}

}  // namespace
}  // namespace bodesmith::faults
