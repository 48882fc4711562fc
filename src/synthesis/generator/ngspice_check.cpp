#include "synthesis/generator/ngspice_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/documents/json.hpp"
#include "schematic/ngspice/ngspice.hpp"
#include "synthesis/decks/dialect.hpp"
#include "synthesis/generator/at_rest.hpp"
#include "synthesis/generator/files.hpp"
#include "synthesis/generator/timing.hpp"

namespace bodesmith::generator {
namespace {

using ngspice::DcSweep;
using ngspice::run_dc;
using ngspice::run_transient;
using ngspice::Transient;
using synthesis::triangle_points;

/// The library, sources for the select lines and the stroke, the generator.
std::string deck_of(const DisturbanceCircuit& layout, const std::string& library, int select, double alpha) {
  std::string out = library;
  for (int line = 0; line < layout.select_lines(); ++line)
    out += fmt::format("Vs{0} select{0} 0 {1}\n", line + 1, (select >> line) & 1);
  if (layout.amplitude) out += fmt::format("Va amplitude 0 {:.12g}\n", alpha);
  return out + fmt::format("X1 {} {}\n", disturbance_pins(layout), disturbance_name(layout));
}

std::vector<double> sweep_branch(const DisturbanceCircuit& layout, const std::string& library, size_t branch,
                                 double alpha, std::vector<double>& x) {
  // The select code and the slope that reach a branch.
  const std::string deck = "static\n.options reltol=1e-6\n" +
                           deck_of(layout, library, static_cast<int>(branch) / 2, alpha) +
                           fmt::format("Vx x 0 0\nVb branch 0 {}\n", branch % 2 == 0 ? 1 : 0);
  const DcSweep sweep = run_dc(deck, "Vx", 0.0, 1.0, 0.01, {"out"}, "disturbance.sub");
  x = sweep.source_v;
  return sweep.v[0];
}

/// The strokes that are looked at, the middles between them and half the least.
std::vector<double> swept_strokes(const DisturbanceCircuit& layout) {
  std::vector<double> out = layout.strokes();
  if (!layout.amplitude) return out;
  const std::vector<double> table = out;
  for (std::size_t k = 1; k < table.size(); ++k) out.push_back(0.5 * (table[k - 1] + table[k]));
  out.push_back(0.5 * table.front());
  return out;
}

void check_static(const DisturbanceCircuit& layout, DisturbanceCheck& out) {
  const RestWiring wiring(layout);
  const auto most = [](double& greatest, double value) {
    greatest = std::max(greatest, 100.0 * std::abs(value));
  };
  const auto compare = [&](const std::string& library, const schematic::Deviations& off, size_t b,
                           double alpha, double& percent, double& predicted_percent,
                           double& against_program) {
    std::vector<double> x;
    const std::vector<double> v = sweep_branch(layout, library, b, alpha, x);
    const std::vector<double> predicted = curve(AtRest(wiring, off), b, x, alpha);
    for (size_t i = 0; i < x.size(); ++i) {
      const double wanted = layout.wanted(b, x[i], alpha);
      most(percent, v[i] - wanted);
      most(predicted_percent, predicted[i] - wanted);
      most(against_program, v[i] - predicted[i]);
    }
  };
  const std::string library = disturbance_library(layout, "check"),
                    spoilt = disturbance_library(layout, "check", true);
  for (size_t b = 0; b < layout.branches.size(); ++b) {
    double predicted = 0.0;
    for (const double alpha : swept_strokes(layout))
      compare(library, schematic::Deviations::none(layout), b, alpha, out.static_percent, predicted,
              out.static_against_program);
    compare(spoilt, multipliers_off(layout), b, layout.strokes().back(), out.off_percent,
            out.off_predicted_percent, out.off_against_program);
  }
}

/// Two periods of a triangle through the slope detector; the second is judged.
DisturbanceCheck::Dynamic check_triangle(const DisturbanceCircuit& layout, const std::string& library,
                                         Hertz f, double alpha = 1.0) {
  const double period = 1.0 / f.value;
  const std::string deck = "triangle\n" + deck_of(layout, library, 0, alpha) + "Vx x 0 PWL(" +
                           triangle_points(f.value) + ")\nXs x branch slope_detector\n";
  const Transient run =
      run_transient(deck, {"x", "branch", "out"}, period / 4000.0, 2.0 * period, "disturbance.sub");
  DisturbanceCheck::Dynamic out{.frequency = f, .alpha = alpha};
  double sum = 0.0, total = 0.0, late = 0.0;
  for (size_t i = 1; i < run.time_s.size(); ++i) {
    const double now = run.time_s[i], dt = now - run.time_s[i - 1];
    if (now < period) continue;
    const bool rising = std::fmod(now, period) < 0.5 * period;
    if ((run.v[1][i] > 0.5) != rising) late += dt;
    const double error = run.v[2][i] - layout.wanted(rising ? 0 : 1, run.v[0][i], alpha);
    out.peak_percent = std::max(out.peak_percent, 100.0 * std::abs(error));
    sum += dt * error * error;
    total += dt;
  }
  out.rms_percent = 100.0 * std::sqrt(sum / total);
  out.late_share = late / period;
  out.delay_s = 0.5 * late;
  return out;
}

/// x at rest where the first branch is greatest, the branch line stepped from the first to the second.
DisturbanceCheck::Change check_change(const DisturbanceCircuit& layout, const std::string& library) {
  DisturbanceCheck::Change out;
  double held = 0.0;
  for (int i = 0; i <= 100; ++i) {
    const double v = -layout.branch_gain * layout.realised(0, i / 100.0);
    if (std::abs(v) > std::abs(held)) {
      held = v;
      out.x = i / 100.0;
    }
  }
  constexpr double kStep = 1e-6;
  const std::string deck = "change\n" + deck_of(layout, library, 0, 1.0) +
                           fmt::format("Vx x 0 {:.12g}\n", out.x) +
                           fmt::format("Vb branch 0 PWL(0 1 {0:.12g} 1 {1:.12g} 0)\n", kStep, kStep + 1e-10);
  const Transient run = run_transient(deck, {"out", "x1.sw"}, 2.5e-10, 2.0 * kStep, "disturbance.sub");
  const schematic::SwitchModel& model = layout.analog_switch;
  double before = 0.0;
  const double arrived = run.v[1].back(), change = std::abs(held - arrived);
  for (size_t i = 0; i < run.time_s.size(); ++i) {
    const double t = run.time_s[i] - kStep;
    if (t < model.off_delay_s() - 5e-9) before = run.v[0][i];
    if (t > model.off_delay_s() && t < model.on_delay_s)
      out.glitch_percent = std::max(out.glitch_percent, 100.0 * std::abs(run.v[0][i] - before));
    if (t > 0.0 && change > 1e-3 && std::abs(run.v[1][i] - arrived) > 0.1 * change) out.delay_s = t;
  }
  // An opening contact takes charge off the node.
  out.predicted_percent = 100.0 * switch_glitch_v(layout, held, -1.0);
  return out;
}

}  // namespace

DisturbanceCheck check_disturbance(const DisturbanceCircuit& layout, const std::vector<Hertz>& triangles) {
  const std::string library = disturbance_library(layout, "check");
  const std::string spoilt = disturbance_library(layout, "check", true);
  DisturbanceCheck out;
  check_static(layout, out);
  if (layout.of_full_strokes) check_static(*layout.of_full_strokes, out);
  if (!layout.switched()) return out;
  const auto triangle = [&](Hertz f, double alpha) {
    out.dynamic.push_back(check_triangle(layout, library, f, alpha));
    out.dynamic.back().rms_off_percent = check_triangle(layout, spoilt, f, alpha).rms_percent;
  };
  for (const Hertz f : triangles) triangle(f, 1.0);
  if (layout.amplitude && !triangles.empty())
    triangle(triangles.back(), layout.amplitude->alpha[(layout.amplitude->alpha.size() - 1) / 2]);
  out.change = check_change(layout, library);
  return out;
}

Json to_json(const DisturbanceCheck& check) {
  Json out = {{"version", ngspice::version()},
              {"static_percent", check.static_percent},
              {"static_against_program_percent", check.static_against_program},
              {"multipliers_off",
               {{"static_percent", check.off_percent},
                {"predicted_percent", check.off_predicted_percent},
                {"against_program_percent", check.off_against_program}}},
              {"dynamic", Json::array()}};
  for (const DisturbanceCheck::Dynamic& one : check.dynamic) {
    out["dynamic"].push_back({{"frequency_hz", one.frequency.value},
                              {"alpha", one.alpha},
                              {"rms_percent", one.rms_percent},
                              {"rms_multipliers_off_percent", one.rms_off_percent},
                              {"peak_percent", one.peak_percent},
                              {"detector_delay_s", one.delay_s},
                              {"late_share", one.late_share}});
  }
  if (check.change) {
    out["change_of_branch"] = {{"x", check.change->x},
                               {"delay_s", check.change->delay_s},
                               {"glitch_percent", check.change->glitch_percent},
                               {"predicted_glitch_percent", check.change->predicted_percent}};
  }
  return out;
}

}  // namespace bodesmith::generator
