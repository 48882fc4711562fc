#include "part_errors/loop.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/text.hpp"
#include "controller/at_rest.hpp"
#include "controller/library.hpp"
#include "lti/frequency_grid.hpp"
#include "lti/loop_margins.hpp"
#include "schematic/analysis/response.hpp"

namespace bodesmith::part_errors {
namespace {

using controller::AnalogController;

/// v = 0, 1/4 … 1; both branches; the gain curve's corners, where the gains' extremes are.
std::vector<LoopPoint> loop_points(const AnalogController& c) {
  std::vector<Hertz> operating = {c.tracked.empty() ? Hertz{1.0} : c.tracked.front()};
  if (c.curve) operating = c.curve->corner;
  std::vector<LoopPoint> out;
  for (const auto branch : {Disturbance::Branch::ascending, Disturbance::Branch::descending}) {
    std::vector<double> seen;
    for (const Hertz f : operating) {
      const double gain = c.curve ? c.curve->value(branch, f) : 1.0;
      const bool known =
          std::any_of(seen.begin(), seen.end(), [&](double one) { return std::abs(one - gain) < 1e-6; });
      if (known) continue;
      seen.push_back(gain);
      for (int i = 0; i <= 4; ++i) out.push_back({branch, 0.25 * i, f, gain});
    }
  }
  return out;
}

/// The generator cut at its argument, for small signals about the point.
schematic::Equations cut_loop(const AnalogController& controller, const LoopPoint& point) {
  LoopBias bias = bias_of(controller, point);
  bias.volts[controller::kArgument] = point.v;
  schematic::Equations out(controller::generator_netlist(controller, true),
                           {.position = bias.position, .input = controller::kArgument});
  out.linearise(bias.volts);
  return out;
}

LoopAt look_at(const AnalogController& controller, const LoopPoint& point, const std::vector<Hertz>& grid) {
  const LoopBias bias = bias_of(controller, point);
  const schematic::Netlist netlist = controller::generator_netlist(controller, false);
  schematic::Equations closed(netlist, {.position = bias.position});
  closed.linearise(bias.volts);
  const schematic::Equations cut = cut_loop(controller, point);
  const bool fed = controller.form == controller::Form::self_fed;
  LoopAt out;
  out.point = point;
  std::vector<std::complex<double>> loop;
  std::vector<std::vector<std::complex<double>>> own(netlist.opamps.size());
  for (const Hertz f : grid) {
    loop.push_back(fed ? -cut.response(f.rad_s(), "v") : 0.0);
    out.greatest_gain = std::max(out.greatest_gain, std::abs(loop.back()));
    for (std::size_t k = 0; k < own.size(); ++k)
      own[k].push_back(schematic::return_ratio(closed, netlist, k, f.rad_s()));
  }
  out.gain_margin_db = loop_margins(grid, loop).gain_margin_db().value_or(0.0);
  for (std::size_t k = 0; k < own.size(); ++k) {
    const schematic::OpAmp& u = netlist.opamps[k];
    const LoopMargins margins = loop_margins(grid, own[k]);
    const auto* least = margins.least_phase_margin();
    out.opamps.push_back(
        {u.name, u.role, margins.phase_margin_deg(), least == nullptr ? Hertz{} : least->frequency});
  }
  return out;
}

}  // namespace

LoopBias bias_of(const AnalogController& controller, const LoopPoint& point) {
  const controller::RestWiring wiring(controller);
  controller::AtRest rest(wiring, schematic::Deviations::none(controller));
  LoopBias out;
  if (controller.slope) out.slope_v = -point.operating.value * controller.slope->volts_per_hz;
  rest.set_slope(out.slope_v);
  const bool rising = point.branch == Disturbance::Branch::ascending;
  out.position = rising ? 0 : 1;
  out.reference_v = point.v;
  if (wiring.argument_is_given)
    out.reference_v = (point.v - rest.made(0.0, point.v, rising)) / rest.reference_gain();
  rest.made(out.reference_v, point.v, rising);
  for (const schematic::Multiplier& m : controller.multipliers) {
    for (const std::string& node : {m.x, m.y, m.z, m.out})
      out.volts[node] = wiring.argument_is_given && node == "v" ? point.v : rest.volts(node);
  }
  if (wiring.argument_is_given) out.volts["v"] = point.v;
  return out;
}

std::complex<double> generator_loop_gain(const AnalogController& controller, const LoopPoint& point,
                                         RadPerSecond w) {
  if (controller.form != controller::Form::self_fed) return 0.0;
  return -cut_loop(controller, point).response(w, "v");
}

LoopStability loop_stability(const AnalogController& controller) {
  LoopStability out;
  if (controller.opamp.is_ideal) return out;
  const std::vector<Hertz> grid = log_grid({Hertz{1e2}, Hertz{3e9}}, 120);
  for (const LoopPoint& point : loop_points(controller)) {
    out.at.push_back(look_at(controller, point, grid));
    const LoopAt& at = out.at.back();
    out.greatest_gain = std::max(out.greatest_gain, at.greatest_gain);
    for (const LoopAt::OpAmpMargin& one : at.opamps) {
      if (one.margin_deg >= out.margin_deg) continue;
      out.margin_deg = one.margin_deg;
      out.opamp = one.opamp;
      out.role = one.role;
      out.point = point;
      out.crossing = one.crossing;
    }
  }
  return out;
}

std::string loop_warning(const LoopStability& loop) {
  const double margin = loop.ngspice ? std::min(loop.margin_deg, loop.ngspice->margin_deg) : loop.margin_deg;
  if (margin >= kGoodMarginDeg) return {};
  return fmt::format(
      "{} ({}) has a phase margin of {} degrees at v = {}, {} branch, crossing at {}: expected at least {}; an op-amp "
      "with a lower output resistance or another gain-bandwidth, or a capacitor of some picofarads across its "
      "feedback resistor, changes it",
      loop.opamp, loop.role, rounded_text(margin, 3), rounded_text(loop.point.v, 3),
      loop.point.branch == Disturbance::Branch::ascending ? "ascending" : "descending",
      engineering_text(loop.crossing.value, "Hz"), rounded_text(kGoodMarginDeg));
}

void require_stable(const LoopStability& loop, bool allowed) {
  const double margin = loop.ngspice ? std::min(loop.margin_deg, loop.ngspice->margin_deg) : loop.margin_deg;
  if (allowed || margin >= kLeastMarginDeg) return;
  throw DesignError(loop_warning(loop));
}

}  // namespace bodesmith::part_errors
