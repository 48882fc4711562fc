#include "gap/cases/time_cases.hpp"

#include <algorithm>
#include <map>

#include "gap/cases/time_base.hpp"

namespace hidden {
namespace {

const std::vector<std::string> kAnywhere = {"offset",
                                            "drift",
                                            "mains_hum",
                                            "time_delay",
                                            "amplifier_pole",
                                            "resonance",
                                            "slew_limit",
                                            "saturation",
                                            "dead_zone",
                                            "backlash",
                                            "quadratic_nonlinearity",
                                            "cubic_nonlinearity",
                                            "hysteresis",
                                            "asymmetric_hysteresis",
                                            "rate_dependence",
                                            "creep",
                                            "sample_hold"};

std::vector<std::string> and_also(std::vector<std::string> list, std::initializer_list<const char*> more) {
  list.insert(list.end(), more.begin(), more.end());
  return list;
}

const std::map<std::string, std::vector<std::string>>& effects_by_base() {
  static const std::map<std::string, std::vector<std::string>> effects = {
      {"gain", kAnywhere},
      {"fixed_gain", {"gain_error", "offset", "saturation", "amplifier_pole"}},
      {"resonator", and_also(kAnywhere, {"cubic_stiffness", "quadratic_stiffness", "drag"})},
      {"stage",
       {"offset", "drift", "mains_hum", "time_delay", "resonance", "saturation", "slew_limit",
        "cubic_stiffness", "creep", "multiplier_error", "switch_delay", "sample_hold", "backlash"}},
      {"sections",
       {"offset", "drift", "mains_hum", "time_delay", "resonance", "saturation", "slew_limit", "dead_zone",
        "quadratic_nonlinearity", "cubic_nonlinearity", "opamp_bandwidth", "capacitor_mismatch",
        "amplifier_pole", "sample_hold"}},
      {"curve", {"multiplier_error", "saturation", "time_delay", "mains_hum"}}};
  return effects;
}

bool wants_changing_amplitude(const std::vector<std::string>& what) {
  return std::any_of(what.begin(), what.end(), [](const std::string& e) {
    return e == "hysteresis" || e == "asymmetric_hysteresis" || e == "backlash" || e == "butterfly";
  });
}

double min_duration_s(const std::vector<std::string>& what) {
  return std::find(what.begin(), what.end(), "mains_hum") != what.end() ? 0.15 : 0.0;
}

/// Inputs of all records.
struct Inputs {
  Outputs train, holdout;
};

std::vector<double> make_input(const TimeBase& b, bool memory, bool holdout, double amplitude,
                               std::size_t rows, Random& random) {
  auto u = make_drive(pick_drive(random, holdout, memory || b.one_sided), rows, b.step_s, b.band_hz, random);
  for (double& v : u) v *= b.one_sided ? amplitude : amplitude * b.amplitude;
  if (b.one_sided) {
    for (double& v : u) v = 0.5 + 0.5 * v;
    // Come up from 0 gently: a record that starts at rest.
    for (std::size_t i = 0; i < 150; ++i) u[i] *= static_cast<double>(i) / 150.0;
  }
  return u;
}

/// One record to fit, or two of different amplitude; the same to hold out.
Inputs make_inputs(const TimeBase& b, bool memory, std::size_t rows, Random& random) {
  Inputs in;
  const bool two = rows >= 4000 && uniform(random, 0.0, 1.0) < 0.35;
  const std::size_t first = two ? rows * 3 / 5 : rows;
  in.train.push_back(make_input(b, memory, false, 1.0, first, random));
  if (two) in.train.push_back(make_input(b, memory, false, uniform(random, 0.3, 0.7), rows - first, random));
  in.holdout.push_back(make_input(b, memory, true, uniform(random, 0.8, 1.0), first, random));
  if (two && coin(random))
    in.holdout.push_back(make_input(b, memory, true, uniform(random, 0.4, 0.7), rows - first, random));
  return in;
}

Outputs play_all(const std::vector<Stage>& stages, const Outputs& inputs, double step_s) {
  Outputs out;
  for (const auto& u : inputs) out.push_back(play_chain(stages, u, step_s));
  return out;
}

std::size_t pick_rows(const Specification& s, Random& random) {
  return s.rows > 0 ? s.rows : static_cast<std::size_t>(log_uniform(random, 2000.0, 20000.0));
}

Colour pick_colour(Random& random) {
  return pick<Colour>(random, {Colour::white, Colour::coloured, Colour::red});
}

Case make_effects(const Specification& s, Random& random) {
  Case c;
  c.truth = s.what;
  const std::size_t rows = pick_rows(s, random);
  TimeBase b = make_time_base(s.base, random, false, rows, min_duration_s(s.what));
  c.model = b.model;
  const auto in = make_inputs(b, wants_changing_amplitude(s.what), rows, random);
  const auto plain = play_all(b.stages, in.train, b.step_s);
  auto stages = b.stages;
  double smallest = 1e300;
  // What changes a stage of the base goes first, while the stages still stand where the base put them.
  auto order = s.what;
  std::stable_partition(order.begin(), order.end(), changes_a_stage);
  const TimeBase untouched = b;
  for (const auto& e : order) {
    TimeBase apart = untouched;
    auto alone = apart.stages;
    Random same = random;
    hide(apart, alone, e, in.train[0], same);
    smallest = std::min(smallest, difference(plain, play_all(alone, in.train, b.step_s), b.free_gain));
    hide(b, stages, e, in.train[0], random);
  }
  c.effect_rms = smallest;
  c.noise_rms = smallest / s.ratio;
  const Colour colour = pick_colour(random);
  finish(c, b.step_s, in.train, play_all(stages, in.train, b.step_s), in.holdout,
         play_all(stages, in.holdout, b.step_s), colour, random);
  return c;
}

Case make_control(const Specification& s, Random& random) {
  const std::string& what = s.what[0];
  Case c;
  const std::size_t rows = pick_rows(s, random);
  const TimeBase b = make_time_base(s.base, random, what != "parameters_off", rows, 0.0);
  c.model = b.model;
  const auto in = make_inputs(b, false, rows, random);
  auto train = play_all(b.stages, in.train, b.step_s);
  auto holdout = play_all(b.stages, in.holdout, b.step_s);
  c.noise_rms = rms(train[0]) * log_uniform(random, 0.002, 0.03);
  if (what == "wrong_start" && b.slowest_hz > 0.0) {
    // Rings or settles from somewhere else when the record begins.
    const double size = 20.0 * c.noise_rms;
    const double tau = 1.0 / (2 * std::numbers::pi * b.slowest_hz);
    const double d = b.inner.damping;
    const double w = b.sections.empty() ? 2 * std::numbers::pi * b.inner.hz * std::sqrt(1.0 - d * d) : 0.0;
    for (auto* records : {&train, &holdout}) {
      for (auto& y : *records) {
        for (std::size_t i = 0; i < y.size(); ++i) {
          const double t = static_cast<double>(i) * b.step_s;
          y[i] += size * std::exp(-t / tau) * std::cos(w * t);
        }
      }
    }
  }
  const Colour colour = what == "coloured"  ? Colour::coloured
                        : what == "red"     ? Colour::red
                        : what == "ringing" ? Colour::ringing
                        : what == "white"   ? Colour::white
                                            : pick_colour(random);
  finish(c, b.step_s, in.train, train, in.holdout, holdout, colour, random);
  if (what == "quantised") {
    // A converter whose step is some of the noise's size.
    const double step = c.noise_rms * uniform(random, 1.0, 3.0);
    for (auto* records : {&c.train, &c.holdout}) {
      for (auto& r : *records) {
        for (double& v : r.y) v = step * std::round(v / step);
      }
    }
    c.noise_rms = std::hypot(c.noise_rms, step / std::sqrt(12.0));
  }
  return c;
}

Case make_outside(const Specification& s, Random& random) {
  Case c;
  const std::size_t rows = pick_rows(s, random);
  const TimeBase b = make_time_base(s.base, random, false, rows, 0.0);
  c.model = b.model;
  const auto in = make_inputs(b, wants_changing_amplitude(s.what), rows, random);
  const auto plain = play_all(b.stages, in.train, b.step_s);
  auto stages = b.stages;
  hide_outsider(b, stages, s.what[0], in.train[0], random);
  const auto train = play_all(stages, in.train, b.step_s);
  c.effect_rms = difference(plain, train, b.free_gain);
  c.noise_rms = c.effect_rms / s.ratio;
  finish(c, b.step_s, in.train, train, in.holdout, play_all(stages, in.holdout, b.step_s),
         pick_colour(random), random);
  return c;
}

}  // namespace

const std::vector<std::string>& time_bases() {
  static const std::vector<std::string> bases = {"gain",  "fixed_gain", "resonator",
                                                 "stage", "sections",   "curve"};
  return bases;
}

const std::vector<std::string>& time_effects(const std::string& base) {
  return effects_by_base().at(base);
}

const std::vector<std::string>& control_kinds() {
  static const std::vector<std::string> kinds = {"white",       "coloured",       "red",      "ringing",
                                                 "wrong_start", "parameters_off", "quantised"};
  return kinds;
}

const std::vector<std::string>& outside_kinds() {
  static const std::vector<std::string> kinds = {"one_sided_diode", "butterfly", "drop_out", "passing_tone",
                                                 "level_jump"};
  return kinds;
}

Case make_time_case(const Specification& s) {
  Random random(s.salt());
  Case c = s.kind == Kind::control   ? make_control(s, random)
           : s.kind == Kind::outside ? make_outside(s, random)
                                     : make_effects(s, random);
  c.specification = s;
  return c;
}

}  // namespace hidden
