#include "gap/cases/time_base.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

namespace hidden {
namespace {

Fine refine(const std::vector<double>& u) {
  Fine fine((u.size() - 1) * kOversampling + 1);
  for (size_t i = 0; i + 1 < u.size(); ++i) {
    for (int k = 0; k < kOversampling; ++k)
      fine[i * kOversampling + static_cast<size_t>(k)] = u[i] + (u[i + 1] - u[i]) * k / kOversampling;
  }
  fine.back() = u.back();
  return fine;
}

void put(std::vector<Stage>& stages, size_t at, Stage stage) {
  stages.insert(stages.begin() + static_cast<std::ptrdiff_t>(at), std::move(stage));
}

/// H / (1 + (1 + |g| (1 + s/z)/(1 + s/p)) s/wt): a section around an op-amp of gain-bandwidth wt, by
/// Runge-Kutta.
Stage slow_section(Section s, double wt) {
  return [=](const Fine& v, double h) {
    const double z = kTwoPi * s.zero_hz;
    const double p = kTwoPi * s.pole_hz;
    const double a2 = (1 / p + s.gain / z) / wt;
    const double a1 = 1 / p + (1.0 + s.gain) / wt;
    const auto f = [&](double in, double x, double d) { return (in - x - a1 * d) / a2; };
    Fine out(v.size());
    double x = 0.0;
    double d = 0.0;
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
      out[i] = s.gain * (x + d / z);
    }
    return out;
  };
}

}  // namespace

std::string resonator_text(double gain, double hz, double damping) {
  return fmt::format(
      "[[block]]\ntype = \"resonator\"\ngain = {}\nnatural_frequency_hz = {}\ndamping_ratio = {}\n"
      "free = [\"gain\", \"natural_frequency_hz\", \"damping_ratio\"]\n",
      gain, hz, damping);
}

std::string gain_text(double gain) {
  return fmt::format("[[block]]\ntype = \"gain\"\ngain = {}\noffset = 0.0\nfree = [\"gain\"]\n", gain);
}

std::vector<double> play_chain(const std::vector<Stage>& stages, const std::vector<double>& u,
                               double step_s) {
  Fine fine = refine(u);
  for (const auto& stage : stages) fine = stage(fine, step_s / kOversampling);
  std::vector<double> y(u.size());
  for (size_t i = 0; i < u.size(); ++i) y[i] = fine[i * kOversampling];
  return y;
}

// One table of bases, one of effects, one of outsiders: each entry draws what it needs from the seed, and is
// read on its own.

TimeBase make_time_base(const std::string& name, Random& random, bool right, std::size_t rows,
                        double min_duration_s) {
  const auto off = [&](double value, double part) {
    return right ? value : value * uniform(random, 1.0 - part, 1.0 + part);
  };
  TimeBase b;
  b.name = name;
  b.step_s = std::max(log_uniform(random, 2e-5, 4e-4), min_duration_s / static_cast<double>(rows));
  b.band_hz = uniform(random, 0.015, 0.045) / b.step_s;
  b.amplitude = log_uniform(random, 0.3, 5.0);
  b.model = "schema = \"bodesmith.model/1\"\n";
  if (name == "gain") {
    const double g = log_uniform(random, 0.2, 20.0);
    b.stages = {gain(g)};
    b.model += gain_text(off(g, 0.15));
  } else if (name == "fixed_gain") {
    const double g = log_uniform(random, 0.2, 20.0);
    b.stages = {gain(g)};
    b.model += fmt::format("[[block]]\ntype = \"gain\"\ngain = {}\noffset = 0.0\n", g);
    b.free_gain = false;
  } else if (name == "resonator") {
    b.inner = {.gain = log_uniform(random, 0.3, 3.0),
               .hz = b.band_hz * uniform(random, 0.6, 1.1),
               .damping = log_uniform(random, 0.04, 0.4)};
    b.stages = {mode(b.inner)};
    b.slowest_hz = b.inner.hz * b.inner.damping;
    b.model += resonator_text(off(b.inner.gain, 0.15), off(b.inner.hz, 0.08), off(b.inner.damping, 0.15));
  } else if (name == "stage") {
    b.band_hz *= 0.25;
    b.amplitude = 1.0;
    b.one_sided = true;
    const double corner = b.band_hz * uniform(random, 10.0, 20.0);
    for (auto& a : {&b.up, &b.down}) {
      const double sign = a == &b.up ? -1.0 : 1.0;
      *a = {sign * uniform(random, 0.15, 0.35), -sign * uniform(random, 0.25, 0.6),
            sign * uniform(random, 0.1, 0.25)};
    }
    b.inner = {.gain = log_uniform(random, 0.5, 2.0),
               .hz = b.band_hz * uniform(random, 5.0, 9.0),
               .damping = uniform(random, 0.1, 0.5)};
    b.inner_at = 2;
    b.slowest_hz = b.inner.hz * b.inner.damping;
    b.stages = {lag(corner), branches(b.up, b.down), mode(b.inner)};
    b.model += fmt::format(
        "[[block]]\ntype = \"lowpass\"\ncorner_hz = {}\nfree = [\"corner_hz\"]\n"
        "[[block]]\ntype = \"polynomial_hysteresis\"\nascending = [{}, {}, {}]\ndescending = [{}, {}, {}]\n",
        off(corner, 0.15), b.up[0], b.up[1], b.up[2], b.down[0], b.down[1], b.down[2]);
    b.model += resonator_text(off(b.inner.gain, 0.15), off(b.inner.hz, 0.08), off(b.inner.damping, 0.15));
  } else if (name == "sections") {
    const int count = static_cast<int>(uniform(random, 2.0, 4.99));
    double slowest = 1e300;
    for (int i = 0; i < count; ++i) {
      const double centre = b.band_hz * log_uniform(random, 0.12, 0.9);
      const double spread = std::sqrt(log_uniform(random, 1.5, 6.0));
      const bool lead = coin(random);
      const Section s{coin(random) ? 1.0 : log_uniform(random, 0.5, 2.0),
                      lead ? centre / spread : centre * spread, lead ? centre * spread : centre / spread};
      b.sections.push_back(s);
      b.stages.push_back(lead_lag(s.gain, s.zero_hz, s.pole_hz));
      b.model += fmt::format("[[block]]\ntype = \"pole_zero\"\ngain = {}\nzero_hz = {}\npole_hz = {}\n",
                             s.gain, s.zero_hz, s.pole_hz);
      slowest = std::min(slowest, s.pole_hz);
    }
    b.slowest_hz = slowest;
    const double g = log_uniform(random, 0.5, 4.0);
    b.stages.push_back(gain(g));
    b.model += gain_text(off(g, 0.15));
  } else if (name == "curve") {
    b.powers = {uniform(random, -0.4, 0.4) / b.amplitude,
                uniform(random, 0.15, 0.4) / b.amplitude / b.amplitude};
    const auto c = b.powers;
    b.stages = {curve([=](double x) { return x * (1.0 + x * (c[0] + x * c[1])); })};
    b.model +=
        fmt::format("[[block]]\ntype = \"polynomial\"\ncoefficients = [0.0, 1.0, {}, {}]\n", c[0], c[1]);
    const double g = log_uniform(random, 0.5, 4.0);
    b.stages.push_back(gain(g));
    b.model += gain_text(off(g, 0.15));
  } else {
    throw std::logic_error("no such base: " + name);
  }
  return b;
}

bool changes_a_stage(const std::string& e) {
  return e.ends_with("stiffness") || e == "drag" || e == "multiplier_error" || e == "switch_delay" ||
         e == "opamp_bandwidth" || e == "capacitor_mismatch";
}

void hide(TimeBase& b, std::vector<Stage>& stages, const std::string& effect, const std::vector<double>& u,
          Random& random) {
  const size_t n = stages.size();
  const bool front = coin(random);
  const size_t at = front ? 0 : n;
  const auto signal = play_chain(
      std::vector<Stage>(stages.begin(), stages.begin() + static_cast<std::ptrdiff_t>(at)), u, b.step_s);
  const double size = largest(signal);
  const double step = b.step_s;
  const double total = step * static_cast<double>(u.size());
  const auto U = [&](double a, double c) { return uniform(random, a, c); };
  const auto sign = [&] { return coin(random) ? -1.0 : 1.0; };
  if (effect == "gain_error")
    put(stages, at, gain(1.0 + sign() * U(0.02, 0.08)));
  else if (effect == "offset")
    put(stages, at, gain(1.0, sign() * size * U(0.02, 0.08)));
  else if (effect == "drift")
    put(stages, n, ramp(sign() * largest(play_chain(stages, u, step)) * U(0.05, 0.2) / total));
  else if (effect == "mains_hum")
    put(stages, n,
        tone(largest(play_chain(stages, u, step)) * U(0.02, 0.05), coin(random) ? 50.0 : 60.0, U(0, 6)));
  else if (effect == "time_delay")
    put(stages, at, delay(step * log_uniform(random, 0.6, 8.0)));
  else if (effect == "amplifier_pole")
    put(stages, at, lag(b.band_hz * log_uniform(random, 1.0, 6.0)));
  else if (effect == "resonance")
    put(stages, at,
        mode({.gain = 1, .hz = b.band_hz * U(1.0, 2.5), .damping = log_uniform(random, 0.03, 0.3)}));
  else if (effect == "slew_limit") {
    std::vector<double> slope;
    for (size_t i = 1; i < signal.size(); ++i) slope.push_back(std::abs(signal[i] - signal[i - 1]) / step);
    std::sort(slope.begin(), slope.end());
    double rate = slope[static_cast<size_t>(U(0.8, 0.95) * static_cast<double>(slope.size()))];
    if (slope.back() < 1.3 * rate) rate = U(0.4, 0.8) * slope.back();  // a triangle has one slope only
    put(stages, at, slew(std::max(rate, 0.05 * slope.back())));
  } else if (effect == "saturation") {
    const auto [low, high] = std::minmax_element(signal.begin(), signal.end());
    const double hi = *high * U(0.6, 0.85);
    double lo = b.one_sided || coin(random) ? -10 * size : *low * U(0.6, 0.85);
    put(stages, at, curve([=](double v) { return std::clamp(v, lo, hi); }));
  } else if (effect == "dead_zone") {
    const double half = size * U(0.03, 0.1);
    put(stages, at, curve([=](double v) { return v > half ? v - half : v < -half ? v + half : 0.0; }));
  } else if (effect == "backlash")
    put(stages, at, play(size * U(0.04, 0.15)));
  else if (effect == "quadratic_nonlinearity") {
    const double c = sign() * U(0.05, 0.15) / size;
    put(stages, at, curve([=](double v) { return v + c * v * v; }));
  } else if (effect == "cubic_nonlinearity") {
    const double c = sign() * U(0.05, 0.15) / (size * size);
    put(stages, at, curve([=](double v) { return v + c * v * v * v; }));
  } else if (effect == "hysteresis") {
    if (coin(random))
      put(stages, at,
          plays({0.05 * size, 0.15 * size, 0.3 * size, 0.5 * size, 0.7 * size},
                {U(0.05, 0.1), U(0.05, 0.08), U(0.04, 0.08), U(0.03, 0.06), U(0.03, 0.06)}));
    else
      put(stages, at, bouc_wen(U(0.1, 0.2) * size, 1.0 / size, U(1.5, 3.0) / size, U(0.5, 1.5) / size));
  } else if (effect == "asymmetric_hysteresis") {
    if (coin(random)) {
      const double k = U(0.7, 1.3);
      put(stages, at,
          branches({-0.10 * k, 0.14 * k / size, -0.05 * k / size / size},
                   {0.05 * k, -0.10 * k / size, 0.04 * k / size / size}));
    } else {
      const double s = size;
      const double bend = U(0.3, 0.7);
      put(stages, at, [=](const Fine& v, double h) {
        Fine y(v);
        for (double& x : y) x = x / s + bend * x * x / s / s;
        y = plays({0.05, 0.15, 0.3, 0.5, 0.7}, {0.10, 0.08, 0.07, 0.06, 0.05})(y, h);
        Fine out(v);
        for (size_t i = 0; i < v.size(); ++i)
          out[i] += s * 0.5 * (y[i] - (v[i] / s + bend * v[i] * v[i] / s / s));
        return out;
      });
    }
  } else if (effect == "rate_dependence") {
    put(stages, at,
        fractional(1.0 / (kTwoPi * b.band_hz * U(0.03, 0.08)), U(0.02, 0.05), sign() * U(0.08, 0.2)));
  } else if (effect == "creep") {
    const double k = U(0.7, 1.4);
    put(stages, at,
        creep({U(0.03, 0.06), U(0.03, 0.06), U(0.03, 0.06)},
              {0.033 * k * total, 0.13 * k * total, 0.5 * k * total}));
  } else if (effect == "sample_hold")
    put(stages, at, hold(b.band_hz * log_uniform(random, 4.0, 12.0)));
  else if (effect == "cubic_stiffness" || effect == "quadratic_stiffness" || effect == "drag") {
    Mode& m = b.inner;
    const double reach = largest(play_chain(b.stages, u, step));
    if (effect == "cubic_stiffness") m.cubic = U(0.05, 0.2) / reach / reach;
    if (effect == "quadratic_stiffness") m.quadratic = sign() * U(0.05, 0.15) / reach;
    if (effect == "drag") m.drag = U(0.5, 1.5) * m.damping / (reach * kTwoPi * m.hz) * 2.0;
    stages[b.inner_at] = mode(m);
  } else if (effect == "multiplier_error") {
    const double scale = 1.0 + sign() * U(0.02, 0.07);
    if (b.name == "curve") {
      const auto c = b.powers;
      const double feed = U(-0.04, 0.04) * b.amplitude;
      const double offset = U(-0.02, 0.02) * b.amplitude * b.amplitude;
      stages[0] = curve([=](double x) {
        const double square = scale * (x + feed) * x + offset;
        return x + c[0] * square + c[1] * (scale * (square + feed) * x + offset);
      });
    } else {
      stages[1] = branches_by_multipliers(b.up, b.down, scale, U(-0.03, 0.03), U(-0.02, 0.02));
    }
  } else if (effect == "switch_delay") {
    stages[1] = branches(b.up, b.down, step * log_uniform(random, 4.0, 30.0));
  } else if (effect == "opamp_bandwidth") {
    const auto k = static_cast<size_t>(U(0.0, static_cast<double>(b.sections.size())));
    stages[k] = slow_section(b.sections[k], b.band_hz * log_uniform(random, 4.0, 20.0) * kTwoPi);
  } else if (effect == "capacitor_mismatch") {
    const auto k = static_cast<size_t>(U(0.0, static_cast<double>(b.sections.size())));
    Section s = b.sections[k];
    (coin(random) ? s.zero_hz : s.pole_hz) *= 1.0 + sign() * log_uniform(random, 0.03, 0.2);
    stages[k] = lead_lag(s.gain, s.zero_hz, s.pole_hz);
  } else
    throw std::logic_error("no such effect: " + effect);
}

void hide_outsider(const TimeBase& b, std::vector<Stage>& stages, const std::string& what,
                   const std::vector<double>& u, Random& random) {
  const double size = largest(play_chain(b.stages, u, b.step_s));
  const double total = b.step_s * static_cast<double>(u.size());
  if (what == "one_sided_diode") {
    // Charges fast through the diode, leaks slowly: a lag whose speed depends on the direction.
    const double fast = b.band_hz * uniform(random, 6.0, 12.0);
    const double slow = b.band_hz * uniform(random, 0.5, 1.0);
    put(stages, stages.size(), [=](const Fine& v, double h) {
      Fine y(v.size());
      double x = 0.0;
      for (size_t i = 0; i < v.size(); ++i) {
        x += (v[i] - x) * (1.0 - std::exp(-kTwoPi * (v[i] > x ? fast : slow) * h));
        y[i] = x;
      }
      return y;
    });
  } else if (what == "butterfly") {
    const double part = uniform(random, 0.1, 0.3);
    put(stages, stages.size(), [=](const Fine& v, double h) {
      Fine scaled(v);
      for (double& x : scaled) x /= size;
      Fine y = butterfly(part)(scaled, h);
      for (double& x : y) x *= size;
      return y;
    });
  } else if (what == "drop_out") {
    const double from = total * uniform(random, 0.2, 0.6);
    put(stages, stages.size(),
        drop_out(from, from + uniform(random, 0.02, 0.08) * total, uniform(random, 0.0, 0.5)));
  } else if (what == "passing_tone") {
    const double from = total * uniform(random, 0.2, 0.5);
    put(stages, stages.size(),
        tone(0.05 * size, b.band_hz * uniform(random, 0.4, 1.6), 1.0, from, from + 0.25 * total));
  } else if (what == "level_jump") {
    const double from = total * uniform(random, 0.35, 0.65);
    const double height = size * uniform(random, 0.03, 0.08);
    put(stages, stages.size(), [=](const Fine& v, double h) {
      Fine y(v);
      for (size_t i = 0; i < v.size(); ++i) y[i] += static_cast<double>(i) * h >= from ? height : 0.0;
      return y;
    });
  } else
    throw std::logic_error("no such outsider: " + what);
}

}  // namespace hidden
