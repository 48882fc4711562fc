#include "synthesis/opamp_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/progress.hpp"
#include "base/text.hpp"
#include "lti/frequency_grid.hpp"
#include "lti/loop_margins.hpp"
#include "schematic/analysis/equations.hpp"
#include "schematic/analysis/response.hpp"

namespace bodesmith::synthesis {
namespace {

double quality(const Biquad& h) {
  if (h.a2 == 0.0 || h.a1 == 0.0) return 0.0;
  const double q = std::sqrt(std::abs(h.a0 * h.a2)) / std::abs(h.a1);
  return q > 0.5 ? q : 0.0;
}

/// Loop gain of one op-amp with all others at work.
class Loop {
 public:
  Loop(const schematic::Equations& equations, const Circuit& circuit, size_t opamp)
      : equations_(equations), circuit_(circuit), opamp_(opamp) {}

  Complex gain(RadPerSecond w) const {
    stop_if_interrupted();
    return schematic::return_ratios(equations_, circuit_, {opamp_}, w).front();
  }

  /// Least over the crossings of |L| = 1 of 24 octaves below 3 gain-bandwidths, where the op-amp alone is far below 1.
  double phase_margin_deg() const {
    constexpr int kOctaves = 24;
    const Hertz top{3.0 * circuit_.opamp.gain_bandwidth.value};
    double out = 180.0;
    for (const LoopMargins::GainCrossing& crossing :
         gain_crossings([this](Hertz f) { return gain(f.rad_s()); },
                        log_grid({Hertz{std::ldexp(top.value, -kOctaves)}, top}, kOctaves + 1)))
      out = std::min(out, crossing.phase_margin_deg);
    return out;
  }

 private:
  const schematic::Equations& equations_;
  const Circuit& circuit_;
  size_t opamp_;
};

void phase_margins(const Circuit& circuit, OpAmpCheck& out) {
  const schematic::Equations equations(circuit);
  Progress progress("phase margins");
  for (size_t i = 0; i < circuit.opamps.size(); ++i) {
    progress.at(static_cast<double>(i) / static_cast<double>(circuit.opamps.size()));
    const double margin = Loop(equations, circuit, i).phase_margin_deg();
    if (margin < out.min_phase_margin_deg) {
      out.min_phase_margin_deg = margin;
      out.tightest_stage = circuit.opamps[i].group + 1;
    }
  }
}

/// What flows through the op-amps' outputs is an unknown of the network's equations.
void output_currents(const Circuit& circuit, const std::vector<Hertz>& grid, double amplitude_v,
                     OpAmpCheck& out) {
  const schematic::Equations equations(circuit);
  for (const Hertz f : grid) {
    const Eigen::VectorXcd x = solve_sparse(equations.small_signal(f.rad_s()));
    for (size_t i = 0; i < circuit.opamps.size(); ++i) {
      const double current = amplitude_v * std::abs(x(equations.row_of_opamp(i)));
      if (current <= out.output_current_a) continue;
      out.output_current_a = current;
      out.loaded_stage = circuit.opamps[i].group + 1;
    }
  }
}

/// The stages' greatest |gain| from the input over the grid, at least 1.
double highest_gain(const Circuit& circuit, const std::vector<Hertz>& grid) {
  double out = 1.0;
  for (const Hertz f : grid) {
    Complex h = 1.0;
    for (const Stage& stage : circuit.stages) {
      h *= stage.response(f.rad_s());
      out = std::max(out, std::abs(h));
    }
  }
  return out;
}

/// The pair of poles that asks most of an op-amp: the largest Q f.
struct Resonance {
  double q = 0.0, hz = 0.0;
  double product_hz() const { return q * hz; }
};

Resonance hardest_resonance(const Circuit& circuit) {
  Resonance out;
  for (const Stage& stage : circuit.stages) {
    // Ladders, which have several factors, have real poles only.
    const Biquad& h = stage.realised.front();
    const double q = quality(h);
    if (q == 0.0) continue;
    const Resonance one{q, RadPerSecond{std::sqrt(h.a0 / h.a2)}.hz().value};
    if (one.product_hz() > out.product_hz()) out = one;
  }
  return out;
}

double highest_quality(const Circuit& circuit) {
  double out = 0.0;
  for (const Stage& stage : circuit.stages) out = std::max(out, quality(stage.realised.front()));
  return out;
}

/// What a person should know, in the order of the figures. `peak_v`: at the highest node.
std::vector<std::string> warnings_of(const OpAmpCheck& check, const OpAmpModel& model, Band band,
                                     double amplitude_v, double peak_v, const Resonance& resonance) {
  std::vector<std::string> out;
  const auto warn = [&](std::string text) { out.push_back(std::move(text)); };
  if (check.against_ideal.max_magnitude_db > 0.1) {
    warn(fmt::format("{}: gain-bandwidth of {} costs {} dB at {}", model.name,
                     engineering_text(model.gain_bandwidth.value, "Hz"),
                     rounded_text(check.against_ideal.max_magnitude_db, 3),
                     engineering_text(check.against_ideal.worst.value, "Hz")));
  }
  if (check.min_phase_margin_deg < 30.0) {
    warn(
        fmt::format("{}: stage {} drives so much capacitance behind {} ohm that {} degrees of phase margin "
                    "are left; smaller "
                    "capacitors, and with them greater resistors, help",
                    model.name, check.tightest_stage, rounded_text(model.output_resistance_ohm),
                    rounded_text(check.min_phase_margin_deg, 3)));
  }
  if (check.output_offset_v > model.swing_v) {
    warn(fmt::format(
        "{}: offset and bias current drive the output to its rail, expected a loop closed round it (an "
        "integrator) or less gain at rest",
        model.name));
  } else if (check.output_offset_v > 0.01 * amplitude_v) {
    warn(fmt::format("{}: bias current of {} and offset of {} add up to {} at the output", model.name,
                     engineering_text(model.bias_current_a, "A"), engineering_text(model.offset_v, "V"),
                     engineering_text(check.output_offset_v, "V")));
  }
  if (check.full_swing_hz < band.to.value) {
    warn(fmt::format("{}: slews above {} with {} V at the input", model.name,
                     engineering_text(check.full_swing_hz, "Hz"), rounded_text(amplitude_v)));
  }
  if (peak_v > model.swing_v) {
    warn(fmt::format("{}: a stage reaches {} V, it swings to {} V", model.name, rounded_text(peak_v, 3),
                     rounded_text(model.swing_v)));
  }
  if (check.output_current_a > model.greatest_output_current_a) {
    warn(fmt::format(
        "{}: stage {} delivers {} with {} V at the input, the op-amp at most {}; greater resistors help",
        model.name, check.loaded_stage, engineering_text(check.output_current_a, "A"),
        rounded_text(amplitude_v), engineering_text(model.greatest_output_current_a, "A")));
  }
  if (resonance.product_hz() > 0.0 && 100.0 * resonance.product_hz() > model.gain_bandwidth.value) {
    warn(fmt::format("{}: Q = {} at {} requires a gain-bandwidth of {} or more", model.name,
                     rounded_text(resonance.q, 3), engineering_text(resonance.hz, "Hz"),
                     engineering_text(100.0 * resonance.product_hz(), "Hz")));
  }
  return out;
}

}  // namespace

OpAmpCheck check_opamps(const Circuit& circuit, Band band, double amplitude_v) {
  const OpAmpModel& model = circuit.opamp;
  OpAmpCheck out;
  out.name = model.name;
  const std::vector<Hertz> grid = log_grid(band, 61);
  const std::vector<Complex> ideal = circuit.responses(grid);
  out.against_ideal = compare_responses(grid, schematic::network_response(circuit, grid), ideal);
  phase_margins(circuit, out);
  out.output_offset_v = schematic::worst_output_offset(circuit);
  const double highest = highest_gain(circuit, grid);
  out.full_swing_hz = model.slew_v_per_s / (2.0 * std::numbers::pi * highest * amplitude_v);
  output_currents(circuit, grid, amplitude_v, out);
  out.highest_q = highest_quality(circuit);
  out.noise_rms_v = schematic::output_noise_rms(circuit, band);
  out.warnings =
      warnings_of(out, model, band, amplitude_v, highest * amplitude_v, hardest_resonance(circuit));
  return out;
}

}  // namespace bodesmith::synthesis
