#include "gap/cases/response_cases.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <complex>
#include <functional>
#include <map>
#include <stdexcept>

#include "gap/cases/random.hpp"

namespace hidden {
namespace {

using Complex = std::complex<double>;
using Response = std::function<Complex(Complex)>;  ///< of s

const std::map<std::string, std::vector<std::string>>& effects_by_base() {
  static const std::map<std::string, std::vector<std::string>> effects = {
      {"gain", {"amplifier_pole", "time_delay", "resonance", "rate_dependence", "sample_hold", "creep"}},
      {"fixed_gain", {"gain_error", "amplifier_pole", "time_delay"}},
      {"resonator", {"amplifier_pole", "time_delay", "resonance", "rate_dependence", "sample_hold", "creep"}},
      {"sections",
       {"opamp_bandwidth", "capacitor_mismatch", "amplifier_pole", "time_delay", "resonance",
        "sample_hold"}}};
  return effects;
}

struct Section {
  double gain, zero, pole;  ///< rad/s
  Complex operator()(Complex s) const { return gain * (1.0 + s / zero) / (1.0 + s / pole); }
};

struct Base {
  std::string model = "schema = \"bodesmith.model/1\"\n";
  double band_hz = 1000.0;
  bool free_gain = true;
  Response rest = [](Complex) { return Complex(1.0); };
  std::vector<Section> sections;

  Complex operator()(Complex s) const {
    Complex h = rest(s);
    for (const auto& section : sections) h *= section(s);
    return h;
  }
};

Base make_base(const std::string& name, Random& random, bool right) {
  const auto off = [&](double value, double part) {
    return right ? value : value * uniform(random, 1.0 - part, 1.0 + part);
  };
  Base b;
  b.band_hz = log_uniform(random, 20.0, 50e3);
  const double g = log_uniform(random, 0.1, 10.0);
  if (name == "gain" || name == "fixed_gain") {
    b.free_gain = name == "gain";
    b.rest = [=](Complex) { return Complex(g); };
    b.model += fmt::format("[[block]]\ntype = \"gain\"\ngain = {}\noffset = 0.0\n{}",
                           b.free_gain ? off(g, 0.15) : g, b.free_gain ? "free = [\"gain\"]\n" : "");
  } else if (name == "resonator") {
    const double hz = b.band_hz * uniform(random, 0.3, 0.7);
    const double d = log_uniform(random, 0.02, 0.4);
    const double w = kTwoPi * hz;
    b.rest = [=](Complex s) { return g / (1.0 + 2.0 * d * s / w + s * s / w / w); };
    b.model += fmt::format(
        "[[block]]\ntype = \"resonator\"\ngain = {}\nnatural_frequency_hz = {}\ndamping_ratio = {}\n"
        "free = [\"gain\", \"natural_frequency_hz\", \"damping_ratio\"]\n",
        off(g, 0.15), off(hz, 0.08), off(d, 0.15));
  } else if (name == "sections") {
    b.rest = [=](Complex) { return Complex(g); };
    const int count = static_cast<int>(uniform(random, 2.0, 4.99));
    for (int i = 0; i < count; ++i) {
      const double centre = b.band_hz * log_uniform(random, 0.05, 0.7);
      const double spread = std::sqrt(log_uniform(random, 1.5, 6.0));
      const bool lead = coin(random);
      const double zero = lead ? centre / spread : centre * spread;
      const double pole = lead ? centre * spread : centre / spread;
      const double gain = coin(random) ? 1.0 : log_uniform(random, 0.5, 2.0);
      b.sections.push_back({gain, kTwoPi * zero, kTwoPi * pole});
      b.model += fmt::format("[[block]]\ntype = \"pole_zero\"\ngain = {}\nzero_hz = {}\npole_hz = {}\n", gain,
                             zero, pole);
    }
    b.model +=
        fmt::format("[[block]]\ntype = \"gain\"\ngain = {}\noffset = 0.0\nfree = [\"gain\"]\n", off(g, 0.15));
  } else {
    throw std::logic_error("no such base: " + name);
  }
  return b;
}

/// The base's response with the effect in it: a table of effects, each of which draws what it needs from the
/// seed.
Response hide(const Base& b, const std::string& effect, Random& random) {
  const auto U = [&](double a, double c) { return uniform(random, a, c); };
  const auto sign = [&] { return coin(random) ? -1.0 : 1.0; };
  const double w = kTwoPi * b.band_hz;
  const auto times = [&](Response factor) -> Response {
    return [b, factor](Complex s) { return b(s) * factor(s); };
  };
  const auto k =
      static_cast<std::size_t>(U(0.0, static_cast<double>(std::max<std::size_t>(b.sections.size(), 1))));
  if (effect == "gain_error") {
    const double part = 1.0 + sign() * U(0.02, 0.08);
    return times([=](Complex) { return Complex(part); });
  }
  if (effect == "time_delay") {
    const double tau = log_uniform(random, 0.02, 0.3) / b.band_hz;
    return times([=](Complex s) { return std::exp(-s * tau); });
  }
  if (effect == "amplifier_pole") {
    const double corner = w * log_uniform(random, 0.7, 5.0);
    return times([=](Complex s) { return 1.0 / (1.0 + s / corner); });
  }
  if (effect == "resonance") {
    const double at = w * log_uniform(random, 0.4, 1.6);
    const double d = log_uniform(random, 0.02, 0.3);
    return times([=](Complex s) { return 1.0 / (1.0 + 2.0 * d * s / at + s * s / at / at); });
  }
  if (effect == "rate_dependence") {
    const double lambda = 1.0 / (w * U(0.02, 0.08));
    const double x = U(0.02, 0.05);
    const double beta = sign() * U(0.05, 0.2);
    return times([=](Complex s) { return std::pow((1.0 + lambda * s) / (1.0 + x * lambda * s), beta); });
  }
  if (effect == "creep") {
    std::array<double, 3> gains{U(0.02, 0.05), U(0.02, 0.05), U(0.02, 0.05)};
    std::array<double, 3> tau{};
    for (std::size_t i = 0; i < 3; ++i) tau[i] = std::pow(4.0, static_cast<double>(i)) * U(4.0, 8.0) / w;
    return times([=](Complex s) {
      Complex h = 1.0;
      for (std::size_t i = 0; i < 3; ++i) h += gains[i] / (1.0 + s * tau[i]);
      return h;
    });
  }
  if (effect == "sample_hold") {
    const double clock = 1.0 / (b.band_hz * log_uniform(random, 4.0, 15.0));
    return times([=](Complex s) { return (1.0 - std::exp(-s * clock)) / (s * clock); });
  }
  if (effect == "opamp_bandwidth") {
    const double wt = w * log_uniform(random, 3.0, 20.0);
    return times([=](Complex s) { return 1.0 / (1.0 + (1.0 + b.sections[k](s)) * s / wt); });
  }
  if (effect == "capacitor_mismatch") {
    Base changed = b;
    (coin(random) ? changed.sections[k].zero : changed.sections[k].pole) *=
        1.0 + sign() * log_uniform(random, 0.03, 0.2);
    return changed;
  }
  if (effect == "echo") {
    const double tau = log_uniform(random, 1.5, 6.0) / b.band_hz;
    const double part = U(0.03, 0.1);
    return times([=](Complex s) { return 1.0 + part * std::exp(-s * tau); });
  }
  if (effect == "narrow_notch") {
    const double at = w * U(0.2, 0.7);
    const double d = U(0.01, 0.03);
    return times([=](Complex s) {
      return (1.0 + 0.2 * d * s / at + s * s / at / at) / (1.0 + 2.0 * d * s / at + s * s / at / at);
    });
  }
  if (effect == "lobe") {
    const double from = w * U(0.1, 0.3);
    const double to = from * U(1.3, 1.8);
    const double part = U(0.05, 0.15);
    return times([=](Complex s) { return 1.0 + (s.imag() > from && s.imag() < to ? part : 0.0); });
  }
  throw std::logic_error("no such effect: " + effect);
}

std::vector<double> make_grid(const Base& b, bool holdout, Random& random) {
  const int count = static_cast<int>(log_uniform(random, 40.0, 400.0));
  const double from = b.band_hz * log_uniform(random, 1.0 / 300.0, 1.0 / 60.0) * (holdout ? 1.3 : 1.0);
  const double to = b.band_hz * (holdout ? uniform(random, 0.85, 1.0) : 1.0);
  const bool linear = uniform(random, 0.0, 1.0) < 0.2;
  std::vector<double> hz;
  for (int i = 0; i < count; ++i) {
    const double part = i / (count - 1.0);
    hz.push_back(linear ? from + (to - from) * part : from * std::pow(to / from, part));
  }
  return hz;
}

/// rms of a part (real or imaginary) of changed/base - 1, beyond what a free gain absorbs.
double difference(const Response& base, const Response& changed, const std::vector<double>& hz,
                  bool free_gain) {
  Complex mean = 0.0;
  std::vector<Complex> ratio;
  for (double f : hz) {
    const Complex s(0.0, kTwoPi * f);
    ratio.push_back(changed(s) / base(s));
    mean += ratio.back() / static_cast<double>(hz.size());
  }
  double sum = 0.0;
  for (const Complex& r : ratio) sum += std::norm(r - (free_gain ? Complex(mean.real()) : 1.0));
  return std::sqrt(0.5 * sum / static_cast<double>(hz.size()));
}

bodesmith::FrequencyRecord measure(const std::string& file, const Response& h, const std::vector<double>& hz,
                                   double noise, bool rising, Random& random) {
  bodesmith::FrequencyRecord r;
  r.file = file;
  for (std::size_t i = 0; i < hz.size(); ++i) {
    const double size =
        rising ? noise * std::numbers::sqrt3 * static_cast<double>(i + 1) / static_cast<double>(hz.size())
               : noise;
    r.frequency.push_back(bodesmith::Hertz{hz[i]});
    const double re = size * normal(random);
    r.response.push_back(h(Complex(0.0, kTwoPi * hz[i])) * Complex(1.0 + re, size * normal(random)));
  }
  return r;
}

}  // namespace

const std::vector<std::string>& response_bases() {
  static const std::vector<std::string> bases = {"gain", "fixed_gain", "resonator", "sections"};
  return bases;
}

const std::vector<std::string>& response_effects(const std::string& base) {
  return effects_by_base().at(base);
}

const std::vector<std::string>& response_control_kinds() {
  static const std::vector<std::string> kinds = {"white", "rising", "parameters_off", "two_records"};
  return kinds;
}

const std::vector<std::string>& response_outside_kinds() {
  static const std::vector<std::string> kinds = {"echo", "narrow_notch", "lobe"};
  return kinds;
}

Case make_response_case(const Specification& s) {
  Random random(s.salt());
  const bool control = s.kind == Kind::control;
  const Base b = make_base(s.base, random, control && s.what[0] != "parameters_off");
  Case c;
  c.specification = s;
  c.model = b.model;
  const auto train = make_grid(b, false, random);
  const auto holdout = make_grid(b, true, random);
  Response h = b;
  bool rising = false;
  if (control) {
    c.noise_rms = log_uniform(random, 0.001, 0.02);
    rising = s.what[0] == "rising";
  } else {
    h = hide(b, s.what[0], random);
    if (s.kind == Kind::effect) c.truth = s.what;
    c.effect_rms = difference(b, h, train, b.free_gain);
    c.noise_rms = c.effect_rms / s.ratio;
  }
  c.train_responses.push_back(measure("train_1.csv", h, train, c.noise_rms, rising, random));
  if ((control && s.what[0] == "two_records") || uniform(random, 0.0, 1.0) < 0.2)
    c.train_responses.push_back(
        measure("train_2.csv", h, make_grid(b, false, random), c.noise_rms, rising, random));
  c.holdout_responses.push_back(measure("holdout_1.csv", h, holdout, c.noise_rms, rising, random));
  return c;
}

}  // namespace hidden
