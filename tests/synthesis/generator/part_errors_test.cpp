#include "synthesis/generator/part_errors.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "schematic/analysis/operating_point.hpp"
#include "schematic/analysis/rest_point.hpp"
#include "synthesis/controller/library.hpp"
#include "synthesis/controller/seed_controller.hpp"
#include "synthesis/generator/at_rest.hpp"
#include "synthesis/generator/copy_numbers.hpp"

namespace bodesmith::generator {
namespace {

/// Greatest difference between the compiled voltages and those of all equations at once.
double greatest_difference(const schematic::RestOrder& order, const schematic::Deviations& off,
                           const std::map<std::string, double>& inputs, int position) {
  schematic::RestPoint rest(order, off);
  for (const auto& [node, volts] : inputs) rest.set(order.node(node), volts);
  rest.settle(position);
  std::map<std::string, double> start;
  for (const schematic::Part& part : order.netlist().parts) {
    for (const std::string& node : {part.from, part.to}) start[node] = rest.volts(node);
  }
  double worst = 0.0;
  for (const auto& [node, volts] : schematic::operating_point(order.netlist(), inputs, position, off, start))
    worst = std::max(worst, std::abs(volts - rest.volts(node)));
  return worst;
}

TEST(RestPoint, RestsAtTheSamePlaceWhereverItComesFrom) {
  const DisturbanceCircuit& c = seed_controller();
  const RestWiring wiring(c);
  const schematic::Deviations off = schematic::Deviations::none(c).of_part(wiring.rate.netlist(), c);
  const int slope = wiring.rate.node("sn");
  schematic::RestPoint moved(wiring.rate, off);
  for (int i = 0; i < 200; ++i) {
    const double volts = -1.2 * 100.0 * c.slope->volts_per_hz * static_cast<double>((i * 83) % 200) / 200.0;
    schematic::RestPoint fresh(wiring.rate, off);
    for (schematic::RestPoint* one : {&moved, &fresh}) one->set(slope, volts), one->settle(0);
    EXPECT_NEAR(moved.volts("cd"), fresh.volts("cd"), 1e-12) << volts;
  }
}

TEST(RestPoint, AThousandDrawnCopiesRestWhereAllEquationsAtOnceSay) {
  const DisturbanceCircuit& c = seed_controller();
  const RestWiring wiring(c);
  const std::vector<Cause> causes = causes_of(c, {});
  const double full = 100.0 * c.slope->volts_per_hz;
  double worst = 0.0;
  for (std::uint64_t draw = 0; draw < 1000; ++draw) {
    const schematic::Deviations off = copy_of(c, causes, draw_values(causes, 1, draw)).off;
    const double part = static_cast<double>(draw % 97) / 97.0;
    worst = std::max(worst, greatest_difference(wiring.rate, off.of_part(wiring.rate.netlist(), c),
                                                {{"sn", -1.2 * full * part}}, 0));
    worst = std::max(worst, greatest_difference(wiring.generator, off.of_part(wiring.generator.netlist(), c),
                                                {{"r", part}, {kArgument, 1.0 - part}, {"cd", 0.1 * part}},
                                                static_cast<int>(draw % 2)));
  }
  EXPECT_LT(worst, 1e-12);
}

TEST(Causes, EachMovesItsOwnNumberAndNoOther) {
  const DisturbanceCircuit& c = seed_controller();
  const std::vector<Cause> causes = causes_of(c, {});
  std::set<std::size_t> moved;
  for (const Cause& cause : causes) {
    Copy copy = copy_of(c, {}, {});
    cause.apply(copy, 0.25);
    const std::vector<double> once = numbers_of(copy);
    cause.apply(copy, 0.25);
    const std::vector<double> twice = numbers_of(copy);
    int own = 0;
    for (std::size_t i = 0; i < once.size(); ++i) {
      if (once[i] == 0.0) continue;
      ++own;
      EXPECT_TRUE(moved.insert(i).second) << cause.name;
      const bool delay = i == once.size() - 3;
      EXPECT_NEAR(once[i], delay ? 0.25 * c.analog_switch.on_delay_s : 0.25, 1e-15) << cause.name;
      EXPECT_NEAR(twice[i], 2.0 * once[i], 1e-15) << cause.name;
    }
    EXPECT_EQ(own, cause.name == "slope detector and switch, timing" ? 2 : 1) << cause.name;
  }
  // All but the diodes, which have no tolerance.
  std::size_t diodes = 0;
  for (const schematic::Part& one : c.parts) diodes += one.kind == schematic::Part::Kind::diode ? 1 : 0;
  EXPECT_EQ(moved.size() + diodes, numbers_of(copy_of(c, {}, {})).size());
}

TEST(Causes, AFigureOfNothingTakesItsOwnAway) {
  const DisturbanceCircuit& c = seed_controller();
  const std::size_t all = causes_of(c, {}).size();
  std::size_t taken = 0;
  for (const PartErrors::Named& one : PartErrors::names()) {
    PartErrors errors;
    errors.*one.value *= 2.0;
    int doubled = 0;
    const std::vector<Cause> usual = causes_of(c, {}), more = causes_of(c, errors);
    for (std::size_t i = 0; i < all; ++i) {
      const double ratio = more[i].departure.scale / usual[i].departure.scale;
      EXPECT_TRUE(std::abs(ratio - 1.0) < 1e-12 || std::abs(ratio - 2.0) < 1e-12);
      doubled += ratio > 1.5 ? 1 : 0;
    }
    errors.*one.value = 0.0;
    const std::size_t left = causes_of(c, errors).size();
    EXPECT_EQ(all - left, static_cast<std::size_t>(doubled)) << one.name;
    EXPECT_LT(left, all) << one.name;
    taken += all - left;
  }
  EXPECT_EQ(taken, all);
}

}  // namespace
}  // namespace bodesmith::generator
