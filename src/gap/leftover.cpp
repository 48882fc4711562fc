#include "gap/leftover.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "signal/periodogram.hpp"
#include "signal/statistics.hpp"

namespace bodesmith::gap {
namespace {

struct Scales {
  double middle_y, size_y, size_v, middle_u, size_u;
};

Scales scales_of(const Leftover& a, const Leftover& b) {
  Scales s{};
  double low_y = 1e300, high_y = -1e300, low_u = 1e300, high_u = -1e300, speed = 0.0;
  for (const auto* r : {&a, &b}) {
    for (std::size_t i = 0; i < r->output.size(); ++i) {
      low_y = std::min(low_y, r->output[i]);
      high_y = std::max(high_y, r->output[i]);
      low_u = std::min(low_u, r->input[i]);
      high_u = std::max(high_u, r->input[i]);
      if (i > 0) speed = std::max(speed, std::abs(r->output[i] - r->output[i - 1]) / r->step_s);
    }
  }
  s.middle_y = 0.5 * (low_y + high_y);
  s.size_y = std::max(0.5 * (high_y - low_y), 1e-300);
  s.middle_u = 0.5 * (low_u + high_u);
  s.size_u = std::max(0.5 * (high_u - low_u), 1e-300);
  s.size_v = std::max(speed, 1e-300);
  return s;
}

/// Features of signals from which a missing effect could be foretold; columns of zero mean.
Eigen::MatrixXd features(const Leftover& r, const Scales& s) {
  const auto n = static_cast<Eigen::Index>(r.output.size());
  std::vector<Eigen::VectorXd> columns;
  Eigen::VectorXd y(n), v(n), u(n), du(n), branch(n);
  double sign = 1.0;
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    y(i) = (r.output[k] - s.middle_y) / s.size_y;
    u(i) = (r.input[k] - s.middle_u) / s.size_u;
    v(i) = i > 0 ? (r.output[k] - r.output[k - 1]) / r.step_s / s.size_v : 0.0;
    du(i) = i > 0 ? r.input[k] - r.input[k - 1] : 0.0;
    if (du(i) != 0.0) sign = du(i) > 0.0 ? 1.0 : -1.0;
    branch(i) = sign;
  }
  const auto add = [&](const Eigen::VectorXd& c) { columns.push_back(c); };
  const Eigen::VectorXd v_sign = v.array().sign();
  add(y);
  add(y.array().square());
  add(y.array().cube());
  add(y.array().abs());
  add(v);
  add(v.array().abs());
  add(v.array().abs() * v.array());
  add(v.array().square());
  add(y.array() * v.array());
  add(y.array().square() * v.array());
  add(y.array() * v.array().abs());
  add(v_sign);
  add(v_sign.array() * y.array());
  add(v_sign.array() * y.array().square());
  add(branch);
  add(branch.array() * u.array());
  add(branch.array() * u.array().square());
  add((y.array() - 0.6).max(0.0));
  add((-y.array() - 0.6).max(0.0));
  add(u);
  add(u.array().square());
  for (int lag : {1, 2, 4, 8, 16, 32, 64}) {
    Eigen::VectorXd c(n);
    for (Eigen::Index i = 0; i < n; ++i) c(i) = u(std::max<Eigen::Index>(0, i - lag));
    add(c);
  }
  for (double radius : {0.05, 0.2, 0.5}) {
    Eigen::VectorXd c(n);
    double z = 0.0;
    for (Eigen::Index i = 0; i < n; ++i) c(i) = z = std::clamp(z, u(i) - radius, u(i) + radius);
    add(c);
    add(c.array().abs());
  }
  for (double samples : {30.0, 200.0}) {
    Eigen::VectorXd c(n);
    double z = 0.0;
    for (Eigen::Index i = 0; i < n; ++i) c(i) = z += (u(i) - z) / samples;
    add(c);
  }
  Eigen::MatrixXd x(n, static_cast<Eigen::Index>(columns.size()));
  for (std::size_t k = 0; k < columns.size(); ++k) {
    x.col(static_cast<Eigen::Index>(k)) = columns[k].array() - columns[k].mean();
  }
  return x;
}

Eigen::VectorXd centred(const std::vector<double>& v) {
  Eigen::VectorXd e = Eigen::Map<const Eigen::VectorXd>(v.data(), static_cast<Eigen::Index>(v.size()));
  return e.array() - e.mean();
}

}  // namespace

Sign depends_on_signals(const Leftover& learn, const Leftover& apply) {
  Sign sign;
  if (learn.residual.size() < 200 || apply.residual.size() < 200) return sign;
  const auto s = scales_of(learn, apply);
  Eigen::MatrixXd x = features(learn, s);
  Eigen::MatrixXd z = features(apply, s);
  for (Eigen::Index j = 0; j < x.cols(); ++j) {
    const double size = std::max(x.col(j).norm() / std::sqrt(static_cast<double>(x.rows())), 1e-12);
    x.col(j) /= size;
    z.col(j) /= size;
  }
  const Eigen::MatrixXd gram = x.transpose() * x;
  // The ridge grows with the residual's memory: fewer effective samples carry fewer features.
  const double ridge = 0.3 * correlation_time(learn.residual) + 1e-6 * static_cast<double>(x.rows());
  const Eigen::LDLT<Eigen::MatrixXd> solver(gram + ridge * Eigen::MatrixXd::Identity(x.cols(), x.cols()));
  const auto gain = [&](const Eigen::VectorXd& e, const Eigen::VectorXd& f) {
    const Eigen::VectorXd w = solver.solve(x.transpose() * e);
    const Eigen::VectorXd foretold = z * w;
    // One factor for the whole prediction keeps a change of amplitude from spoiling it.
    const double pp = foretold.squaredNorm();
    const double factor = pp > 0.0 ? std::clamp(foretold.dot(f) / pp, 0.0, 1.0) : 0.0;
    return 1.0 - (f - factor * foretold).squaredNorm() / std::max(f.squaredNorm(), 1e-300);
  };
  const double got = gain(centred(learn.residual), centred(apply.residual));
  double chance = 0.0;
  double square = 0.0;
  const int count = 24;
  for (int k = 0; k < count; ++k) {
    const auto e = phase_surrogate(learn.residual, 1000 + static_cast<std::uint64_t>(k));
    const auto f = phase_surrogate(apply.residual, 2000 + static_cast<std::uint64_t>(k));
    const double g = gain(centred(e), centred(f));
    chance = std::max(chance, g);
    square += g * g;
  }
  const double limit = std::max({0.015, 1.6 * chance, 5.0 * std::sqrt(square / count)});
  sign.strength = got / limit;
  sign.found = sign.strength > 1.0;
  sign.what = "the residual can be foretold from input and output";
  return sign;
}

Sign bunched_in_time(const Leftover& record) {
  Sign sign;
  const std::size_t n = record.residual.size();
  if (n < 400) return sign;
  const auto largest = [n](const std::vector<double>& e, std::size_t cells) {
    double most = 0.0;
    double total = 0.0;
    for (std::size_t c = 0; c < cells; ++c) {
      double energy = 0.0;
      for (std::size_t i = c * n / cells; i < (c + 1) * n / cells; ++i) energy += e[i] * e[i];
      most = std::max(most, energy);
      total += energy;
    }
    return total > 0.0 ? most / total : 0.0;
  };
  for (std::size_t cells : {5U, 20U, 60U}) {
    const double got = largest(record.residual, cells);
    double chance = 0.0;
    double sum = 0.0;
    double square = 0.0;
    const int count = 30;
    for (int k = 0; k < count; ++k) {
      const double g = largest(phase_surrogate(record.residual, 3000 + static_cast<std::uint64_t>(k)), cells);
      chance = std::max(chance, g);
      sum += g;
      square += g * g;
    }
    const double middle = sum / count;
    const double spread = std::sqrt(std::max(0.0, square / count - middle * middle));
    const double limit = std::max(1.45 * chance, middle + 7.0 * spread);
    if (got / limit > sign.strength) sign.strength = got / limit;
  }
  sign.found = sign.strength > 1.0;
  sign.what = "the residual is bunched in time";
  return sign;
}

Sign spectral_line(const Leftover& record) {
  Sign sign;
  if (record.residual.size() < 400) return sign;
  auto e = record.residual;
  const double middle = mean(e);
  for (double& x : e) x -= middle;
  const auto p = periodogram(e, record.step_s);
  const std::size_t n = p.power.size();
  for (std::size_t k = 4; k + 4 < n; ++k) {
    if (p.power[k] < p.power[k - 1] || p.power[k] < p.power[k + 1]) continue;
    // Neighbours on both sides beyond the window's own width; the larger side's mean, so that a slope does
    // not count.
    const std::size_t reach = std::clamp<std::size_t>(k / 4, 6, 24);
    double below = 0.0;
    double above = 0.0;
    int counted_below = 0;
    int counted_above = 0;
    for (std::size_t d = 4; d < 4 + reach; ++d) {
      if (k >= d + 1) {
        below += p.power[k - d];
        ++counted_below;
      }
      if (k + d < n) {
        above += p.power[k + d];
        ++counted_above;
      }
    }
    if (counted_below < 3 || counted_above < 3) continue;
    const double floor = std::max(below / counted_below, above / counted_above);
    const double share = p.power[k - 1] + p.power[k] + p.power[k + 1];
    double total = 0.0;
    for (double q : p.power) total += q;
    if (share < 0.02 * total) continue;
    const double limit = 4.0 * (std::log(static_cast<double>(n)) + 3.0);
    const double strength = p.power[k] / std::max(floor, 1e-300) / limit;
    if (strength > sign.strength) sign.strength = strength;
  }
  sign.found = sign.strength > 1.0;
  sign.what = "a line stands in the residual's spectrum";
  return sign;
}

Sign jumps(const Leftover& record) {
  Sign sign;
  const std::size_t n = record.residual.size();
  if (n < 200) return sign;
  std::vector<double> change(n - 1);
  for (std::size_t i = 1; i < n; ++i) change[i - 1] = std::abs(record.residual[i] - record.residual[i - 1]);
  const double largest = *std::max_element(change.begin(), change.end());
  const double usual = 1.4826 * median(std::move(change));
  // Gaussian noise reaches five of its deviations in a million samples.
  constexpr double kLimit = 8.0;
  sign.strength = usual > 0.0 ? largest / (kLimit * usual) : 0.0;
  sign.found = sign.strength > 1.0;
  sign.what = "the residual jumps";
  return sign;
}

Sign gain_varies(const Leftover& record) {
  Sign sign;
  const auto n = static_cast<Eigen::Index>(record.residual.size());
  if (n < 400) return sign;
  Eigen::VectorXd y = Eigen::Map<const Eigen::VectorXd>(record.output.data(), n);
  y.array() -= y.mean();
  // Output times slow cosines; what a constant gain would explain is the fit's business and is left out.
  constexpr int kTerms = 6;
  Eigen::MatrixXd x(n, kTerms + 1);
  for (int k = 0; k <= kTerms; ++k) {
    for (Eigen::Index i = 0; i < n; ++i) {
      x(i, k) =
          y(i) * std::cos(std::numbers::pi * k * (static_cast<double>(i) + 0.5) / static_cast<double>(n));
    }
  }
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(x);
  const Eigen::MatrixXd q = qr.householderQ() * Eigen::MatrixXd::Identity(n, kTerms + 1);
  const auto share = [&](const Eigen::VectorXd& e) {
    return (q.rightCols(kTerms).transpose() * e).squaredNorm() / std::max(e.squaredNorm(), 1e-300);
  };
  const double got = share(centred(record.residual));
  double chance = 0.0;
  for (int k = 0; k < 24; ++k)
    chance = std::max(chance,
                      share(centred(phase_surrogate(record.residual, 4000 + static_cast<std::uint64_t>(k)))));
  sign.strength = got / std::max(0.03, 2.0 * chance);
  sign.found = sign.strength > 1.0;
  sign.what = "the gain varies with time";
  return sign;
}

Sign smooth_over_frequency(const Leftover& record) {
  Sign sign;
  const std::size_t n = record.response.size() / 2;
  if (n < 12) return sign;
  double together = 0.0;
  double energy = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t part = 0; part < 2; ++part) {
      const double e = record.response[2 * i + part];
      energy += e * e;
      if (i > 0) together += e * record.response[2 * (i - 1) + part];
    }
  }
  // Independent errors: the correlation of neighbours has the deviation 1/sqrt(2n); heavy ones a larger one.
  constexpr double kLimit = 4.5;
  const double z = energy > 0.0 ? together / energy * std::sqrt(2.0 * static_cast<double>(n)) : 0.0;
  sign.strength = z / kLimit;
  sign.found = sign.strength > 1.0;
  sign.what = "neighbouring frequencies err alike";
  return sign;
}

std::vector<Sign> signs_of_structure(const std::vector<Leftover>& train,
                                     const std::vector<Leftover>& holdout) {
  std::vector<Sign> signs;
  const auto consider = [&](const Sign& s) {
    if (s.found) signs.push_back(s);
  };
  for (const auto& a : train) {
    for (const auto& b : holdout) {
      if (!a.response.empty() || !b.response.empty()) continue;
      const auto there = depends_on_signals(a, b);
      const auto back = depends_on_signals(b, a);
      // Either way round will do when it is plain, both when it is not.
      if ((there.found && back.found) || there.strength > 2.0 || back.strength > 2.0) {
        consider(there.strength > back.strength ? there : back);
      }
    }
  }
  for (const auto* records : {&train, &holdout}) {
    for (const auto& r : *records) {
      if (!r.response.empty()) {
        consider(smooth_over_frequency(r));
        continue;
      }
      consider(jumps(r));
      consider(gain_varies(r));
      consider(bunched_in_time(r));
      consider(spectral_line(r));
    }
  }
  std::stable_sort(signs.begin(), signs.end(),
                   [](const Sign& a, const Sign& b) { return a.strength > b.strength; });
  return signs;
}

}  // namespace bodesmith::gap
