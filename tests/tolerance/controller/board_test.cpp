#include "tolerance/controller/board.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "schematic/analysis/operating_point.hpp"
#include "synthesis/controller/library.hpp"
#include "synthesis/controller/seed_controller.hpp"
#include "synthesis/generator/part_errors.hpp"

namespace bodesmith::tolerance {
namespace {

constexpr std::uint64_t kCopies = 1000;

/// Without what open contacts leak: a board tabulates each branch with the other's gain as it last was, which a contact of
/// 1e-10 S lets through as some 1e-10 of the stroke.
const generator::DisturbanceCircuit& tight_controller() {
  static const generator::DisturbanceCircuit made = [] {
    generator::DisturbanceCircuit out = generator::seed_controller();
    out.analog_switch.off_siemens = 1e-16;
    return out;
  }();
  return made;
}

/// V of every node of a netlist at rest, from the compiled form: where Newton's method begins.
std::map<std::string, double> begin_at(const schematic::RestOrder& order, const schematic::Deviations& off,
                                       const std::map<std::string, double>& inputs, int position) {
  schematic::RestPoint rest(order, off);
  for (const auto& [node, volts] : inputs) rest.set(order.node(node), volts);
  rest.settle(position);
  std::map<std::string, double> out;
  const auto take = [&](const std::string& node) { out[node] = rest.volts(node); };
  for (const schematic::Part& one : order.netlist().parts) take(one.from), take(one.to);
  for (const schematic::OpAmp& one : order.netlist().opamps) take(one.out);
  for (const schematic::Multiplier& one : order.netlist().multipliers) take(one.out);
  return out;
}

/// v of one copy at rest from the equations of all elements at once, its drive fed back.
double rest_by_all_equations(const generator::RestWiring& wiring, const schematic::Deviations& off,
                             double slope_v, double r, bool rising, double start_v) {
  const generator::DisturbanceCircuit& c = wiring.circuit;
  const schematic::Netlist& rate = wiring.rate.netlist();
  const std::map<std::string, double> slope = {{"sn", slope_v}};
  const schematic::Deviations off_rate = off.of_part(rate, c);
  const auto control =
      schematic::operating_point(rate, slope, 0, off_rate, begin_at(wiring.rate, off_rate, slope, 0));
  std::map<std::string, double> inputs = {{"r", r}};
  for (const generator::Branch& b : c.branches) {
    if (const generator::BranchGain& gain = b.rate; gain.control >= 0)
      inputs[c.op(gain.control).out] = control.at(c.op(gain.control).out);
  }
  std::map<std::string, double> cut = inputs;
  cut[generator::kArgument] = start_v;
  const int position = rising ? 0 : 1;
  auto start = begin_at(wiring.generator, off.of_part(wiring.generator.netlist(), c), cut, position);
  start["v"] = start_v;
  schematic::Netlist generator = generator::generator_netlist(c, false);
  generator.sources.clear();
  return schematic::operating_point(generator, inputs, position, off.of_part(generator, c), start).at("v");
}

TEST(Board, AThousandDrawnCopiesRestWhereAllEquationsAtOnceSay) {
  const generator::DisturbanceCircuit& c = tight_controller();
  const generator::RestWiring wiring(c);
  const std::vector<generator::Cause> causes = causes_of(c, {});
  const double full = 100.0 * c.slope->volts_per_hz;
  double worst = 0.0;
  for (std::uint64_t draw = 0; draw < kCopies; ++draw) {
    const generator::Copy copy = copy_of(c, causes, draw_values(causes, 1, draw));
    const Board board(wiring, copy);
    const double r = static_cast<double>(draw % 97) / 96.0,
                 slope_v = -full * static_cast<double>(draw % 13) / 12.0;
    const bool rising = draw % 2 == 0;
    const double v = board.at_rest(r, rising, slope_v);
    worst = std::max(worst, std::abs(v - rest_by_all_equations(wiring, copy.off, slope_v, r, rising, v)));
  }
  EXPECT_LT(worst, 1e-12);
}

TEST(Board, TheSlopeMeterAtRestIsItsNetlist) {
  const generator::DisturbanceCircuit& c = tight_controller();
  const schematic::Netlist meter = schematic::subset(
      c, [&](std::size_t group) { return c.purpose_of(group) == schematic::Purpose::slope_meter; });
  const std::vector<generator::Cause> causes = causes_of(c, {});
  const schematic::RestOrder order(meter, {"r"});
  int conducts = 0, blocks = 0;
  for (std::uint64_t draw = 0; draw < 40; ++draw) {
    const generator::Copy copy = copy_of(c, causes, draw_values(causes, 3, draw));
    const auto gains = generator::SlopeMeterGains::of(c, copy.off);
    const double volts = gains.output_v(0.0);
    schematic::RestPoint rest(order, copy.off.of_part(meter, c));
    rest.set(order.node("r"), 0.4);
    rest.settle(0);
    // Ideal diodes conduct both where the half wave is below its own op-amp's offset, where real ones have half a volt between
    // them.
    const double driven = gains.half_offset - gains.half_gain * gains.offset;
    if (std::max(driven, gains.half_rest) < gains.half_offset / (1.0 + gains.half_gain)) continue;
    EXPECT_NEAR(rest.volts("sn"), volts, 1e-12) << draw;
    ++(driven > gains.half_rest ? conducts : blocks);
  }
  EXPECT_GT(conducts, 5);
  EXPECT_GT(blocks, 5);
}

/// v over one repeat, every voltage worked out from the netlist at rest again at every sample; the slope of what the
/// generator makes by differences. Delays as first order in the slopes, each amplifier's its noise gain over 2 pi GBW.
class SlowDrive {
 public:
  SlowDrive(const generator::RestWiring& wiring, const generator::Copy& copy)
      : c_(wiring.circuit), rest_(wiring, copy.off) {
    const double per_gain =
        1.0 / (2.0 * std::numbers::pi * c_.opamp.gain_bandwidth.value * (1.0 + copy.speed));
    const generator::Pass& last = c_.passes.back();
    output_s_ = rest_.noise_gain(last.output.opamp) * per_gain;
    for (std::size_t b = 0; b < 2; ++b) {
      delay_s_[b] = 2.0 / (2.0 * std::numbers::pi * c_.multiplier.bandwidth.value);
      if (last.branch_opamp[b] >= 0) delay_s_[b] += rest_.noise_gain(last.branch_opamp[b]) * per_gain;
    }
  }

  double at(double r, double rate, double slope_v, bool rising) {
    rest_.set_slope(slope_v);
    const double gain = rest_.reference_gain();
    const auto made = [&](double v) { return rest_.made(0.0, v, rising ? 0 : 1); };
    const double late = delay_s_[rising ? 0 : 1] + output_s_;
    const auto left = [&](double v) {
      constexpr double kStep =
          1e-3;  // what is made is a polynomial of low order: Richardson's step takes the rest away
      const auto difference = [&](double h) { return (made(v + h) - made(v - h)) / (2.0 * h); };
      const double slope = (4.0 * difference(kStep) - difference(2.0 * kStep)) / 3.0;
      return gain * (r - rate * output_s_) + made(v) - slope * gain * rate / (1.0 - slope) * late - v;
    };
    double a = r - 0.1, b = r + 0.1, at_a = left(a), at_b = left(b);
    for (int i = 0; i < 60 && std::abs(b - a) > 1e-14 && at_b != at_a; ++i) {  // secant
      const double next = b - at_b * (b - a) / (at_b - at_a);
      a = b;
      at_a = at_b;
      b = next;
      at_b = left(b);
    }
    return b;
  }

 private:
  const generator::DisturbanceCircuit& c_;
  generator::AtRest rest_;
  double output_s_ = 0.0, delay_s_[2] = {};
};

TEST(Board, AThousandDrawnCopiesDriveAsTheNetlistSolvedAtEverySample) {
  const generator::DisturbanceCircuit& c = tight_controller();
  const generator::RestWiring wiring(c);
  const std::vector<generator::Cause> causes = causes_of(c, {});
  double worst = 0.0;
  for (std::uint64_t draw = 0; draw < kCopies; ++draw) {
    const generator::Copy copy = copy_of(c, causes, draw_values(causes, 1, draw));
    const Board board(wiring, copy);
    const Input input = input_of(tracking::Reference(), generator::seed_frequencies()[draw % 7], 16);
    const std::vector<double> v = board.drive(input), sn = board.slope_voltage(input);
    SlowDrive slow(wiring, copy);
    for (const std::size_t k :
         {3 + draw % 4, 11 + draw % 4}) {  // away from the turns, where the switch has not acted
      worst =
          std::max(worst, std::abs(v[k] - slow.at(input.r[k], input.slope[k - 1], sn[k], input.rising[k])));
    }
  }
  EXPECT_LT(worst, 1e-12);
}

}  // namespace
}  // namespace bodesmith::tolerance
