#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "controller/at_rest.hpp"
#include "controller/library.hpp"
#include "lti/frequency_grid.hpp"
#include "lti/loop_margins.hpp"
#include "part_errors/loop.hpp"
#include "schematic/plain_number.hpp"
#include "schematic/writers/spice_models.hpp"
#include "spice/ngspice.hpp"

namespace bodesmith::part_errors {
namespace {

using controller::AnalogController;
using schematic::plain_number;

constexpr int kGridPoints = 90;
/// Of the stroke: within this a change of branch is over.
constexpr double kSettledShare = 2e-4;

/// The netlist with the slope meter and the branch from outside, and its sources but for x.
std::string open_deck(const AnalogController& controller, const std::string& library, const LoopPoint& point,
                      double reference_v, const std::string& branch) {
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
std::string with_cut_opamp(const AnalogController& controller, std::string library, const std::string& name) {
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

std::vector<std::complex<double>> opamp_ratio(const AnalogController& controller, const std::string& opamp,
                                              const LoopPoint& point, const std::vector<Hertz>& grid) {
  controller::LibraryOptions options;
  options.open = true;
  const std::string library =
      with_cut_opamp(controller, controller::controller_library(controller, "loop", options), opamp);
  std::string deck =
      open_deck(controller, library, point, bias_of(controller, point).reference_v, level(point.branch));
  // The generator reads its own drive (or the reference).
  deck += controller.form == controller::Form::self_fed ? "Vx x v 0\n" : "Vx x r 0\n";
  std::vector<std::complex<double>> out =
      spice::run_ac_of_circuit(deck, "xc.x" + opamp + ".y", grid, "controller.sub");
  for (std::complex<double>& y : out) y = -y / (1.0 + y);
  return out;
}

std::vector<std::complex<double>> generator_loop(const AnalogController& controller, const LoopPoint& point,
                                                 const std::vector<Hertz>& grid) {
  controller::LibraryOptions options;
  options.open = true;
  std::string deck = open_deck(controller, controller::controller_library(controller, "loop", options), point,
                               bias_of(controller, point).reference_v, level(point.branch));
  deck += fmt::format("Vx x 0 {} ac 1\n", plain_number(point.v));
  std::vector<std::complex<double>> out = spice::run_ac_of_circuit(deck, "v", grid, "controller.sub");
  for (std::complex<double>& t : out) t = -t;
  return out;
}

/// v of a branch at rest.
double drive_of(controller::AtRest& rest, bool self_fed, double r, bool rising) {
  double v = r;
  for (int i = 0; i < 60; ++i) {
    const double made = rest.made(r, v, rising);
    if (!self_fed) return made;
    v = made;
  }
  return v;
}

/// Both changes of branch at a reference of r, each branch held for `hold_s`; `rest_v`: the drive of each at rest.
SwitchStep change_of_branch(const AnalogController& controller, const LoopPoint& at, double r,
                            const double rest_v[2], double hold_s) {
  constexpr double kChangeS = 2e-6, kEdgeS = 1e-9, kStepS = 10e-9;
  const double back_s = kChangeS + hold_s, stop_s = back_s + hold_s;
  controller::LibraryOptions options;
  options.open = true;
  std::string deck = open_deck(
      controller, controller::controller_library(controller, "switch", options), at, r,
      fmt::format("pwl(0 0 {} 0 {} 1 {} 1 {} 0)", plain_number(kChangeS), plain_number(kChangeS + kEdgeS),
                  plain_number(back_s), plain_number(back_s + kEdgeS)));
  deck += controller.form == controller::Form::self_fed ? "Vx x v 0\n" : "Vx x r 0\n";
  const spice::Transient run = spice::run_transient(deck, {"v"}, kStepS, stop_s, "controller.sub");
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

std::optional<SwitchStep> switch_step(const AnalogController& controller, const LoopPoint& at) {
  if (!controller.switched() || controller.contacts.size() < 2) return std::nullopt;
  const controller::RestWiring wiring(controller);
  controller::AtRest rest(wiring, schematic::Deviations::none(controller));
  if (controller.slope) rest.set_slope(-at.operating.value * controller.slope->volts_per_hz);
  double r = 0.5, greatest = 0.0;
  for (int i = 0; i <= 40; ++i) {
    const double here = i / 40.0;
    const double apart = std::abs(drive_of(rest, wiring.argument_is_given, here, true) -
                                  drive_of(rest, wiring.argument_is_given, here, false));
    if (apart > greatest) {
      greatest = apart;
      r = here;
    }
  }
  if (!(greatest > 0.0)) return std::nullopt;
  const double rest_v[2] = {drive_of(rest, wiring.argument_is_given, r, true),
                            drive_of(rest, wiring.argument_is_given, r, false)};
  // A hold in whose first third all is over was long enough.
  constexpr double kShortS = 3e-6, kLongS = 10e-6;
  const SwitchStep quick = change_of_branch(controller, at, r, rest_v, kShortS);
  return quick.settled_s < kShortS / 3.0 ? quick : change_of_branch(controller, at, r, rest_v, kLongS);
}

}  // namespace

LoopStability checked_loop_stability(const AnalogController& controller) {
  LoopStability out = loop_stability(controller);
  if (out.at.empty()) return out;
  const std::vector<Hertz> grid = log_grid({Hertz{1e3}, Hertz{1e9}}, kGridPoints);
  LoopStability::Checked checked;
  const LoopMargins margins = loop_margins(grid, opamp_ratio(controller, out.opamp, out.point, grid));
  checked.margin_deg = margins.phase_margin_deg();
  if (const auto* least = margins.least_phase_margin()) checked.crossing = least->frequency;
  if (controller.form == controller::Form::self_fed) {
    const auto worst = std::max_element(out.at.begin(), out.at.end(), [](const LoopAt& a, const LoopAt& b) {
      return a.greatest_gain < b.greatest_gain;
    });
    const std::vector<std::complex<double>> t = generator_loop(controller, worst->point, grid);
    for (std::size_t i = 0; i < grid.size(); ++i) {
      checked.greatest_gain = std::max(checked.greatest_gain, std::abs(t[i]));
      checked.greatest_difference =
          std::max(checked.greatest_difference,
                   std::abs(t[i] - generator_loop_gain(controller, worst->point, grid[i].rad_s())));
    }
  }
  checked.step = switch_step(controller, out.point);
  out.ngspice = checked;
  return out;
}

}  // namespace bodesmith::part_errors
