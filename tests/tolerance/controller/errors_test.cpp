#include "schematic/analysis/rest_point.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "synthesis/controller/library.hpp"
#include "synthesis/controller/seed_controller.hpp"
#include "synthesis/generator/at_rest.hpp"
#include "tolerance/controller/errors.hpp"
#include "tolerance/controller/operating_point.hpp"
#include "tolerance/controller/trim.hpp"

namespace bodesmith::tolerance {
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
  const generator::DisturbanceCircuit& c = generator::seed_controller();
  const generator::RestWiring wiring(c);
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
  const generator::DisturbanceCircuit& c = generator::seed_controller();
  const generator::RestWiring wiring(c);
  const std::vector<Cause> causes = causes_of(c, {});
  const double full = 100.0 * c.slope->volts_per_hz;
  double worst = 0.0;
  for (std::uint64_t draw = 0; draw < 1000; ++draw) {
    const schematic::Deviations off = copy_of(c, causes, draw_values(causes, 1, draw)).off;
    const double part = static_cast<double>(draw % 97) / 97.0;
    worst = std::max(worst, greatest_difference(wiring.rate, off.of_part(wiring.rate.netlist(), c),
                                                {{"sn", -1.2 * full * part}}, 0));
    worst = std::max(
        worst, greatest_difference(wiring.generator, off.of_part(wiring.generator.netlist(), c),
                                   {{"r", part}, {generator::kArgument, 1.0 - part}, {"cd", 0.1 * part}},
                                   static_cast<int>(draw % 2)));
  }
  EXPECT_LT(worst, 1e-12);
}

/// Every number of a copy, one behind the other.
std::vector<double> numbers_of(const Copy& copy) {
  std::vector<double> out = copy.off.part;
  const auto add = [&](const std::vector<double>& more) { out.insert(out.end(), more.begin(), more.end()); };
  add(copy.off.opamp_offset_v);
  add(copy.off.source);
  for (const schematic::MultiplierDeviation& m : copy.off.multiplier) add({m.x, m.y, m.w, m.scale, m.bend});
  add({copy.off.switch_relative, copy.off.switch_charge_c, copy.off.switch_delay_s, copy.speed, copy.timing});
  return out;
}

TEST(Causes, EachMovesItsOwnNumberAndNoOther) {
  const generator::DisturbanceCircuit& c = generator::seed_controller();
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
  const generator::DisturbanceCircuit& c = generator::seed_controller();
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

TEST(Causes, TrimsMoveWhatTheyNameByTheirSetting) {
  const generator::DisturbanceCircuit& c = generator::seed_controller();
  for (const Trim& trim : trims_of(c)) {
    Copy copy = copy_of(c, {}, {});
    trim.apply(copy, 0.01);
    double sum = 0.0, most = 0.0;
    for (const double v : numbers_of(copy)) sum += v, most = std::max(most, std::abs(v));
    EXPECT_EQ(sum, most) << trim.name;  // one number, upwards
    if (trim.name == "output offset") {
      // At the output: less at the op-amp's input by its noise gain.
      EXPECT_GT(most, 0.0);
      EXPECT_LT(most, 0.01);
    } else {
      EXPECT_EQ(most, 0.01) << trim.name;
    }
    EXPECT_NEAR(trim.unit_setting, 2.0 * trim.limit / 1000.0, 1e-15) << trim.name;
    EXPECT_EQ(trim.limit, trim.unit == "V" ? 0.03 : trim.name == "reference gain" ? 0.01 : 0.05) << trim.name;
  }
}

}  // namespace
}  // namespace bodesmith::tolerance
