#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

/// Operators in their most literal form: what the stack of turning points is held against, by the tests and by
/// the speed programs in bench/.
namespace bodesmith::hysteresis::testing {

/// All relays, one by one: the reference for tests and for the speed comparison.
class BruteForceRelays {
 public:
  BruteForceRelays(double u_min, double u_max, std::size_t levels, std::vector<double> weights,
                   double offset);
  double reset(double u);
  double step(double u);

 private:
  double offset_;
  std::vector<float> up_;  ///< thresholds in units of the node distance
  std::vector<float> down_;
  std::vector<double> weights_;
  std::vector<double> state_;
  double u_min_;
  double scale_;
};

inline BruteForceRelays::BruteForceRelays(double u_min, double u_max, std::size_t levels,
                                          std::vector<double> weights, double offset)
    : offset_(offset),
      weights_(std::move(weights)),
      state_(weights_.size(), 0.0),
      u_min_(u_min),
      scale_(static_cast<double>(levels) / (u_max - u_min)) {
  for (std::size_t i = 0; i < levels; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      up_.push_back(static_cast<float>(i + 1));
      down_.push_back(static_cast<float>(j));
    }
  }
}

inline double BruteForceRelays::reset(double u) {
  std::fill(state_.begin(), state_.end(), 0.0);
  return step(u);
}

inline double BruteForceRelays::step(double u) {
  const double x = (u - u_min_) * scale_;
  double sum = 0.0;
  for (std::size_t k = 0; k < state_.size(); ++k) {
    double s = state_[k];
    s = x >= static_cast<double>(up_[k]) ? 1.0 : s;
    s = x <= static_cast<double>(down_[k]) ? 0.0 : s;
    state_[k] = s;
    sum += weights_[k] * s;
  }
  return offset_ + sum;
}

/// Every kernel by itself, eq. 4-7 as printed: the reference for tests and for the speed comparison.
class BruteForceKp {
 public:
  BruteForceKp(double u_min, double u_max, std::size_t levels, std::vector<double> mu);
  double reset(double u);
  double step(double u);

 private:
  double u_min_;
  double scale_;
  std::size_t levels_;
  std::vector<double> mu_;
  std::vector<double> xi_;
  double v_ = 0.0;
};

inline BruteForceKp::BruteForceKp(double u_min, double u_max, std::size_t levels, std::vector<double> mu)
    : u_min_(u_min),
      scale_(1.0 / (u_max - u_min)),
      levels_(levels),
      mu_(std::move(mu)),
      xi_(mu_.size(), 0.0) {}

inline double BruteForceKp::reset(double u) {
  std::fill(xi_.begin(), xi_.end(), 0.0);
  v_ = 0.0;
  return step(u);
}

inline double BruteForceKp::step(double u) {
  const double v = (u - u_min_) * scale_;
  const double a = 1.0 / static_cast<double>(levels_);
  const auto ridge = [a](double x) { return x < 0.0 ? 0.0 : x > a ? 1.0 : x / a; };
  double sum = 0.0;
  std::size_t k = 0;
  for (std::size_t i = 0; i < levels_; ++i) {
    for (std::size_t j = 0; j <= i; ++j, ++k) {
      if (v > v_) xi_[k] = std::max(xi_[k], ridge(v - static_cast<double>(i) * a));
      if (v < v_) xi_[k] = std::min(xi_[k], ridge(v - static_cast<double>(j) * a));
      sum += mu_[k] * xi_[k];
    }
  }
  v_ = v;
  return sum;
}

}  // namespace bodesmith::hysteresis::testing
