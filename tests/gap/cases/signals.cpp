#include "gap/cases/signals.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hidden {
namespace {

void scale_to_one(std::vector<double>& u) {
  const double size = largest(u);
  for (double& v : u) v /= size;
}

/// Levels that last a while, joined by straight edges of `edge` samples.
template <class NextLevel, class NextLength>
std::vector<double> levels(std::size_t n, std::size_t edge, NextLevel level, NextLength length) {
  std::vector<double> u(n, 0.0);
  double from = 0.0;
  double to = 0.0;
  std::size_t since = edge;
  std::size_t left = 1 + n / 100;
  for (std::size_t i = 0; i < n; ++i) {
    if (left-- == 0) {
      from = u[i - 1];
      to = level();
      since = 0;
      left = std::max<std::size_t>(edge, length());
    }
    since = std::min(since + 1, edge);
    u[i] = from + (to - from) * static_cast<double>(since) / static_cast<double>(edge);
  }
  return u;
}

}  // namespace

double rms(const std::vector<double>& v) {
  double sum = 0.0;
  for (double x : v) sum += x * x;
  return std::sqrt(sum / static_cast<double>(v.size()));
}

double largest(const std::vector<double>& v) {
  double size = 0.0;
  for (double x : v) size = std::max(size, std::abs(x));
  return size;
}

// A table of drives, each of which draws what it needs from the seed.
std::vector<double> make_drive(Drive kind, std::size_t n, double step_s, double band_hz, Random& random) {
  std::vector<double> u(n, 0.0);
  const double total = static_cast<double>(n) * step_s;
  const auto time = [&](std::size_t i) { return static_cast<double>(i) * step_s; };
  switch (kind) {
    case Drive::multisine: {
      const auto periods = static_cast<std::size_t>(uniform(random, 2.0, 7.0));
      const std::size_t rows = n / periods;
      const int top = std::max(9, static_cast<int>(band_hz * static_cast<double>(rows) * step_s));
      const int each = coin(random) ? 2 : 1;
      for (int k = 1; k <= top; k += each) {
        const double phase = uniform(random, 0.0, kTwoPi);
        for (std::size_t i = 0; i < rows; ++i)
          u[i] += std::sin(kTwoPi * k * static_cast<double>(i) / static_cast<double>(rows) + phase);
      }
      for (std::size_t i = rows; i < n; ++i) u[i] = u[i - rows];
      scale_to_one(u);
      break;
    }
    case Drive::triangle: {
      double phase = 0.0;
      const double slow = uniform(random, 0.05, 0.12);
      const double fast = uniform(random, 0.2, 0.35);
      for (std::size_t i = 0; i < n; ++i) {
        const double part = static_cast<double>(i) / static_cast<double>(n);
        const double saw = phase - std::floor(phase);
        const double amplitude = 0.35 + 0.65 * std::abs(std::sin(std::numbers::pi * 3.0 * part));
        u[i] = amplitude * (saw < 0.25 ? 4 * saw : saw < 0.75 ? 2 - 4 * saw : 4 * saw - 4);
        phase += band_hz * (part < 0.5 ? slow : fast) * step_s;
      }
      break;
    }
    case Drive::sweep: {
      const double low = band_hz * uniform(random, 0.02, 0.06);
      const double k = std::log(band_hz / low) / total;
      const double swells = uniform(random, 2.0, 8.0);
      for (std::size_t i = 0; i < n; ++i) {
        const double t = time(i);
        u[i] = (0.6 + 0.4 * std::sin(kTwoPi * swells * t / total)) *
               std::sin(kTwoPi * low * (std::exp(k * t) - 1.0) / k);
      }
      break;
    }
    case Drive::steps: {
      const auto edge = static_cast<std::size_t>(uniform(random, 2.0, 8.0));
      u = levels(
          n, edge, [&] { return uniform(random, -1.0, 1.0); },
          [&] { return static_cast<std::size_t>(uniform(random, 1.5, 8.0) / band_hz / step_s); });
      scale_to_one(u);
      break;
    }
    case Drive::noise: {
      const double a = std::exp(-kTwoPi * band_hz * 0.5 * step_s);
      double x = 0.0;
      double y = 0.0;
      for (double& v : u) {
        x = a * x + (1 - a) * normal(random);
        v = y = a * y + (1 - a) * x;
      }
      scale_to_one(u);
      break;
    }
    case Drive::two_tone: {
      const double slow = band_hz * uniform(random, 0.05, 0.15);
      const double fast = band_hz * uniform(random, 0.4, 0.9);
      const double share = uniform(random, 0.35, 0.65);
      for (std::size_t i = 0; i < n; ++i)
        u[i] = share * std::sin(kTwoPi * slow * time(i)) + (1.0 - share) * std::sin(kTwoPi * fast * time(i));
      scale_to_one(u);
      break;
    }
    case Drive::binary: {
      const auto edge = static_cast<std::size_t>(uniform(random, 2.0, 8.0));
      double level = -1.0;
      u = levels(
          n, edge, [&] { return level = -level; },
          [&] { return static_cast<std::size_t>(log_uniform(random, 0.7, 6.0) / band_hz / step_s); });
      break;
    }
    case Drive::modulated_sine: {
      const double hz = band_hz * uniform(random, 0.1, 0.4);
      const double swells = uniform(random, 2.0, 5.0);
      const double drift = uniform(random, 0.0, 0.3);
      for (std::size_t i = 0; i < n; ++i) {
        const double part = static_cast<double>(i) / static_cast<double>(n);
        u[i] = (0.55 - 0.45 * std::cos(kTwoPi * swells * part)) * std::sin(kTwoPi * hz * time(i)) +
               drift * std::sin(kTwoPi * part);
      }
      scale_to_one(u);
      break;
    }
  }
  return u;
}

Drive pick_drive(Random& random, bool holdout, bool memory) {
  using enum Drive;
  if (memory)
    return holdout ? pick<Drive>(random, {noise, triangle, modulated_sine})
                   : pick<Drive>(random, {triangle, multisine, modulated_sine});
  return holdout ? pick<Drive>(random, {sweep, noise, steps, triangle, two_tone})
                 : pick<Drive>(random, {multisine, multisine, sweep, noise, binary, steps});
}

std::vector<double> make_noise(Colour colour, std::size_t n, Random& random) {
  std::vector<double> e(n);
  double x = 0.0;
  double x2 = 0.0;
  for (double& v : e) {
    const double w = normal(random);
    if (colour == Colour::white) v = w;
    if (colour == Colour::coloured) v = x = 0.9 * x + w;
    if (colour == Colour::red) v = x = 0.99 * x + w;
    if (colour == Colour::ringing) {
      const double next = 1.8 * x - 0.9 * x2 + w;
      x2 = x;
      v = x = next;
    }
  }
  const double size = rms(e);
  for (double& v : e) v /= size;
  return e;
}

double difference(const Outputs& base, const Outputs& changed, bool free_gain) {
  double bb = 0.0;
  double bc = 0.0;
  for (std::size_t r = 0; r < base.size(); ++r) {
    for (std::size_t i = 0; i < base[r].size(); ++i) {
      bb += base[r][i] * base[r][i];
      bc += base[r][i] * changed[r][i];
    }
  }
  const double g = free_gain && bb > 0.0 ? bc / bb : 1.0;
  double sum = 0.0;
  std::size_t count = 0;
  for (std::size_t r = 0; r < base.size(); ++r) {
    for (std::size_t i = 0; i < base[r].size(); ++i) {
      const double d = changed[r][i] - g * base[r][i];
      sum += d * d;
    }
    count += base[r].size();
  }
  return std::sqrt(sum / static_cast<double>(count));
}

void finish(Case& c, double step_s, const Outputs& train_u, const Outputs& train_y, const Outputs& holdout_u,
            const Outputs& holdout_y, Colour colour, Random& random) {
  const auto records = [&](const Outputs& u, const Outputs& y, const char* name) {
    std::vector<bodesmith::TimeRecord> out;
    for (std::size_t r = 0; r < u.size(); ++r) {
      bodesmith::TimeRecord record;
      record.file = fmt::format("{}_{}.csv", name, r + 1);
      record.step_s = step_s;
      record.u = u[r];
      record.y = y[r];
      const auto e = make_noise(colour, y[r].size(), random);
      for (std::size_t i = 0; i < e.size(); ++i) record.y[i] += c.noise_rms * e[i];
      out.push_back(std::move(record));
    }
    return out;
  };
  c.train = records(train_u, train_y, "train");
  c.holdout = records(holdout_u, holdout_y, "holdout");
}

}  // namespace hidden
