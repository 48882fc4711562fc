#include "synthesis/controller/loop.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <stdexcept>

#include "base/documents/json.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
#include "lti/frequency_grid.hpp"
#include "lti/loop_margins.hpp"
#include "schematic/analysis/response.hpp"
#include "schematic/ngspice/ngspice.hpp"
#include "schematic/plain_number.hpp"
#include "schematic/writers/spice_library.hpp"

namespace bodesmith::generator {
namespace {

using schematic::plain_number;

Json point_json(const LoopPoint& point) {
  return {{"branch", std::string(to_string(point.branch))},
          {"v", point.v},
          {"operating_hz", point.operating.value},
          {"rate_gain", point.rate_gain},
          {"stroke", point.stroke}};
}

/// The full stroke; of a table of amplitude gains its least one and where the loop is steepest.
std::vector<double> looked_at_strokes(const DisturbanceCircuit& c, Disturbance::Branch branch) {
  std::vector<double> out = {1.0};
  if (!c.stroke) return out;
  const auto steep = [&](double alpha) { return c.amplitude_gain(branch, alpha) / alpha; };
  double steepest = 1.0;
  for (const double alpha : c.disturbance.amplitude.alpha)
    if (alpha >= c.stroke->least && steep(alpha) > steep(steepest)) steepest = alpha;
  for (const double alpha : {steepest, c.stroke->least})
    if (alpha != out.back()) out.push_back(alpha);
  return out;
}

/// v = 0, 1/4 … 1 strokes; both branches; the gain curve's corners, where the gains' extremes are, at partial strokes the greatest.
std::vector<LoopPoint> loop_points(const DisturbanceCircuit& c) {
  std::vector<Hertz> operating = {c.tracked.empty() ? Hertz{1.0} : c.tracked.front()};
  if (c.curve) operating = c.curve->corner;
  std::vector<LoopPoint> out;
  for (const auto branch : kBranches) {
    const std::vector<double> strokes = looked_at_strokes(c, branch);
    std::vector<LoopPoint> seen;
    for (const Hertz f : operating) {
      const double gain = c.curve ? c.curve->value(branch, f) : 1.0;
      if (std::ranges::none_of(seen,
                               [&](const LoopPoint& one) { return std::abs(one.rate_gain - gain) < 1e-6; }))
        seen.push_back({branch, 0.0, f, gain});
    }
    const auto greatest = std::ranges::max_element(seen, {}, &LoopPoint::rate_gain);
    const auto add = [&](LoopPoint point, double stroke) {
      point.stroke = stroke;
      for (int i = 0; i <= 4; ++i) {
        point.v = 0.25 * i * stroke;
        out.push_back(point);
      }
    };
    for (const LoopPoint& one : seen) add(one, 1.0);
    for (std::size_t i = 1; i < strokes.size(); ++i) add(*greatest, strokes[i]);
  }
  return out;
}

/// The generator cut at its argument, for small signals about the point.
schematic::Equations cut_loop(const DisturbanceCircuit& controller, const LoopPoint& point) {
  LoopBias bias = bias_of(controller, point);
  bias.volts[kArgument] = point.v;
  schematic::Equations out(generator_netlist(controller, true, true),
                           {.position = bias.position, .input = kArgument});
  out.linearise(bias.volts);
  return out;
}

LoopAt look_at(const DisturbanceCircuit& controller, const LoopPoint& point, const std::vector<Hertz>& grid) {
  const LoopBias bias = bias_of(controller, point);
  const schematic::Netlist netlist = generator_netlist(controller, false, true);
  schematic::Equations closed(netlist, {.position = bias.position});
  closed.linearise(bias.volts);
  const schematic::Equations cut = cut_loop(controller, point);
  const bool fed = controller.form == Form::self_fed;
  LoopAt out;
  out.point = point;
  std::vector<Complex> loop;
  std::vector<std::vector<Complex>> own(netlist.opamps.size());
  std::vector<std::size_t> every(own.size());
  std::iota(every.begin(), every.end(), 0);
  for (const Hertz f : grid) {
    loop.push_back(fed ? -cut.response(f.rad_s(), "v") : 0.0);
    out.greatest_gain = std::max(out.greatest_gain, std::abs(loop.back()));
    const std::vector<Complex> ratios = schematic::return_ratios(closed, netlist, every, f.rad_s());
    for (std::size_t k = 0; k < own.size(); ++k) own[k].push_back(ratios[k]);
  }
  const LoopMargins of_generator = loop_margins(grid, loop);
  out.gain_margin_db = of_generator.gain_margin_db().value_or(0.0);
  out.nearest = 1.0 / of_generator.max_sensitivity;
  const auto narrow = std::ranges::find_if(
      loop, [&](const Complex& one) { return std::abs(one) < std::abs(loop.front()) / std::numbers::sqrt2; });
  out.bandwidth = narrow == loop.end() ? grid.back() : grid[static_cast<std::size_t>(narrow - loop.begin())];
  for (std::size_t k = 0; k < own.size(); ++k) {
    const schematic::OpAmp& u = netlist.opamps[k];
    const LoopMargins margins = loop_margins(grid, own[k]);
    const auto* least = margins.least_phase_margin();
    out.opamps.push_back(
        {u.name, u.role, margins.phase_margin_deg(), least == nullptr ? Hertz{} : least->frequency});
  }
  return out;
}

constexpr int kGridPoints = 90;
/// Of the stroke: within this a change of branch is over.
constexpr double kSettledShare = 2e-4;

std::string open_library(const DisturbanceCircuit& controller, const LoopPoint& point) {
  return controller_library(controller, "loop", {.open = true, .stroke = point.stroke});
}

/// The netlist with the slope meter and the branch from outside, and its sources but for x.
std::string open_deck(const DisturbanceCircuit& controller, const std::string& library,
                      const LoopPoint& point, double reference_v, const std::string& branch) {
  const double slope = controller.slope ? -point.operating.value * controller.slope->volts_per_hz : 0.0;
  return fmt::format(
      "loop\n{}\nVr r 0 {}\nVbranch branch 0 {}\nVslope slope 0 {}\nXc r x branch slope v controller_open\n",
      library, plain_number(reference_v), branch, plain_number(slope));
}

std::string level(Disturbance::Branch branch) {
  return branch == Disturbance::Branch::ascending ? "1" : "0";
}

/// The op-amp's line takes a copy of the macromodel with a source of 1 V behind the ideal output stage: there its
/// whole return ratio passes, whatever is connected.
std::string with_cut_opamp(const DisturbanceCircuit& controller, std::string library,
                           const std::string& name) {
  const schematic::OpAmp* opamp = nullptr;
  for (const schematic::OpAmp& one : controller.opamps) {
    if (one.name == name) opamp = &one;
  }
  const std::string begin = "\nX" + name + " ";
  const std::size_t at = library.find(begin);
  if (opamp == nullptr || at == std::string::npos) throw std::logic_error("no op-amp " + name);
  const std::size_t end = library.find('\n', at + 1), last = library.rfind(' ', end);
  library.replace(last + 1, end - last - 1, "bodesmith_opamp_cut");
  schematic::OpAmpModel quiet = controller.model_of(*opamp);
  quiet.voltage_noise_v_per_rthz = quiet.current_noise_a_per_rthz = 0.0;
  std::string macro = schematic::opamp_subcircuit(quiet, "bodesmith_opamp_cut");
  const std::string output = "\nRo y o ";
  const std::size_t ro = macro.find(output);
  if (ro == std::string::npos) throw std::logic_error("the op-amp's macromodel has no output resistance");
  macro.replace(ro, output.size(), "\nVcut z y 0 ac 1\nRo z o ");
  return library + "\n" + macro;
}

std::vector<Complex> opamp_ratio(const DisturbanceCircuit& controller, const std::string& opamp,
                                 const LoopPoint& point, const std::vector<Hertz>& grid) {
  const std::string library = with_cut_opamp(controller, open_library(controller, point), opamp);
  std::string deck =
      open_deck(controller, library, point, bias_of(controller, point).reference_v, level(point.branch));
  // The generator reads its own drive (or the reference).
  deck += controller.form == Form::self_fed ? "Vx x v 0\n" : "Vx x r 0\n";
  std::vector<Complex> out = ngspice::run_ac_of_circuit(deck, "xc.x" + opamp + ".y", grid, "controller.sub");
  for (Complex& y : out) y = -y / (1.0 + y);
  return out;
}

std::vector<Complex> generator_loop(const DisturbanceCircuit& controller, const LoopPoint& point,
                                    const std::vector<Hertz>& grid) {
  std::string deck = open_deck(controller, open_library(controller, point), point,
                               bias_of(controller, point).reference_v, level(point.branch));
  deck += fmt::format("Vx x 0 {} ac 1\n", plain_number(point.v));
  std::vector<Complex> out = ngspice::run_ac_of_circuit(deck, "v", grid, "controller.sub");
  for (Complex& t : out) t = -t;
  return out;
}

/// v of a branch at rest.
double drive_of(AtRest& rest, bool self_fed, double r, std::size_t branch) {
  double v = r;
  for (int i = 0; i < 60; ++i) {
    const double made = rest.made(r, v, branch);
    if (!self_fed) return made;
    v = made;
  }
  return v;
}

/// Both changes of branch at a reference of r, each branch held for `hold_s`; `rest_v`: the drive of each at rest.
SwitchStep change_of_branch(const DisturbanceCircuit& controller, const LoopPoint& at, double r,
                            const double rest_v[2], double hold_s) {
  constexpr double kChangeS = 2e-6, kEdgeS = 1e-9, kStepS = 10e-9;
  const double back_s = kChangeS + hold_s, stop_s = back_s + hold_s;
  std::string deck = open_deck(
      controller, open_library(controller, at), at, r,
      fmt::format("pwl(0 0 {} 0 {} 1 {} 1 {} 0)", plain_number(kChangeS), plain_number(kChangeS + kEdgeS),
                  plain_number(back_s), plain_number(back_s + kEdgeS)));
  deck += controller.form == Form::self_fed ? "Vx x v 0\n" : "Vx x r 0\n";
  const ngspice::Transient run = ngspice::run_transient(deck, {"v"}, kStepS, stop_s, "controller.sub");
  SwitchStep out{.v = r, .step_percent = 100.0 * std::abs(rest_v[0] - rest_v[1])};
  const double low = std::min(rest_v[0], rest_v[1]), high = std::max(rest_v[0], rest_v[1]);
  const auto last_before = [&](double t) {
    double value = run.v[0].front();
    for (std::size_t i = 0; i < run.time_s.size() && run.time_s[i] < t; ++i) value = run.v[0][i];
    return value;
  };
  const double end[2] = {last_before(back_s), last_before(stop_s)};
  for (std::size_t i = 0; i < run.time_s.size(); ++i) {
    const double t = run.time_s[i], now = run.v[0][i];
    if (t < kChangeS) continue;
    out.overshoot_percent = std::max({out.overshoot_percent, 100.0 * (low - now), 100.0 * (now - high)});
    const bool second = t >= back_s;
    if (std::abs(now - end[second ? 1 : 0]) > kSettledShare)
      out.settled_s = std::max(out.settled_s, t - (second ? back_s : kChangeS));
  }
  return out;
}

std::optional<SwitchStep> switch_step(const DisturbanceCircuit& controller, const LoopPoint& at) {
  if (!controller.switched() || controller.contacts.size() < 2) return std::nullopt;
  const RestWiring wiring(controller);
  AtRest rest(wiring, schematic::Deviations::none(controller));
  if (controller.slope) rest.set_slope(-at.operating.value * controller.slope->volts_per_hz);
  double r = 0.5, greatest = 0.0;
  for (int i = 0; i <= 40; ++i) {
    const double here = i / 40.0;
    const double apart = std::abs(drive_of(rest, wiring.argument_is_given, here, 0) -
                                  drive_of(rest, wiring.argument_is_given, here, 1));
    if (apart > greatest) {
      greatest = apart;
      r = here;
    }
  }
  if (!(greatest > 0.0)) return std::nullopt;
  const double rest_v[2] = {drive_of(rest, wiring.argument_is_given, r, 0),
                            drive_of(rest, wiring.argument_is_given, r, 1)};
  // A hold in whose first third all is over was long enough.
  constexpr double kShortS = 3e-6, kLongS = 10e-6;
  const SwitchStep quick = change_of_branch(controller, at, r, rest_v, kShortS);
  return quick.settled_s < kShortS / 3.0 ? quick : change_of_branch(controller, at, r, rest_v, kLongS);
}

}  // namespace

LoopBias bias_of(const DisturbanceCircuit& controller, const LoopPoint& point) {
  const RestWiring wiring(controller);
  AtRest rest(wiring, schematic::Deviations::none(controller));
  LoopBias out;
  if (controller.slope) out.slope_v = -point.operating.value * controller.slope->volts_per_hz;
  rest.set_slope(out.slope_v);
  rest.set_stroke(point.stroke);
  const double argument = point.v / point.stroke;
  const std::size_t branch = branch_index(point.branch);
  out.position = static_cast<int>(branch);
  out.reference_v = point.v;
  if (wiring.argument_is_given)
    out.reference_v = (point.v - rest.made(0.0, argument, branch)) / rest.reference_gain();
  rest.made(out.reference_v, argument, branch);
  for (const schematic::Multiplier& m : wiring.generator.netlist().multipliers) {
    for (const std::string& node : {m.x, m.y, m.z, m.out})
      out.volts[node] = wiring.argument_is_given && node == "v" ? point.v : rest.volts(node);
  }
  if (wiring.argument_is_given) out.volts["v"] = point.v;
  if (controller.stroke) {
    out.volts["al"] = point.stroke;
    out.volts[controller.passes.back().x] = argument * controller.stroke->argument_scale;
  }
  return out;
}

Complex generator_loop_gain(const DisturbanceCircuit& controller, const LoopPoint& point, RadPerSecond w) {
  if (controller.form != Form::self_fed) return 0.0;
  return -cut_loop(controller, point).response(w, "v");
}

LoopStability loop_stability(const DisturbanceCircuit& controller) {
  LoopStability out;
  if (controller.opamp.is_ideal) return out;
  const std::vector<Hertz> grid = log_grid({Hertz{1e2}, Hertz{3e9}}, 120);
  for (const LoopPoint& point : loop_points(controller)) {
    out.at.push_back(look_at(controller, point, grid));
    const LoopAt& at = out.at.back();
    out.greatest_gain = std::max(out.greatest_gain, at.greatest_gain);
    out.nearest = std::min(out.nearest, at.nearest);
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
      to_string(loop.point.branch), engineering_text(loop.crossing.value, "Hz"),
      rounded_text(kGoodMarginDeg));
}

Json to_json(const LoopStability& loop) {
  Json out = {{"generator_greatest_loop_gain", loop.greatest_gain},
              {"generator_below_one_everywhere", loop.greatest_gain < 1.0},
              {"generator_nearest", loop.nearest},
              {"phase_margin_deg", loop.margin_deg},
              {"opamp", loop.opamp},
              {"role", loop.role},
              {"crossing_hz", loop.crossing.value},
              {"worst", point_json(loop.point)},
              {"warning", loop_warning(loop)}};
  if (loop.ngspice) {
    Json checked = {{"phase_margin_deg", loop.ngspice->margin_deg},
                    {"crossing_hz", loop.ngspice->crossing.value},
                    {"generator_greatest_loop_gain", loop.ngspice->greatest_gain},
                    {"greatest_difference_from_network", loop.ngspice->greatest_difference}};
    if (loop.ngspice->step) {
      const SwitchStep& step = *loop.ngspice->step;
      checked["change_of_branch"] = {{"r_v", step.v},
                                     {"step_percent", step.step_percent},
                                     {"overshoot_percent", step.overshoot_percent},
                                     {"settled_s", step.settled_s}};
    }
    out["ngspice"] = checked;
  }
  out["at"] = Json::array();
  for (const LoopAt& at : loop.at) {
    Json one = point_json(at.point);
    one["loop_gain"] = at.greatest_gain;
    one["gain_margin_db"] = at.gain_margin_db;
    one["nearest"] = at.nearest;
    one["bandwidth_hz"] = at.bandwidth.value;
    Json margins = Json::array();
    for (const LoopAt::OpAmpMargin& m : at.opamps) {
      margins.push_back(
          {{"opamp", m.opamp}, {"phase_margin_deg", m.margin_deg}, {"crossing_hz", m.crossing.value}});
    }
    one["opamps"] = margins;
    out["at"].push_back(one);
  }
  return out;
}

std::string summary_text(const LoopStability& loop) {
  if (loop.at.empty()) return "stability: not looked at, the op-amps are ideal\n";
  std::string out = fmt::format("stability: the generator's loop gain is at most {}{}, |1 + L| at least {}\n",
                                rounded_text(loop.greatest_gain, 3),
                                loop.greatest_gain < 1.0 ? ", below 1 at every frequency" : "",
                                rounded_text(loop.nearest, 3));
  out += fmt::format("  least phase margin of an op-amp {} deg ({}, {})", rounded_text(loop.margin_deg, 3),
                     loop.opamp, loop.role);
  if (loop.ngspice)
    out += fmt::format("; ngspice: {} deg, loop gain {}", rounded_text(loop.ngspice->margin_deg, 3),
                       rounded_text(loop.ngspice->greatest_gain, 3));
  return out + "\n";
}

void require_stable(const LoopStability& loop, bool allowed) {
  const double margin = loop.ngspice ? std::min(loop.margin_deg, loop.ngspice->margin_deg) : loop.margin_deg;
  if (allowed || margin >= kLeastMarginDeg) return;
  throw DesignError(loop_warning(loop));
}

LoopStability checked_loop_stability(const DisturbanceCircuit& controller) {
  LoopStability out = loop_stability(controller);
  if (out.at.empty()) return out;
  const std::vector<Hertz> grid = log_grid({Hertz{1e3}, Hertz{1e9}}, kGridPoints);
  LoopStability::Checked checked;
  const LoopMargins margins = loop_margins(grid, opamp_ratio(controller, out.opamp, out.point, grid));
  checked.margin_deg = margins.phase_margin_deg();
  if (const auto* least = margins.least_phase_margin()) checked.crossing = least->frequency;
  if (controller.form == Form::self_fed) {
    const auto worst = std::ranges::max_element(out.at, {}, &LoopAt::greatest_gain);
    const std::vector<Complex> t = generator_loop(controller, worst->point, grid);
    for (std::size_t i = 0; i < grid.size(); ++i) {
      checked.greatest_gain = std::max(checked.greatest_gain, std::abs(t[i]));
      checked.greatest_difference =
          std::max(checked.greatest_difference,
                   std::abs(t[i] - generator_loop_gain(controller, worst->point, grid[i].rad_s())));
    }
  }
  LoopPoint full = out.point;
  full.stroke = 1.0;
  checked.step = switch_step(controller, full);
  out.ngspice = checked;
  return out;
}

}  // namespace bodesmith::generator
