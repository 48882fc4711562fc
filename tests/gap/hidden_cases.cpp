#include "gap/hidden_cases.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <random>
#include <stdexcept>

#include "gap/hidden_stages.hpp"

namespace hidden {
namespace {

using Random = std::mt19937_64;

double uniform(Random& random, double a, double b) {
  return a + (b - a) * (static_cast<double>(random() >> 11) * 0x1.0p-53);
}
double log_uniform(Random& random, double a, double b) {
  return a * std::pow(b / a, uniform(random, 0.0, 1.0));
}
double normal(Random& random) {
  const double a = uniform(random, 1e-12, 1.0);
  return std::sqrt(-2.0 * std::log(a)) * std::cos(2.0 * std::numbers::pi * uniform(random, 0.0, 1.0));
}

constexpr double kStep = 1e-4;

enum class Drive { multisine, triangle, sweep, steps, noise };

/// Inputs of amplitude about 1 around 0, sample by sample. Bands suit the base chains below.
std::vector<double> drive(Drive kind, size_t n, double band_hz, Random& random) {
  std::vector<double> u(n, 0.0);
  const double total = static_cast<double>(n) * kStep;
  switch (kind) {
    case Drive::multisine: {  // four periods, odd harmonics, random phases
      const double period = total / 4.0;
      const int top = std::max(9, static_cast<int>(band_hz * period));
      double largest = 0.0;
      for (int k = 1; k <= top; k += 2) {
        const double phase = uniform(random, 0.0, 2.0 * std::numbers::pi);
        for (size_t i = 0; i < n / 4; ++i) {
          u[i] += std::sin(
              2.0 * std::numbers::pi * k * static_cast<double>(i) / (static_cast<double>(n) / 4.0) + phase);
        }
      }
      for (size_t i = 0; i < n / 4; ++i) largest = std::max(largest, std::abs(u[i]));
      for (size_t i = 0; i < n; ++i) u[i] = i < n / 4 ? u[i] / largest : u[i - n / 4];
      break;
    }
    case Drive::triangle: {  // growing and shrinking amplitude, two rates
      double phase = 0.0;
      for (size_t i = 0; i < n; ++i) {
        const double part = static_cast<double>(i) / static_cast<double>(n);
        const double f = band_hz * (part < 0.5 ? 0.08 : 0.25);
        const double saw = phase - std::floor(phase);
        const double amplitude = 0.35 + 0.65 * std::abs(std::sin(std::numbers::pi * 3.0 * part));
        u[i] = amplitude * (saw < 0.25 ? 4 * saw : saw < 0.75 ? 2 - 4 * saw : 4 * saw - 4);
        phase += f * kStep;
      }
      break;
    }
    case Drive::sweep: {
      const double low = band_hz * 0.03;
      const double k = std::log(band_hz / low) / total;
      for (size_t i = 0; i < n; ++i) {
        const double t = static_cast<double>(i) * kStep;
        u[i] = (0.6 + 0.4 * std::sin(2 * std::numbers::pi * 1.7 * t / total * 4)) *
               std::sin(2.0 * std::numbers::pi * low * (std::exp(k * t) - 1.0) / k);
      }
      break;
    }
    case Drive::steps: {
      double level = 0.0;
      double next = 0.01;
      for (size_t i = 0; i < n; ++i) {
        if (static_cast<double>(i) * kStep >= next) {
          level = uniform(random, -1.0, 1.0);
          next += uniform(random, 1.5, 8.0) / band_hz;
        }
        u[i] = level;
      }
      break;
    }
    case Drive::noise: {
      const double a = std::exp(-2.0 * std::numbers::pi * band_hz * 0.5 * kStep);
      double x = 0.0;
      double y = 0.0;
      double largest = 0.0;
      for (size_t i = 0; i < n; ++i) {
        x = a * x + (1 - a) * normal(random);
        y = a * y + (1 - a) * x;
        u[i] = y;
        largest = std::max(largest, std::abs(y));
      }
      for (double& v : u) v /= largest;
      break;
    }
  }
  return u;
}

Fine refine(const std::vector<double>& u) {
  Fine fine((u.size() - 1) * kOversampling + 1);
  for (size_t i = 0; i + 1 < u.size(); ++i) {
    for (int k = 0; k < kOversampling; ++k) {
      fine[i * kOversampling + static_cast<size_t>(k)] = u[i] + (u[i + 1] - u[i]) * k / kOversampling;
    }
  }
  fine.back() = u.back();
  return fine;
}

std::vector<double> play_chain(const std::vector<Stage>& stages, const std::vector<double>& u) {
  Fine fine = refine(u);
  const double h = kStep / kOversampling;
  for (const auto& stage : stages) fine = stage(fine, h);
  std::vector<double> y(u.size());
  for (size_t i = 0; i < u.size(); ++i) y[i] = fine[i * kOversampling];
  return y;
}

double rms(const std::vector<double>& v) {
  double sum = 0.0;
  for (double x : v) sum += x * x;
  return std::sqrt(sum / static_cast<double>(v.size()));
}

/// Noise of unit rms: white, or first-order coloured, or the hum-like resonance of a room.
std::vector<double> make_noise(int colour, size_t n, Random& random) {
  std::vector<double> e(n);
  double x = 0.0;
  double x2 = 0.0;
  for (size_t i = 0; i < n; ++i) {
    const double w = normal(random);
    if (colour == 0) e[i] = w;
    if (colour == 1) e[i] = x = 0.9 * x + w;
    if (colour == 2) e[i] = x = 0.99 * x + w;
    if (colour == 3) {
      const double next = 1.8 * x - 0.9 * x2 + w;
      x2 = x;
      e[i] = x = next;
    }
  }
  const double size = rms(e);
  for (double& v : e) v /= size;
  return e;
}

/// A base chain: the true stages, its model.toml, the input it is driven with.
struct Base {
  std::string name;
  std::vector<Stage> stages;
  std::string model;
  double band_hz = 300.0;
  bool one_sided = false;  ///< input in [0, 1]
  std::vector<std::string> effects;
  Mode inner;  ///< of the resonator, with what was hidden in it so far
};

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

std::string header() {
  return "schema = \"bodesmith.model/1\"\n";
}

constexpr Mode kMode{.gain = 0.8, .hz = 260.0, .damping = 0.12};
const std::array<double, 3> kUp{-0.30, 0.42, -0.13};
const std::array<double, 3> kDown{0.16, -0.29, 0.12};

Base make_base(const std::string& name, Random& random, bool right_parameters) {
  auto off = [&](double value) { return right_parameters ? value : value * uniform(random, 0.92, 1.08); };
  Base b;
  b.name = name;
  b.effects = kAnywhere;
  if (name == "gain") {
    b.stages = {gain(6.92)};
    b.model =
        header() +
        fmt::format("[[block]]\ntype = \"gain\"\ngain = {}\noffset = 0.0\nfree = [\"gain\"]\n", off(6.92));
  } else if (name == "fixed_gain") {
    b.stages = {gain(2.0)};
    b.model = header() + "[[block]]\ntype = \"gain\"\ngain = 2.0\noffset = 0.0\n";
    b.effects = {"gain_error", "offset", "saturation", "amplifier_pole"};
  } else if (name == "resonator") {
    b.stages = {mode(kMode)};
    b.inner = kMode;
    b.model =
        header() +
        fmt::format(
            "[[block]]\ntype = \"resonator\"\ngain = {}\nnatural_frequency_hz = {}\ndamping_ratio = {}\n"
            "free = [\"gain\", \"natural_frequency_hz\", \"damping_ratio\"]\n",
            off(kMode.gain), off(kMode.hz), off(kMode.damping));
    b.effects.insert(b.effects.end(), {"cubic_stiffness", "quadratic_stiffness", "drag"});
  } else if (name == "stage") {
    b.stages = {lag(900.0), branches(kUp, kDown), mode({.gain = 1.0, .hz = 420.0, .damping = 0.3})};
    b.model =
        header() +
        fmt::format(
            "[[block]]\ntype = \"lowpass\"\ncorner_hz = {}\nfree = [\"corner_hz\"]\n"
            "[[block]]\ntype = \"polynomial_hysteresis\"\nascending = [-0.30, 0.42, -0.13]\n"
            "descending = [0.16, -0.29, 0.12]\n"
            "[[block]]\ntype = \"resonator\"\ngain = {}\nnatural_frequency_hz = {}\ndamping_ratio = {}\n"
            "free = [\"gain\", \"natural_frequency_hz\", \"damping_ratio\"]\n",
            off(900.0), off(1.0), off(420.0), off(0.3));
    b.band_hz = 60.0;
    b.one_sided = true;
    b.inner = {.gain = 1.0, .hz = 420.0, .damping = 0.3};
    b.effects = {"offset",       "drift",       "mains_hum",       "time_delay", "resonance",
                 "saturation",   "slew_limit",  "cubic_stiffness", "creep",      "multiplier_error",
                 "switch_delay", "sample_hold", "backlash"};
  } else if (name == "sections") {
    b.stages = {lead_lag(1.0, 60.0, 20.0), lead_lag(1.0, 100.0, 250.0), gain(1.5)};
    b.model = header() + fmt::format(
                             "[[block]]\ntype = \"pole_zero\"\ngain = 1.0\nzero_hz = 60.0\npole_hz = 20.0\n"
                             "[[block]]\ntype = \"pole_zero\"\ngain = 1.0\nzero_hz = 100.0\npole_hz = 250.0\n"
                             "[[block]]\ntype = \"gain\"\ngain = {}\nfree = [\"gain\"]\n",
                             off(1.5));
    b.effects = {"offset",
                 "drift",
                 "mains_hum",
                 "time_delay",
                 "resonance",
                 "saturation",
                 "slew_limit",
                 "dead_zone",
                 "quadratic_nonlinearity",
                 "cubic_nonlinearity",
                 "opamp_bandwidth",
                 "capacitor_mismatch",
                 "amplifier_pole",
                 "sample_hold"};
  } else {
    throw std::logic_error("no such base: " + name);
  }
  return b;
}

/// Where a stage goes: index into the stages before which it is inserted.
void put(std::vector<Stage>& stages, size_t at, Stage stage) {
  stages.insert(stages.begin() + static_cast<std::ptrdiff_t>(at), std::move(stage));
}

/// Adds the effect with some size; `scale` makes it larger or smaller where the later choice of noise cannot.
void hide(Base& b, std::vector<Stage>& stages, const std::string& effect, const std::vector<double>& u,
          Random& random) {
  const size_t n = stages.size();
  const bool front = (random() & 1U) != 0;
  const size_t at = front ? 0 : n;
  const double size = [&] {
    const auto y =
        play_chain(std::vector<Stage>(stages.begin(), stages.begin() + static_cast<std::ptrdiff_t>(at)), u);
    double largest = 0.0;
    for (double v : y) largest = std::max(largest, std::abs(v));
    return largest;
  }();
  auto U = [&](double a, double c) { return uniform(random, a, c); };
  if (effect == "gain_error")
    put(stages, at, gain(U(0.93, 0.97)));
  else if (effect == "offset")
    put(stages, at, gain(1.0, size * U(0.03, 0.08)));
  else if (effect == "drift")
    put(stages, n, ramp(size * U(0.1, 0.3)));
  else if (effect == "mains_hum")
    put(stages, n, tone(size * U(0.02, 0.05), (random() & 1U) != 0 ? 50.0 : 60.0, U(0, 6)));
  else if (effect == "time_delay")
    put(stages, n, delay(kStep * U(1.2, 6.0)));
  else if (effect == "amplifier_pole")
    put(stages, at, lag(b.band_hz * U(1.5, 6.0)));
  else if (effect == "resonance")
    put(stages, at,
        mode({.gain = 1, .hz = b.band_hz * U(1.2, 2.5), .damping = log_uniform(random, 0.03, 0.2)}));
  else if (effect == "slew_limit") {
    const auto y =
        play_chain(std::vector<Stage>(stages.begin(), stages.begin() + static_cast<std::ptrdiff_t>(at)), u);
    std::vector<double> slope;
    for (size_t i = 1; i < y.size(); ++i) slope.push_back(std::abs(y[i] - y[i - 1]) / kStep);
    std::sort(slope.begin(), slope.end());
    double rate = slope[static_cast<size_t>(0.9 * static_cast<double>(slope.size()))];
    if (slope.back() < 1.3 * rate) rate = 0.5 * slope.back();  // a triangle has one slope only
    rate = std::max(rate, 0.05 * slope.back());
    put(stages, at, slew(rate));
  } else if (effect == "saturation") {
    const double hi = size * U(0.6, 0.8);
    const double lo = b.one_sided ? -10 * size : ((random() & 1U) != 0 ? -hi : -size * U(0.6, 0.9));
    put(stages, at, curve([=](double v) { return std::clamp(v, lo, hi); }));
  } else if (effect == "dead_zone") {
    const double half = size * U(0.03, 0.1);
    put(stages, at, curve([=](double v) { return v > half ? v - half : v < -half ? v + half : 0.0; }));
  } else if (effect == "backlash")
    put(stages, at, play(size * U(0.04, 0.15)));
  else if (effect == "quadratic_nonlinearity") {
    const double c = U(0.05, 0.15) / size;
    put(stages, at, curve([=](double v) { return v + c * v * v; }));
  } else if (effect == "cubic_nonlinearity") {
    const double c = ((random() & 1U) != 0 ? -1 : 1) * U(0.05, 0.15) / (size * size);
    put(stages, at, curve([=](double v) { return v + c * v * v * v; }));
  } else if (effect == "hysteresis") {
    if ((random() & 1U) != 0)
      put(stages, at,
          plays({0.05 * size, 0.15 * size, 0.3 * size, 0.5 * size, 0.7 * size},
                {0.08, 0.07, 0.06, 0.05, 0.05}));
    else
      put(stages, at, bouc_wen(0.15 * size, 1.0 / size, 2.0 / size, 1.0 / size));
  } else if (effect == "asymmetric_hysteresis") {
    if ((random() & 1U) != 0) {
      put(stages, at,
          branches({-0.10, 0.14 / size, -0.05 / size / size}, {0.05, -0.10 / size, 0.04 / size / size}));
    } else {
      const double s = size;
      put(stages, at, [=](const Fine& v, double h) {
        Fine y(v);
        for (double& x : y) x = x / s + 0.5 * x * x / s / s;
        y = plays({0.05, 0.15, 0.3, 0.5, 0.7}, {0.10, 0.08, 0.07, 0.06, 0.05})(y, h);
        Fine out(v);
        for (size_t i = 0; i < v.size(); ++i)
          out[i] += s * 0.5 * (y[i] - (v[i] / s + 0.5 * v[i] * v[i] / s / s));
        return out;
      });
    }
  } else if (effect == "rate_dependence") {
    put(stages, at,
        fractional(1.0 / (2 * std::numbers::pi * b.band_hz * U(0.03, 0.08)), U(0.02, 0.05), -U(0.08, 0.2)));
  } else if (effect == "creep") {
    put(stages, at, creep({U(0.03, 0.06), U(0.03, 0.06), U(0.03, 0.06)}, {0.02, 0.08, 0.3}));
  } else if (effect == "sample_hold")
    put(stages, at, hold(b.band_hz * log_uniform(random, 4.0, 12.0)));
  else if (effect == "cubic_stiffness" || effect == "quadratic_stiffness" || effect == "drag") {
    Mode& m = b.inner;
    const auto y = play_chain(b.stages, u);
    double largest = 0.0;
    for (double v : y) largest = std::max(largest, std::abs(v));
    if (effect == "cubic_stiffness") m.cubic = U(0.05, 0.2) / largest / largest;
    if (effect == "quadratic_stiffness") m.quadratic = U(0.05, 0.15) / largest;
    if (effect == "drag") m.drag = U(0.5, 1.5) * m.damping / (largest * 2 * std::numbers::pi * m.hz) * 2.0;
    stages[b.name == "stage" ? 2 : 0] = mode(m);
  } else if (effect == "multiplier_error") {
    stages[1] = branches_by_multipliers(kUp, kDown, U(0.93, 0.97), U(-0.03, 0.03), U(-0.02, 0.02));
  } else if (effect == "switch_delay") {
    stages[1] = branches(kUp, kDown, kStep * U(8.0, 25.0));
  } else if (effect == "opamp_bandwidth") {
    // Inverting section: H / (1 + (1 + H) s / w_t).
    const double wt = b.band_hz * U(4.0, 12.0) * 2 * std::numbers::pi;
    const double z = 100.0 * 2 * std::numbers::pi;
    const double p = 250.0 * 2 * std::numbers::pi;
    stages[1] = [=](const Fine& v, double h) {  // (1+s/z)/((1+s/p) + s/wt((1+s/p)+(1+s/z))), states x, x'
      const double a2 = (1 / p + 1 / z) / wt;
      const double a1 = 1 / p + 2.0 / wt;
      Fine out(v.size());
      double x = 0.0;
      double d = 0.0;
      auto f = [&](double in, double X, double D) { return (in - X - a1 * D) / a2; };
      for (size_t i = 0; i < v.size(); ++i) {
        if (i > 0) {
          const double a = v[i - 1], c = v[i], m = 0.5 * (a + c);
          const double k1 = d, l1 = f(a, x, d);
          const double k2 = d + 0.5 * h * l1, l2 = f(m, x + 0.5 * h * k1, d + 0.5 * h * l1);
          const double k3 = d + 0.5 * h * l2, l3 = f(m, x + 0.5 * h * k2, d + 0.5 * h * l2);
          const double k4 = d + h * l3, l4 = f(c, x + h * k3, d + h * l3);
          x += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
          d += h / 6 * (l1 + 2 * l2 + 2 * l3 + l4);
        }
        out[i] = x + d / z;
      }
      return out;
    };
  } else if (effect == "capacitor_mismatch") {
    if ((random() & 1U) != 0)
      stages[0] = lead_lag(1.0, 60.0, 20.0 * U(1.03, 1.08));
    else
      stages[1] = lead_lag(1.0, 100.0 * U(1.03, 1.08), 250.0);
  } else
    throw std::logic_error("no such effect: " + effect);
}

Drive pick_drive(Random& random, bool holdout, bool memory, bool fast) {
  // Kinds a laboratory has; memory wants changing amplitudes, an edge wants steps.
  if (memory) return holdout ? Drive::noise : ((random() & 1U) != 0 ? Drive::triangle : Drive::multisine);
  const int pick = static_cast<int>(random() % (fast ? 3 : 4));
  if (!holdout)
    return pick == 0   ? Drive::multisine
           : pick == 1 ? Drive::sweep
           : pick == 2 ? Drive::multisine
                       : Drive::noise;
  return pick == 0 ? Drive::sweep : pick == 1 ? Drive::noise : pick == 2 ? Drive::steps : Drive::triangle;
}

constexpr size_t kRows = 6000;

std::vector<double> make_input(const Base& b, const std::string& effect, bool holdout, Random& random) {
  const bool memory =
      effect == "hysteresis" || effect == "asymmetric_hysteresis" || effect == "backlash" || b.one_sided;
  Drive kind = pick_drive(random, holdout, memory, b.name == "gain");
  if (b.name == "gain" && kind == Drive::steps) kind = Drive::sweep;
  auto u = drive(kind, kRows, b.band_hz, random);
  if (holdout) {
    const double scale = uniform(random, 0.8, 1.0);
    for (double& v : u) v *= scale;
  }
  if (b.one_sided) {
    for (double& v : u) v = 0.5 + 0.5 * v;
    // Come up from 0 gently: a record that starts at rest.
    for (size_t i = 0; i < 150; ++i) u[i] *= static_cast<double>(i) / 150.0;
  }
  return u;
}

void finish(Case& c, const std::vector<double>& train_u, const std::vector<double>& holdout_u,
            const std::vector<double>& train_y, const std::vector<double>& holdout_y, int colour,
            Random& random) {
  c.train.file = "train.csv";
  c.holdout.file = "holdout.csv";
  c.train.step_s = c.holdout.step_s = kStep;
  c.train.u = train_u;
  c.holdout.u = holdout_u;
  c.train.y = train_y;
  c.holdout.y = holdout_y;
  const auto e = make_noise(colour, train_y.size(), random);
  const auto f = make_noise(colour, holdout_y.size(), random);
  for (size_t i = 0; i < e.size(); ++i) c.train.y[i] += c.noise_rms * e[i];
  for (size_t i = 0; i < f.size(); ++i) c.holdout.y[i] += c.noise_rms * f[i];
}

/// rms of what `changed` adds beyond a rescaling of the base's output (a free gain would absorb that).
double difference(const std::vector<double>& base, const std::vector<double>& changed, bool free_gain) {
  double bb = 0.0;
  double bc = 0.0;
  for (size_t i = 0; i < base.size(); ++i) {
    bb += base[i] * base[i];
    bc += base[i] * changed[i];
  }
  const double g = free_gain && bb > 0.0 ? bc / bb : 1.0;
  std::vector<double> d(base.size());
  for (size_t i = 0; i < base.size(); ++i) d[i] = changed[i] - g * base[i];
  return rms(d);
}

Case make(Kind kind, const std::string& base, const std::vector<std::string>& effects, double ratio,
          std::uint64_t seed) {
  Random random(seed * 7919 + std::hash<std::string>{}(base + effects[0]));
  Base b = make_base(base, random, false);
  Case c;
  c.kind = kind;
  c.base = base;
  c.model = b.model;
  c.truth = effects;
  c.ratio = ratio;
  for (const auto& e : effects) c.name += (c.name.empty() ? "" : "+") + e;
  std::string memory;
  for (const auto& e : effects) {
    if (e == "hysteresis" || e == "asymmetric_hysteresis" || e == "backlash") memory = e;
  }
  const auto train_u = make_input(b, memory.empty() ? effects[0] : memory, false, random);
  const auto holdout_u = make_input(b, memory.empty() ? effects[0] : memory, true, random);
  auto stages = b.stages;
  const auto plain = play_chain(b.stages, train_u);
  double smallest = 1e300;
  // What changes a stage of the base goes first, while the stages still stand where the base put them.
  auto order = effects;
  std::stable_partition(order.begin(), order.end(), [](const std::string& e) {
    return e.ends_with("stiffness") || e == "drag" || e == "multiplier_error" || e == "switch_delay" ||
           e == "opamp_bandwidth" || e == "capacitor_mismatch";
  });
  for (const auto& e : order) {
    auto alone = b.stages;
    Random same = random;
    Base apart = b;
    apart.inner = base == "stage" ? Mode{.gain = 1.0, .hz = 420.0, .damping = 0.3} : kMode;
    hide(apart, alone, e, train_u, same);
    smallest = std::min(smallest, difference(plain, play_chain(alone, train_u), base != "fixed_gain"));
    hide(b, stages, e, train_u, random);
  }
  c.effect_rms = smallest;
  c.noise_rms = smallest / ratio;
  const int colour = static_cast<int>(random() % 3);
  finish(c, train_u, holdout_u, play_chain(stages, train_u), play_chain(stages, holdout_u), colour, random);
  return c;
}

}  // namespace

Case make_effect_case(const std::string& base, const std::string& effect, double ratio, std::uint64_t seed) {
  return make(Kind::effect, base, {effect}, ratio, seed);
}

Case make_pair_case(const std::string& base, const std::string& first, const std::string& second,
                    double ratio, std::uint64_t seed) {
  return make(Kind::pair, base, {first, second}, ratio, seed);
}

const std::vector<std::string>& control_kinds() {
  static const std::vector<std::string> kinds = {"white",   "coloured",    "red",
                                                 "ringing", "wrong_start", "parameters_off"};
  return kinds;
}

Case make_control_case(const std::string& base, const std::string& what, std::uint64_t seed) {
  Random random(seed * 104729 + std::hash<std::string>{}(base + what));
  Base b = make_base(base, random, what != "parameters_off");
  Case c;
  c.kind = Kind::control;
  c.base = base;
  c.model = b.model;
  c.name = what;
  const bool memory = b.one_sided;
  const auto train_u = make_input(b, memory ? "hysteresis" : "", false, random);
  const auto holdout_u = make_input(b, memory ? "hysteresis" : "", true, random);
  auto train_y = play_chain(b.stages, train_u);
  auto holdout_y = play_chain(b.stages, holdout_u);
  c.noise_rms = rms(train_y) * log_uniform(random, 0.002, 0.03);
  if (what == "wrong_start" && (base == "resonator" || base == "stage")) {
    // The resonator rings from somewhere else when the record begins.
    const double hz = base == "stage" ? 420.0 : kMode.hz;
    const double damping = base == "stage" ? 0.3 : kMode.damping;
    const double size = 20.0 * c.noise_rms;
    for (auto* y : {&train_y, &holdout_y}) {
      for (size_t i = 0; i < y->size(); ++i) {
        const double t = static_cast<double>(i) * kStep;
        const double w = 2 * std::numbers::pi * hz;
        (*y)[i] += size * std::exp(-damping * w * t) * std::cos(std::sqrt(1 - damping * damping) * w * t);
      }
    }
  } else if (what == "wrong_start" && base == "sections") {
    const double size = 20.0 * c.noise_rms;
    for (auto* y : {&train_y, &holdout_y}) {
      for (size_t i = 0; i < y->size(); ++i) {
        (*y)[i] += size * std::exp(-2 * std::numbers::pi * 20.0 * static_cast<double>(i) * kStep);
      }
    }
  }
  const int colour = what == "coloured"  ? 1
                     : what == "red"     ? 2
                     : what == "ringing" ? 3
                     : what == "white"   ? 0
                                         : static_cast<int>(random() % 3);
  finish(c, train_u, holdout_u, train_y, holdout_y, colour, random);
  return c;
}

const std::vector<std::string>& outside_kinds() {
  static const std::vector<std::string> kinds = {"one_sided_diode", "butterfly", "drop_out", "passing_tone"};
  return kinds;
}

Case make_outside_case(const std::string& base, const std::string& what, std::uint64_t seed) {
  Random random(seed * 15485863 + std::hash<std::string>{}(base + what));
  Base b = make_base(base, random, false);
  Case c;
  c.kind = Kind::outside;
  c.base = base;
  c.model = b.model;
  c.name = what;
  const bool memory = b.one_sided || what == "butterfly";
  const auto train_u = make_input(b, memory ? "hysteresis" : "", false, random);
  const auto holdout_u = make_input(b, memory ? "hysteresis" : "", true, random);
  auto stages = b.stages;
  const auto plain = play_chain(b.stages, train_u);
  double size = 0.0;
  for (double v : plain) size = std::max(size, std::abs(v));
  const double total = kRows * kStep;
  if (what == "one_sided_diode") {
    // Charges fast through the diode, leaks slowly: a lag whose speed depends on the direction.
    const double fast = b.band_hz * 8.0;
    const double slow = b.band_hz * 0.8;
    put(stages, stages.size(), [=](const Fine& v, double h) {
      Fine y(v.size());
      double x = 0.0;
      for (size_t i = 0; i < v.size(); ++i) {
        x += (v[i] - x) * (1.0 - std::exp(-2 * std::numbers::pi * (v[i] > x ? fast : slow) * h));
        y[i] = x;
      }
      return y;
    });
  } else if (what == "butterfly") {
    put(stages, stages.size(), [=](const Fine& v, double h) {
      Fine scaled(v);
      for (double& x : scaled) x /= size;
      Fine y = butterfly(0.2)(scaled, h);
      for (double& x : y) x *= size;
      return y;
    });
  } else if (what == "drop_out") {
    const double from = total * uniform(random, 0.2, 0.6);
    put(stages, stages.size(), drop_out(from, from + 0.05 * total, 0.3));
  } else if (what == "passing_tone") {
    const double from = total * uniform(random, 0.2, 0.5);
    put(stages, stages.size(),
        tone(0.05 * size, uniform(random, 130.0, 400.0), 1.0, from, from + 0.25 * total));
  }
  auto train_y = play_chain(stages, train_u);
  auto holdout_y = play_chain(stages, holdout_u);
  c.effect_rms = difference(plain, train_y, true);
  c.ratio = 10.0;
  c.noise_rms = c.effect_rms / c.ratio;
  finish(c, train_u, holdout_u, train_y, holdout_y, static_cast<int>(random() % 3), random);
  return c;
}

std::vector<std::pair<std::string, std::string>> effect_places() {
  std::vector<std::pair<std::string, std::string>> places;
  for (const char* name : {"gain", "fixed_gain", "resonator", "stage", "sections"}) {
    Random random(1);
    for (const auto& effect : make_base(name, random, true).effects) places.emplace_back(name, effect);
  }
  return places;
}

std::vector<Case> make_cases(const BatchOptions& options) {
  std::vector<Case> cases;
  const auto places = effect_places();
  std::uint64_t seed = options.seed;
  for (int repeat = 0; repeat < options.repeats; ++repeat) {
    for (double ratio : options.ratios) {
      for (const auto& [base, effect] : places)
        cases.push_back(make_effect_case(base, effect, ratio, ++seed));
    }
  }
  const auto effects = cases.size();
  const std::vector<std::string> bases = {"gain", "resonator", "stage", "sections"};
  const auto controls = static_cast<size_t>(options.controls * static_cast<double>(effects));
  for (size_t i = 0; i < controls; ++i) {
    cases.push_back(make_control_case(bases[i % bases.size()],
                                      control_kinds()[(i / bases.size()) % control_kinds().size()], ++seed));
  }
  const std::vector<std::array<const char*, 3>> pairs = {{"gain", "amplifier_pole", "cubic_nonlinearity"},
                                                         {"gain", "saturation", "mains_hum"},
                                                         {"resonator", "cubic_stiffness", "drag"},
                                                         {"resonator", "cubic_stiffness", "offset"},
                                                         {"resonator", "amplifier_pole", "saturation"},
                                                         {"gain", "hysteresis", "time_delay"},
                                                         {"resonator", "hysteresis", "mains_hum"},
                                                         {"sections", "capacitor_mismatch", "saturation"},
                                                         {"gain", "quadratic_nonlinearity", "drift"},
                                                         {"resonator", "time_delay", "cubic_nonlinearity"},
                                                         {"stage", "resonance", "mains_hum"},
                                                         {"sections", "offset", "time_delay"}};
  for (int i = 0; i < options.pairs; ++i) {
    const auto& p = pairs[static_cast<size_t>(i) % pairs.size()];
    const bool swap = (static_cast<size_t>(i) / pairs.size()) % 2 == 1;
    cases.push_back(make_pair_case(p[0], p[swap ? 2 : 1], p[swap ? 1 : 2], options.ratios.front(), ++seed));
  }
  for (int i = 0; i < options.outside; ++i) {
    const auto k = static_cast<size_t>(i);
    cases.push_back(make_outside_case(bases[(k / outside_kinds().size()) % 2],
                                      outside_kinds()[k % outside_kinds().size()], ++seed));
  }
  return cases;
}

}  // namespace hidden
