#include "gap/cases/spice_cases.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include "gap/cases/deck.hpp"
#include "gap/cases/random.hpp"
#include "gap/cases/signals.hpp"
#include "gap/cases/time_base.hpp"

namespace hidden {
namespace {

const std::map<std::string, std::vector<std::string>>& spice_effects() {
  static const std::map<std::string, std::vector<std::string>> effects = {
      {"opamp_gain",
       {"offset", "drift", "mains_hum", "time_delay", "amplifier_pole", "resonance", "slew_limit",
        "saturation", "dead_zone", "backlash", "quadratic_nonlinearity", "cubic_nonlinearity", "hysteresis",
        "creep", "sample_hold"}},
      {"opamp_sections",
       {"opamp_bandwidth", "capacitor_mismatch", "saturation", "slew_limit", "offset", "mains_hum",
        "time_delay", "amplifier_pole", "resonance", "dead_zone"}},
      {"rlc", {"time_delay", "saturation", "mains_hum", "offset", "sample_hold"}},
      {"spring", {"cubic_stiffness", "quadratic_stiffness", "drag"}},
      {"multipliers", {"multiplier_error", "saturation", "time_delay"}},
      {"switched", {"switch_delay", "multiplier_error", "mains_hum"}}};
  return effects;
}

struct SpiceBase {
  std::string model = "schema = \"bodesmith.model/1\"\n";
  std::vector<TwoPort> ports;
  double step_s = 1e-4;
  double band_hz = 300.0;
  double amplitude = 1.0;
  bool switched = false;  ///< input in [0, 1], with a branch signal
  bool resonant = false;
  OpAmp good;
  std::vector<SectionParts> sections;  ///< port i is section i
  SpringParts spring;
  double c2 = 0.0, c3 = 0.0;
  std::vector<double> up, down;
};

std::string lowpass_text(double corner) {
  return fmt::format("[[block]]\ntype = \"lowpass\"\ncorner_hz = {}\nfree = [\"corner_hz\"]\n", corner);
}

// One table of bases and one of effects: each entry draws what it needs from the seed, and is read on its
// own.

SpiceBase make_base(const std::string& name, Random& random, bool right, std::size_t rows,
                    double min_duration_s) {
  const auto U = [&](double a, double c) { return uniform(random, a, c); };
  const auto off = [&](double value, double part) {
    return right ? value : value * U(1.0 - part, 1.0 + part);
  };
  SpiceBase b;
  b.step_s = std::max(log_uniform(random, 1e-5, 4e-4), min_duration_s / static_cast<double>(rows));
  b.band_hz = U(0.015, 0.04) / b.step_s;
  b.amplitude = U(0.4, 1.0);
  b.good = {.gain_bandwidth_hz = 1e5 * b.band_hz,
            .slew_v_per_s = 1e4 * b.band_hz,
            .upper_v = 14.1,
            .lower_v = -14.1};
  if (name == "opamp_gain") {
    const double g = log_uniform(random, 0.3, 6.0);
    b.ports = {inverter_port(g, b.good), inverter_port(1.0, b.good)};
    b.model += gain_text(off(g, 0.15));
  } else if (name == "opamp_sections") {
    const int count = coin(random) ? 2 : 3;
    bool lead = coin(random);
    for (int i = 0; i < count; ++i, lead = !lead) {
      const double centre = b.band_hz * log_uniform(random, 0.15, 0.8);
      const double spread = std::sqrt(log_uniform(random, 1.6, 4.0));
      SectionParts s;
      s.zero_hz = lead ? centre / spread : centre * spread;
      s.pole_hz = lead ? centre * spread : centre / spread;
      b.sections.push_back(s);
      b.ports.push_back(section_port(s, b.good));
      b.model += fmt::format("[[block]]\ntype = \"pole_zero\"\ngain = 1.0\nzero_hz = {}\npole_hz = {}\n",
                             s.zero_hz, s.pole_hz);
    }
    const double g = count == 2 ? 1.0 : log_uniform(random, 0.5, 2.0);
    if (count == 3) b.ports.push_back(inverter_port(g, b.good));
    b.model += gain_text(off(g, 0.15));
  } else if (name == "rlc" || name == "spring") {
    b.resonant = true;
    const double hz = b.band_hz * U(0.6, 1.1);
    const double d = log_uniform(random, 0.05, 0.4);
    b.spring = {.gain = name == "rlc" ? 1.0 : log_uniform(random, 0.4, 2.0), .hz = hz, .damping = d};
    b.ports = {name == "rlc" ? rlc_port(hz, d) : spring_port(b.spring)};
    b.model += resonator_text(off(b.spring.gain, 0.15), off(hz, 0.08), off(d, 0.15));
  } else if (name == "multipliers") {
    b.c2 = U(-0.4, 0.4) / b.amplitude;
    b.c3 = U(0.15, 0.4) / b.amplitude / b.amplitude;
    const double corner = b.band_hz * U(2.0, 5.0);
    b.ports = {curve_port(b.c2, b.c3, {}), lowpass_port(corner), follower_port(b.good)};
    b.model +=
        fmt::format("[[block]]\ntype = \"polynomial\"\ncoefficients = [0.0, 1.0, {}, {}]\n", b.c2, b.c3) +
        lowpass_text(off(corner, 0.15)) + gain_text(off(1.0, 0.15));
  } else if (name == "switched") {
    b.switched = true;
    b.band_hz *= 0.4;
    b.amplitude = 1.0;
    for (auto* a : {&b.up, &b.down}) {
      const double sign = a == &b.up ? -1.0 : 1.0;
      *a = {sign * U(0.15, 0.35), -sign * U(0.25, 0.6), sign * U(0.1, 0.25)};
    }
    const double corner = b.band_hz * U(6.0, 12.0);
    b.ports = {branches_port(b.up, b.down, {}, 0.0), lowpass_port(corner), follower_port(b.good)};
    b.model += fmt::format(
                   "[[block]]\ntype = \"polynomial_hysteresis\"\nascending = [{}, {}, {}]\ndescending = [{}, "
                   "{}, {}]\n",
                   b.up[0], b.up[1], b.up[2], b.down[0], b.down[1], b.down[2]) +
               lowpass_text(off(corner, 0.15)) + gain_text(off(1.0, 0.15));
  } else {
    throw std::logic_error("no such base: " + name);
  }
  return b;
}

/// What the size of a part must be chosen for: the clean output under the first input.
struct Seen {
  double low = 0.0, high = 0.0, slope = 0.0;
  double size() const { return std::max(high, -low); }
};

Seen look(const std::vector<double>& y, double step_s) {
  Seen s;
  std::vector<double> slopes;
  for (std::size_t i = 1; i < y.size(); ++i) slopes.push_back(std::abs(y[i] - y[i - 1]) / step_s);
  std::sort(slopes.begin(), slopes.end());
  s.low = *std::min_element(y.begin(), y.end());
  s.high = *std::max_element(y.begin(), y.end());
  const double usual = slopes[slopes.size() * 9 / 10];
  s.slope = slopes.back() < 1.3 * usual ? 0.6 * slopes.back() : std::max(usual, 0.05 * slopes.back());
  return s;
}

std::vector<TwoPort> hide(const SpiceBase& b, const std::string& effect, const Seen& out, double total_s,
                          Random& random) {
  const auto U = [&](double a, double c) { return uniform(random, a, c); };
  const auto sign = [&] { return coin(random) ? -1.0 : 1.0; };
  auto ports = b.ports;
  const bool front = coin(random);
  const double size = front ? b.amplitude : out.size();
  const auto insert = [&](TwoPort port) {
    ports.insert(front ? ports.begin() : ports.end(), std::move(port));
  };
  const auto append = [&](TwoPort port) { ports.push_back(std::move(port)); };
  const auto section =
      static_cast<std::size_t>(U(0.0, static_cast<double>(std::max<std::size_t>(b.sections.size(), 1))));
  OpAmp slow = b.good;
  if (effect == "offset") {
    if (!b.sections.empty()) {  // the input offset of a section's op-amp
      slow.offset_v = sign() * b.amplitude * U(0.015, 0.04);
      ports[section] = section_port(b.sections[section], slow);
    } else {
      insert(series_port(sign() * size * U(0.02, 0.08)));
    }
  } else if (effect == "drift")
    append(drift_port(sign() * out.size() * U(0.05, 0.2) / total_s));
  else if (effect == "mains_hum")
    append(hum_port(out.size() * U(0.02, 0.05), coin(random) ? 50.0 : 60.0, U(0.0, 360.0)));
  else if (effect == "time_delay")
    insert(line_port(b.step_s * log_uniform(random, 0.8, 8.0)));
  else if (effect == "amplifier_pole") {
    slow.gain_bandwidth_hz = b.band_hz * log_uniform(random, 1.0, 5.0);
    insert(follower_port(slow));
  } else if (effect == "resonance")
    insert(rlc_port(b.band_hz * U(1.0, 2.2), log_uniform(random, 0.04, 0.3)));
  else if (effect == "slew_limit") {
    slow.slew_v_per_s = out.slope;
    append(follower_port(slow));
  } else if (effect == "saturation") {
    slow.upper_v = out.high * U(0.6, 0.85);
    slow.lower_v = coin(random) ? slow.lower_v : out.low * U(0.6, 0.85);
    append(follower_port(slow));
  } else if (effect == "dead_zone")
    insert(dead_zone_port(size * U(0.06, 0.2)));
  else if (effect == "backlash")
    insert(play_port(size * U(0.04, 0.15)));
  else if (effect == "quadratic_nonlinearity")
    insert(curve_port(sign() * U(0.05, 0.15) / size, 0.0, {}));
  else if (effect == "cubic_nonlinearity")
    insert(curve_port(0.0, sign() * U(0.05, 0.15) / (size * size), {}));
  else if (effect == "hysteresis")
    insert(plays_port({0.1 * size, 0.3 * size, 0.6 * size, 1.0 * size, 1.4 * size},
                      {U(0.05, 0.1), U(0.05, 0.08), U(0.04, 0.08), U(0.03, 0.06), U(0.03, 0.06)}));
  else if (effect == "creep") {
    const double k = U(0.7, 1.4) * total_s;
    insert(absorption_port({U(0.03, 0.06), U(0.03, 0.06), U(0.03, 0.06)}, {0.033 * k, 0.13 * k, 0.5 * k}));
  } else if (effect == "sample_hold")
    insert(hold_port(b.band_hz * log_uniform(random, 4.0, 12.0)));
  else if (effect == "opamp_bandwidth") {
    slow.gain_bandwidth_hz = b.band_hz * log_uniform(random, 4.0, 20.0);
    ports[section] = section_port(b.sections[section], slow);
  } else if (effect == "capacitor_mismatch") {
    SectionParts s = b.sections[section];
    (coin(random) ? s.input_mismatch : s.feedback_mismatch) = sign() * log_uniform(random, 0.03, 0.2);
    ports[section] = section_port(s, b.good);
  } else if (effect == "cubic_stiffness" || effect == "quadratic_stiffness" || effect == "drag") {
    SpringParts s = b.spring;
    const double reach = out.size();
    if (effect == "cubic_stiffness") s.cubic = U(0.05, 0.2) / reach / reach;
    if (effect == "quadratic_stiffness") s.quadratic = sign() * U(0.05, 0.15) / reach;
    if (effect == "drag") s.drag = U(1.0, 3.0) * s.damping / (reach * kTwoPi * s.hz);
    ports[0] = spring_port(s);
  } else if (effect == "multiplier_error") {
    const Multiplier m{.scale = 1.0 + sign() * U(0.02, 0.07),
                       .x_offset_v = U(-0.03, 0.03) * b.amplitude,
                       .output_offset_v = U(-0.01, 0.01) * b.amplitude * b.amplitude};
    ports[0] = b.switched ? branches_port(b.up, b.down, m, 0.0) : curve_port(b.c2, b.c3, m);
  } else if (effect == "switch_delay") {
    // An RC line reaches the middle after ln 2 time constants.
    ports[0] = branches_port(b.up, b.down, {}, b.step_s * log_uniform(random, 6.0, 40.0));
  } else if (effect == "diode") {
    append(diode_port(log_uniform(random, 0.1, 0.4) / b.band_hz, out.size() * U(0.02, 0.1)));
  } else
    throw std::logic_error("no such effect: " + effect);
  return ports;
}

bool wants_changing_amplitude(const Specification& s) {
  return s.base == "switched" || s.what[0] == "hysteresis" || s.what[0] == "backlash";
}

std::vector<double> make_input(const SpiceBase& b, bool memory, bool holdout, std::size_t rows,
                               Random& random) {
  auto u = make_drive(pick_drive(random, holdout, memory), rows, b.step_s, b.band_hz, random);
  const double scale = b.amplitude * (holdout ? uniform(random, 0.8, 1.0) : 1.0);
  for (double& v : u) v *= scale;
  if (b.switched) {
    for (double& v : u) v = 0.5 + 0.5 * v;
    for (std::size_t i = 0; i < 100; ++i) u[i] *= static_cast<double>(i) / 100.0;
  }
  return u;
}

}  // namespace

const std::vector<std::string>& spice_bases() {
  static const std::vector<std::string> bases = {"opamp_gain", "opamp_sections", "rlc",
                                                 "spring",     "multipliers",    "switched"};
  return bases;
}

const std::vector<std::string>& spice_effects(const std::string& base) {
  return spice_effects().at(base);
}

const std::vector<std::string>& spice_control_kinds() {
  static const std::vector<std::string> kinds = {"white", "coloured", "red", "parameters_off"};
  return kinds;
}

const std::vector<std::string>& spice_outside_kinds() {
  static const std::vector<std::string> kinds = {"diode"};
  return kinds;
}

Case make_spice_case(const Specification& s) {
  Random random(s.salt());
  const std::size_t rows =
      s.rows > 0 ? s.rows : static_cast<std::size_t>(log_uniform(random, 2000.0, 6000.0));
  const bool control = s.kind == Kind::control;
  const std::string& what = s.what[0];
  const SpiceBase b =
      make_base(s.base, random, control && what != "parameters_off", rows, what == "mains_hum" ? 0.15 : 0.0);
  Case c;
  c.specification = s;
  c.model = b.model;
  const bool memory = wants_changing_amplitude(s);
  const auto train = make_input(b, memory, false, rows, random);
  const auto holdout = make_input(b, memory, true, rows, random);
  const auto run = [&](const std::vector<TwoPort>& ports, const std::vector<double>& u) {
    return run_deck(ports, u, b.step_s, b.switched, b.resonant);
  };
  const auto clean = run(b.ports, train);
  if (control) {
    c.noise_rms = rms(clean) * log_uniform(random, 0.003, 0.03);
    const Colour colour = what == "white"      ? Colour::white
                          : what == "coloured" ? Colour::coloured
                          : what == "red"      ? Colour::red
                                               : pick<Colour>(random, {Colour::white, Colour::coloured});
    finish(c, b.step_s, {train}, {clean}, {holdout}, {run(b.ports, holdout)}, colour, random);
    return c;
  }
  const auto ports = hide(b, what, look(clean, b.step_s), b.step_s * static_cast<double>(rows), random);
  const auto seen = run(ports, train);
  if (s.kind == Kind::effect) c.truth = s.what;
  c.effect_rms = difference({clean}, {seen}, true);
  c.noise_rms = c.effect_rms / s.ratio;
  finish(c, b.step_s, {train}, {seen}, {holdout}, {run(ports, holdout)},
         pick<Colour>(random, {Colour::white, Colour::coloured, Colour::red}), random);
  return c;
}

CleanDeck make_clean_deck(const std::string& base, std::uint64_t seed, std::size_t rows) {
  Random random(seed);
  const SpiceBase b = make_base(base, random, true, rows, 0.0);
  CleanDeck out;
  out.model = b.model;
  out.record.file = "clean.csv";
  out.record.step_s = b.step_s;
  out.record.u = make_input(b, base == "switched", false, rows, random);
  out.record.y = run_deck(b.ports, out.record.u, b.step_s, b.switched, b.resonant);
  return out;
}

}  // namespace hidden
