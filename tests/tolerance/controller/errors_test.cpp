#include "schematic/analysis/rest_point.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "synthesis/controller/library.hpp"
#include "synthesis/controller/seed_controller.hpp"
#include "synthesis/generator/at_rest.hpp"
#include "tolerance/controller/errors.hpp"
#include "tolerance/controller/operating_point.hpp"

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

}  // namespace
}  // namespace bodesmith::tolerance
