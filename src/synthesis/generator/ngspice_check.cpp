#include "synthesis/generator/ngspice_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/documents/json.hpp"
#include "schematic/ngspice/ngspice.hpp"
#include "synthesis/decks/dialect.hpp"
#include "synthesis/generator/budget.hpp"
#include "synthesis/generator/files.hpp"
#include "synthesis/generator/layout.hpp"
#include "synthesis/generator/timing.hpp"

namespace bodesmith::generator {
namespace {

using ngspice::DcSweep;
using ngspice::run_dc;
using ngspice::run_transient;
using ngspice::Transient;
using synthesis::triangle_points;

/// Sources for the select lines.
std::string select_sources(const Layout& layout, int select) {
  std::string out;
  for (int line = 0; line < layout.select_lines(); ++line)
    out += fmt::format("Vs{0} select{0} 0 {1}\n", line + 1, (select >> line) & 1);
  return out;
}

/// Select code and slope that reach a branch.
std::pair<int, bool> code_of(size_t branch) {
  return {static_cast<int>(branch) / 2, branch % 2 == 0};
}

std::vector<double> sweep_branch(const Layout& layout, const std::string& library, size_t branch,
                                 std::optional<double> alpha, std::vector<double>& x) {
  const auto [select, rising] = code_of(branch);
  std::string deck = "static\n.options reltol=1e-6\n" + library +
                     fmt::format("Vx x 0 0\nVb branch 0 {}\n", rising ? 1 : 0) +
                     select_sources(layout, select);
  if (alpha) deck += fmt::format("Va amplitude 0 {:.12g}\n", *alpha);
  deck += fmt::format("X1 {} disturbance{}\n", disturbance_pins(layout, alpha.has_value()),
                      alpha ? "_amplitude" : "");
  const DcSweep sweep = run_dc(deck, "Vx", 0.0, 1.0, 0.01, {"out"}, "disturbance.sub");
  x = sweep.source_v;
  return sweep.v[0];
}

void check_static(const Layout& layout, const std::string& library, const std::string& spoilt,
                  const ErrorLimits& errors, DisturbanceCheck& out) {
  const GeneratorAtRest generator(layout);
  const schematic::Deviations limit = multipliers_at_limit(layout, errors);
  for (size_t b = 0; b < layout.branches.size(); ++b) {
    const Branch& branch = layout.branches[b];
    std::vector<double> x;
    const std::vector<double> v = sweep_branch(layout, library, b, std::nullopt, x);
    const std::vector<double> off = sweep_branch(layout, spoilt, b, std::nullopt, x);
    const std::vector<double> predicted = generator.curve(b, x, 1.0, limit);
    for (size_t i = 0; i < x.size(); ++i) {
      const double wanted = polynomial(branch.wanted, x[i]);
      const auto most = [](double& greatest, double value) {
        greatest = std::max(greatest, 100.0 * std::abs(value));
      };
      most(out.static_percent, v[i] - wanted);
      most(out.static_against_program, v[i] - branch.value(x[i]));
      most(out.limit_percent, off[i] - wanted);
      most(out.limit_predicted_percent, predicted[i] - wanted);
      most(out.limit_against_program, off[i] - predicted[i]);
    }
  }
}

/// Two periods of a triangle through the slope detector; the second is judged.
DisturbanceCheck::Dynamic check_triangle(const Layout& layout, const std::string& library, Hertz f,
                                         std::optional<double> alpha) {
  const double period = 1.0 / f.value;
  const std::string points = triangle_points(f.value);
  std::string deck = "triangle\n" + library + "Vx x 0 PWL(" + points + ")\nXs x branch slope_detector\n" +
                     select_sources(layout, 0);
  if (alpha) deck += fmt::format("Va amplitude 0 {:.12g}\n", *alpha);
  deck += fmt::format("X1 {} disturbance{}\n", disturbance_pins(layout, alpha.has_value()),
                      alpha ? "_amplitude" : "");
  const Transient run =
      run_transient(deck, {"x", "branch", "out"}, period / 4000.0, 2.0 * period, "disturbance.sub");
  DisturbanceCheck::Dynamic out;
  out.frequency = f;
  double sum = 0.0, total = 0.0, late = 0.0;
  for (size_t i = 1; i < run.time_s.size(); ++i) {
    const double now = run.time_s[i], dt = now - run.time_s[i - 1];
    if (now < period) continue;
    const bool rising = std::fmod(now, period) < 0.5 * period;
    if ((run.v[1][i] > 0.5) != rising) late += dt;
    const size_t b = rising ? 0 : 1;
    const double gain = alpha ? layout.amplitude->wanted_gain(b, *alpha) : 1.0;
    const double error = run.v[2][i] - gain * polynomial(layout.branches[b].wanted, run.v[0][i]);
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
DisturbanceCheck::Change check_change(const Layout& layout, const std::string& library) {
  DisturbanceCheck::Change out;
  double held = 0.0;
  for (int i = 0; i <= 100; ++i) {
    const double v = -layout.branch_gain * layout.branches[0].value(i / 100.0);
    if (std::abs(v) > std::abs(held)) {
      held = v;
      out.x = i / 100.0;
    }
  }
  constexpr double kStep = 1e-6;
  const std::string deck = "change\n" + library + fmt::format("Vx x 0 {:.12g}\n", out.x) +
                           select_sources(layout, 0) +
                           fmt::format("Vb branch 0 PWL(0 1 {0:.12g} 1 {1:.12g} 0)\n", kStep, kStep + 1e-10) +
                           fmt::format("X1 {} disturbance\n", disturbance_pins(layout, false));
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

DisturbanceCheck::Amplitude check_amplitude(const Layout& layout, Hertz f) {
  const std::string library = disturbance_library(layout, "check", {true, std::nullopt});
  const AmplitudeControl& amplitude = *layout.amplitude;
  DisturbanceCheck::Amplitude out;
  const GeneratorAtRest generator(layout, true);
  std::vector<double> strokes = amplitude.alpha;
  for (size_t k = 1; k < amplitude.alpha.size(); ++k)
    strokes.push_back(0.5 * (amplitude.alpha[k - 1] + amplitude.alpha[k]));
  strokes.push_back(0.5 * amplitude.alpha.front());
  for (const double alpha : strokes) {
    for (size_t b = 0; b < layout.branches.size(); ++b) {
      std::vector<double> x;
      const std::vector<double> v = sweep_branch(layout, library, b, alpha, x);
      const std::vector<double> predicted = generator.curve(b, x, alpha);
      const double gain = amplitude.wanted_gain(b, alpha);
      for (size_t i = 0; i < x.size(); ++i) {
        out.static_percent = std::max(
            out.static_percent, 100.0 * std::abs(v[i] - gain * polynomial(layout.branches[b].wanted, x[i])));
        out.against_program = std::max(out.against_program, 100.0 * std::abs(v[i] - predicted[i]));
      }
    }
  }
  if (layout.switched()) {
    out.frequency = f;
    out.alpha = amplitude.alpha[amplitude.alpha.size() / 2];
    out.rms_percent = check_triangle(layout, library, f, out.alpha).rms_percent;
  }
  return out;
}

}  // namespace

DisturbanceCheck check_disturbance(const Layout& layout, const std::vector<Hertz>& triangles,
                                   const ErrorLimits& errors) {
  const std::string library = disturbance_library(layout, "check", {});
  const std::string spoilt = disturbance_library(layout, "check", {false, errors});
  DisturbanceCheck out;
  check_static(layout, library, spoilt, errors, out);
  if (layout.switched()) {
    for (const Hertz f : triangles) {
      out.dynamic.push_back(check_triangle(layout, library, f, std::nullopt));
      out.dynamic.back().rms_at_limit_percent = check_triangle(layout, spoilt, f, std::nullopt).rms_percent;
    }
    out.change = check_change(layout, library);
  }
  if (layout.amplitude)
    out.amplitude = check_amplitude(layout, triangles.empty() ? Hertz{5000.0} : triangles.back());
  return out;
}

Json to_json(const DisturbanceCheck& check) {
  Json out = {{"version", ngspice::version()},
              {"static_percent", check.static_percent},
              {"static_against_program_percent", check.static_against_program},
              {"multipliers_at_limit",
               {{"static_percent", check.limit_percent},
                {"predicted_percent", check.limit_predicted_percent},
                {"against_program_percent", check.limit_against_program}}},
              {"dynamic", Json::array()}};
  for (const DisturbanceCheck::Dynamic& one : check.dynamic) {
    out["dynamic"].push_back({{"frequency_hz", one.frequency.value},
                              {"rms_percent", one.rms_percent},
                              {"rms_multipliers_at_limit_percent", one.rms_at_limit_percent},
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
  if (check.amplitude) {
    out["amplitude"] = {{"static_percent", check.amplitude->static_percent},
                        {"static_against_program_percent", check.amplitude->against_program},
                        {"alpha", check.amplitude->alpha},
                        {"frequency_hz", check.amplitude->frequency.value},
                        {"rms_percent", check.amplitude->rms_percent}};
  }
  return out;
}

}  // namespace bodesmith::generator
