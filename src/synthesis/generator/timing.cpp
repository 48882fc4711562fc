#include "synthesis/generator/timing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.hpp"
#include "base/text.hpp"
#include "schematic/analysis/in_time.hpp"
#include "schematic/analysis/response.hpp"
#include "synthesis/generator/at_rest.hpp"

namespace bodesmith::generator {
namespace {

double hold_farad(const DisturbanceCircuit& layout) {
  return layout.analog_switch.drain_f * static_cast<double>(layout.branches.size());
}

double output_gain(const DisturbanceCircuit& layout) {
  return layout.part(layout.passes.back().output.feedback).realised /
         layout.part(layout.passes.back().output.disturbance).realised;
}

SlopeDetectorFigures detector_figures(const SlopeDetector& detector, const std::vector<Hertz>& frequencies) {
  SlopeDetectorFigures out;
  out.threshold_v = detector.threshold_v();
  out.least_slope_v_per_s = detector.least_slope_v_per_s();
  out.noise_v = detector.noise_v();
  out.noise_margin = 2.0 * out.threshold_v / out.noise_v;
  out.hum_50_hz_v = out.threshold_v / detector.gains({Hertz{50.0}}).front();
  std::vector<Hertz> grid;
  for (double f = 1.0; f < 10e6; f *= 1.05) grid.push_back(Hertz{f});
  const std::vector<double> gains = detector.gains(grid);
  const auto most = std::ranges::max_element(gains);
  out.ripple_hz = grid[static_cast<std::size_t>(most - gains.begin())].value;
  out.ripple_v = out.threshold_v / *most;
  for (const Hertz f : frequencies) {
    const double period = 1.0 / f.value;
    SlopeDetectorFigures::Delay delay;
    delay.frequency = f;
    // Both reversals are alike (the detector is odd); x falls first.
    const auto triangle = [&](double t) {
      return t < 0.5 * period ? 1.0 - 2.0 * t / period : 2.0 * t / period - 1.0;
    };
    delay.triangle_s = detector.delay_s(triangle, 0.0, 0.5 * period, period);
    const auto sine = [&](double t) { return 0.5 + 0.5 * std::cos(2.0 * std::numbers::pi * t / period); };
    delay.sine_s = detector.delay_s(sine, 0.0, 0.5 * period, period);
    out.delays.push_back(delay);
  }
  return out;
}

/// Lag of the signal path, s: multipliers in series, the slowest sum, the output amplifier.
double lag_s(const DisturbanceCircuit& layout) {
  for (const Candidate& one : layout.candidates) {
    if (one.chosen) return 1.0 / one.bandwidth.rad_s().value;
  }
  return 0.0;
}

SwitchFigures::Late late_figures(const DisturbanceCircuit& layout, Hertz f, double delay_s) {
  SwitchFigures::Late out{.frequency = f, .delay_s = delay_s};
  const double period = 1.0 / f.value, lag = lag_s(layout);
  constexpr int kSteps = 4000;
  const RestWiring wiring(layout);
  const schematic::Deviations good = schematic::Deviations::none(layout), limit = multipliers_off(layout);
  for (int select = 0; select < (1 << layout.select_lines()); ++select) {
    const int up = layout.branch_at(select, true), down = layout.branch_at(select, false);
    if (up < 0) continue;
    std::vector<double> x, x_late, wanted;
    std::vector<bool> first;  // which branch the switch is at
    for (int i = 0; i < kSteps; ++i) {
      const double t = (i + 0.5) / kSteps * period;
      const auto triangle = [&](double at) {
        const double p = std::fmod(at + period, period) / period;
        return p < 0.5 ? 2.0 * p : 2.0 - 2.0 * p;
      };
      const bool rising = t < 0.5 * period;
      x.push_back(triangle(t));
      x_late.push_back(triangle(t - lag));
      wanted.push_back(layout.wanted(static_cast<size_t>(rising ? up : down), x.back()));
      first.push_back(std::fmod(t - delay_s + period, period) < 0.5 * period);
    }
    const auto errors_of = [&](const schematic::Deviations& off, double& rms, double* peak) {
      const std::vector<double> a = curve(AtRest(wiring, off), static_cast<size_t>(up), x_late, 1.0);
      const std::vector<double> d = curve(AtRest(wiring, off), static_cast<size_t>(down), x_late, 1.0);
      double sum = 0.0;
      for (size_t i = 0; i < x.size(); ++i) {
        const double error = 100.0 * ((first[i] ? a[i] : d[i]) - wanted[i]);
        sum += error * error / kSteps;
        if (peak != nullptr) *peak = std::max(*peak, std::abs(error));
      }
      rms = std::max(rms, std::sqrt(sum));
    };
    errors_of(good, out.rms_percent, &out.peak_percent);
    errors_of(limit, out.rms_off_percent, nullptr);
    const auto step = [&](double at) {
      return 100.0 * std::abs(layout.realised(static_cast<size_t>(up), at) -
                              layout.realised(static_cast<size_t>(down), at));
    };
    const double moved = std::min(1.0, 2.0 * f.value * delay_s);
    for (int i = 0; i <= 50; ++i) {
      const double part = moved * i / 50.0;
      out.step_percent = std::max({out.step_percent, step(part), step(1.0 - part)});
    }
  }
  return out;
}

}  // namespace

SlopeDetector::SlopeDetector(schematic::Netlist detector, std::string input)
    : netlist_(std::move(detector)), input_(std::move(input)) {}

double SlopeDetector::threshold_v() const {
  return model().swing_v * hysteresis();
}

double SlopeDetector::vt() const {
  return netlist_.diode.emission * kBoltzmann * schematic::kKelvin / kElectron;
}

double SlopeDetector::feedback_a(double v) const {
  // exp is limited: at 40 vt the diode would carry kiloamperes.
  return v / value("Rd") + 2.0 * netlist_.diode.saturation_a * std::sinh(std::clamp(v / vt(), -40.0, 40.0));
}

double SlopeDetector::noise_v() const {
  constexpr int kPoints = 425;  // 50 to a decade
  return schematic::output_noise_rms(netlist_, {Hertz{0.1}, Hertz{30e6}}, true, "sc", kPoints, input_);
}

std::vector<double> SlopeDetector::gains(const std::vector<Hertz>& grid) const {
  const schematic::Equations equations(netlist_, {.input = input_});
  std::vector<double> out;
  for (const Hertz f : grid) out.push_back(std::abs(equations.response(f.rad_s(), "sc")));
  return out;
}

std::optional<double> SlopeDetector::delay_s(const std::function<double(double)>& x, double start_s,
                                             double reversal_s, double stop_s) const {
  schematic::InTime run(netlist_, x, {.input = input_});
  run.begin(start_s, {{netlist_.part_named("Cd")->from, x(start_s)}, {"so", -model().swing_v}});
  run.run_to(reversal_s);
  const std::optional<double> at = run.rises("so", stop_s);
  return at ? std::optional(*at - reversal_s) : std::nullopt;
}

double switch_glitch_v(const DisturbanceCircuit& layout, double held_v, double charge_sign) {
  const double tau = hold_farad(layout) * layout.part(layout.passes.back().output.disturbance).realised;
  if (!(tau > 0.0) || layout.analog_switch.gap_s <= 0.0) return 0.0;
  const double gain = output_gain(layout);
  const double w = layout.opamp.gain_bandwidth.rad_s().value / (1.0 + gain);
  const double v0 = held_v + charge_sign * layout.analog_switch.charge_c / hold_farad(layout);
  double out = 0.0;
  for (int i = 1; i <= 100; ++i) {
    const double t = layout.analog_switch.gap_s * i / 100.0;
    const double apart = w - 1.0 / tau;
    const double follow = std::abs(apart * t) < 1e-6
                              ? v0 * w * t * std::exp(-w * t)
                              : v0 * w / apart * (std::exp(-t / tau) - std::exp(-w * t));
    const double moved = gain * std::abs(follow - held_v * (1.0 - std::exp(-w * t)));
    out = std::max(out, std::min(moved, layout.opamp.slew_v_per_s * t));
  }
  return out;
}

Timing make_timing(const DisturbanceCircuit& layout, const std::vector<Hertz>& frequencies) {
  Timing out;
  if (!layout.switched()) return out;
  const SwitchModel& model = layout.analog_switch;
  SwitchTimer::of(model);  // refuses delays that cannot be
  for (const Hertz f : frequencies) {
    if (!(model.on_delay_s < 0.5 / f.value)) {
      throw DesignError(fmt::format("the switch closes {} s late: it shows no branch of a triangle of {} Hz",
                                    rounded_text(model.on_delay_s), rounded_text(f.value)));
    }
  }
  out.detector = detector_figures(SlopeDetector(layout.detector_netlist(), "x"), frequencies);
  SwitchFigures& s = out.analog_switch;
  s.opens_s = model.off_delay_s();
  s.closes_s = model.on_delay_s;
  s.hold_s = hold_farad(layout) * layout.part(layout.passes.back().output.disturbance).realised;
  s.charge_step_v = hold_farad(layout) > 0.0 ? model.charge_c / hold_farad(layout) : 0.0;
  double held = 0.0;
  for (const Branch& b : layout.branches) held = std::max(held, b.peak_v);
  // 1 V at the output is 100 percent of the range of x.
  s.droop_percent = 100.0 * switch_glitch_v(layout, held, 0.0);
  s.charge_percent = 100.0 * switch_glitch_v(layout, 0.0, 1.0);
  s.glitch_percent = 100.0 * switch_glitch_v(layout, held, -1.0);
  // Held charge lost and injected charge, each through Rg, end in the output's area.
  s.glitch_area_percent_s =
      100.0 * output_gain(layout) * (held + s.charge_step_v) *
      (s.charge_step_v > 0.0 || held > 0.0 ? model.gap_s - s.hold_s * -std::expm1(-model.gap_s / s.hold_s)
                                           : 0.0);
  for (const SlopeDetectorFigures::Delay& one : out.detector.delays) {
    if (one.triangle_s)
      s.late.push_back(late_figures(layout, one.frequency, *one.triangle_s + model.on_delay_s));
  }
  return out;
}

}  // namespace bodesmith::generator
