#pragma once

#include <array>
#include <cmath>
#include <complex>
#include <deque>
#include <functional>
#include <numbers>
#include <vector>

/// The other side of the gap tests: an independent little world that makes the "measured" records. Nothing
/// here uses src/chain or src/simulate. A record is computed on a grid 16 times finer than its samples, stage
/// after stage, with explicit Runge-Kutta steps, closed forms or plain loops.
namespace hidden {

using Fine = std::vector<double>;
/// What a stage does to a signal sampled every h seconds.
using Stage = std::function<Fine(const Fine&, double h)>;

inline constexpr int kOversampling = 16;

inline Stage gain(double g, double offset = 0.0) {
  return [=](const Fine& u, double) {
    Fine y(u);
    for (double& v : y) v = g * v + offset;
    return y;
  };
}

inline Stage curve(std::function<double(double)> f) {
  return [=](const Fine& u, double) {
    Fine y(u);
    for (double& v : y) v = f(v);
    return y;
  };
}

/// x' = (u - x) / tau, solved exactly for a u that is straight between grid points.
inline Stage lag(double corner_hz, double start = 0.0) {
  return [=](const Fine& u, double h) {
    const double tau = 1.0 / (2.0 * std::numbers::pi * corner_hz);
    const double e = std::exp(-h / tau);
    Fine y(u.size());
    double x = start;
    for (size_t i = 0; i < u.size(); ++i) {
      if (i > 0) {
        const double slope = (u[i] - u[i - 1]) / h;
        x = (x - u[i - 1] + slope * tau) * e + u[i] - slope * tau;
      }
      y[i] = x;
    }
    return y;
  };
}

/// g (s/z + 1)/(s/p + 1) = g (p/z + (1 - p/z) / (s/p + 1)).
inline Stage lead_lag(double g, double zero_hz, double pole_hz) {
  return [=](const Fine& u, double h) {
    const Fine low = lag(pole_hz)(u, h);
    Fine y(u.size());
    const double r = pole_hz / zero_hz;
    for (size_t i = 0; i < u.size(); ++i) y[i] = g * (r * u[i] + (1.0 - r) * low[i]);
    return y;
  };
}

struct Mode {
  double gain = 1.0;
  double hz = 300.0;
  double damping = 0.1;
  double quadratic = 0.0;
  double cubic = 0.0;
  double drag = 0.0;
  double start = 0.0;
};

/// y'' + 2 d w y' + w^2 (y + q y^2 + c y^3) + drag w |y'| y' = g w^2 u by the classical Runge-Kutta method.
inline Stage mode(Mode m) {
  return [=](const Fine& u, double h) {
    const double w = 2.0 * std::numbers::pi * m.hz;
    auto f = [&](double in, double y, double v) {
      return w * w * (m.gain * in - y * (1.0 + y * (m.quadratic + m.cubic * y))) - 2.0 * m.damping * w * v -
             m.drag * w * std::abs(v) * v;
    };
    Fine out(u.size());
    double y = m.start;
    double v = 0.0;
    for (size_t i = 0; i < u.size(); ++i) {
      if (i > 0) {
        const double a = u[i - 1];
        const double b = u[i];
        const double c = 0.5 * (a + b);
        const double k1 = v, l1 = f(a, y, v);
        const double k2 = v + 0.5 * h * l1, l2 = f(c, y + 0.5 * h * k1, v + 0.5 * h * l1);
        const double k3 = v + 0.5 * h * l2, l3 = f(c, y + 0.5 * h * k2, v + 0.5 * h * l2);
        const double k4 = v + h * l3, l4 = f(b, y + h * k3, v + h * l3);
        y += h / 6.0 * (k1 + 2 * k2 + 2 * k3 + k4);
        v += h / 6.0 * (l1 + 2 * l2 + 2 * l3 + l4);
      }
      out[i] = y;
    }
    return out;
  };
}

inline Stage delay(double seconds) {
  return [=](const Fine& u, double h) {
    Fine y(u.size());
    for (size_t i = 0; i < u.size(); ++i) {
      const double at = static_cast<double>(i) - seconds / h;
      if (at <= 0.0) {
        y[i] = at > -1e-9 ? u[0] : 0.0;
        if (at < 0.0 && u[0] != 0.0) y[i] = 0.0;
        continue;
      }
      const auto k = static_cast<size_t>(at);
      const double part = at - static_cast<double>(k);
      y[i] = k + 1 < u.size() ? (1.0 - part) * u[k] + part * u[k + 1] : u[k];
    }
    return y;
  };
}

inline Stage slew(double rate) {
  return [=](const Fine& u, double h) {
    Fine y(u.size());
    double x = 0.0;
    for (size_t i = 0; i < u.size(); ++i) {
      const double step = rate * h;
      x += std::clamp(u[i] - x, -step, step);
      y[i] = x;
    }
    return y;
  };
}

inline Fine play_of(const Fine& u, double half) {
  Fine y(u.size());
  double x = 0.0;
  for (size_t i = 0; i < u.size(); ++i) {
    x = std::max(u[i] - half, std::min(u[i] + half, x));
    y[i] = x;
  }
  return y;
}

inline Stage play(double width) {
  return [=](const Fine& u, double) { return play_of(u, 0.5 * width); };
}

/// u + sum of weighted plays (Prandtl-Ishlinskii).
inline Stage plays(std::vector<double> radius, std::vector<double> weight) {
  return [=](const Fine& u, double) {
    Fine y(u);
    for (size_t k = 0; k < radius.size(); ++k) {
      const Fine p = play_of(u, radius[k]);
      for (size_t i = 0; i < u.size(); ++i) y[i] += weight[k] * p[i];
    }
    return y;
  };
}

/// Bouc-Wen: y = u + d z, z' = A u' - beta |u'| |z|^(n-1) z - gamma u' |z|^n, n = 1.
inline Stage bouc_wen(double d, double a, double beta, double gamma) {
  return [=](const Fine& u, double) {
    Fine y(u);
    double z = 0.0;
    for (size_t i = 1; i < u.size(); ++i) {
      const double du = u[i] - u[i - 1];
      const double dz = a * du - beta * std::abs(du) * z - gamma * du * std::abs(z);
      const double zm = z + 0.5 * dz;
      z += a * du - beta * std::abs(du) * zm - gamma * du * std::abs(zm);
      y[i] += d * z;
    }
    return y;
  };
}

/// u + a1 u + a2 u^2 + a3 u^3 with other coefficients while u rises than while it falls; the switch may act
/// late.
inline Stage branches(std::array<double, 3> up, std::array<double, 3> down, double late_s = 0.0) {
  return [=](const Fine& u, double h) {
    Fine y(u.size());
    std::vector<char> rising(u.size(), 1);
    for (size_t i = 1; i < u.size(); ++i) {
      rising[i] = u[i] > u[i - 1] ? 1 : u[i] < u[i - 1] ? 0 : rising[i - 1];
    }
    const auto late = static_cast<size_t>(late_s / h + 0.5);
    for (size_t i = 0; i < u.size(); ++i) {
      const auto& a = rising[i >= late ? i - late : 0] ? up : down;
      y[i] = u[i] + u[i] * (a[0] + u[i] * (a[1] + u[i] * a[2]));
    }
    return y;
  };
}

/// The same made of multipliers whose product is scale (x + feed)(y): powers are x, m(x,x), m(m(x,x),x).
inline Stage branches_by_multipliers(std::array<double, 3> up, std::array<double, 3> down, double scale,
                                     double feed, double offset) {
  return [=](const Fine& u, double) {
    Fine y(u.size());
    bool rising = true;
    for (size_t i = 0; i < u.size(); ++i) {
      if (i > 0 && u[i] != u[i - 1]) rising = u[i] > u[i - 1];
      const auto& a = rising ? up : down;
      const double square = scale * (u[i] + feed) * u[i] + offset;
      const double cube = scale * (square + feed) * u[i] + offset;
      y[i] = u[i] + a[0] * u[i] + a[1] * square + a[2] * cube;
    }
    return y;
  };
}

inline Stage creep(std::vector<double> gains, std::vector<double> tau) {
  return [=](const Fine& u, double h) {
    Fine y(u);
    for (size_t k = 0; k < tau.size(); ++k) {
      const Fine low = lag(1.0 / (2.0 * std::numbers::pi * tau[k]))(u, h);
      for (size_t i = 0; i < u.size(); ++i) y[i] += gains[k] * low[i];
    }
    return y;
  };
}

/// ((lambda s + 1)/(x lambda s + 1))^beta by a lattice of 12 first-order sections (Oustaloup's placement).
inline Stage fractional(double lambda, double x, double beta) {
  return [=](const Fine& u, double h) {
    const int n = 12;
    const double low = 1.0 / lambda;
    const double high = 1.0 / (x * lambda);
    Fine y(u);
    for (int k = 0; k < n; ++k) {
      const double centre = low * std::pow(high / low, (k + 0.5) / n);
      const double spread = std::pow(high / low, 0.5 * beta / n);
      y = lead_lag(1.0, centre / spread / (2 * std::numbers::pi), centre * spread / (2 * std::numbers::pi))(
          y, h);
    }
    return y;
  };
}

inline Stage hold(double clock_hz) {
  return [=](const Fine& u, double h) {
    Fine y(u.size());
    double held = 0.0;
    long last = -1;
    for (size_t i = 0; i < u.size(); ++i) {
      const auto tick = static_cast<long>(std::floor(static_cast<double>(i) * h * clock_hz + 1e-9));
      if (tick != last) {
        held = u[i];
        last = tick;
      }
      y[i] = held;
    }
    return y;
  };
}

inline Stage tone(double amplitude, double hz, double phase, double from_s = 0.0, double to_s = 1e9) {
  return [=](const Fine& u, double h) {
    Fine y(u);
    for (size_t i = 0; i < u.size(); ++i) {
      const double t = static_cast<double>(i) * h;
      if (t >= from_s && t <= to_s) y[i] += amplitude * std::sin(2 * std::numbers::pi * hz * t + phase);
    }
    return y;
  };
}

inline Stage ramp(double rate) {
  return [=](const Fine& u, double h) {
    Fine y(u);
    for (size_t i = 0; i < u.size(); ++i) y[i] += rate * static_cast<double>(i) * h;
    return y;
  };
}

/// The branch curves cross: a loop with two wings that narrows to nothing in the middle and opens at both
/// ends in opposite senses (butterfly), which no memory of the catalogue makes.
inline Stage butterfly(double size) {
  return [=](const Fine& u, double) {
    const Fine p = play_of(u, 0.25);
    Fine y(u);
    for (size_t i = 0; i < u.size(); ++i) y[i] += size * std::abs(p[i]);
    return y;
  };
}

inline Stage drop_out(double from_s, double to_s, double left) {
  return [=](const Fine& u, double h) {
    Fine y(u);
    for (size_t i = 0; i < u.size(); ++i) {
      const double t = static_cast<double>(i) * h;
      if (t >= from_s && t <= to_s) y[i] *= left;
    }
    return y;
  };
}

}  // namespace hidden
