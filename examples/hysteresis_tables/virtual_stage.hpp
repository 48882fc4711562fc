#pragma once

#include <Eigen/Dense>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <unsupported/Eigen/MatrixFunctions>
#include <vector>

#include "numeric/random.hpp"

namespace bench {

inline constexpr double kTwoPi = 2.0 * std::numbers::pi;
inline constexpr int kRateSections = 12;

/// A piezo stage that belongs to none of the models: the common bench on which their papers' tables are
/// repeated.
///   x = u/u_full
///   memory:     dh/dx = α sgn(ẋ) (f(x) − h) + g(x),  f = x + asymmetry x (1 − x),  g = slope f'(x)
///               (Coleman-Hodgdon / Duhem)
///   rate:       q = h after ((1 + s/ω_b)/(1 + s/ω_a))^β between rate_from and rate_to
///               (fractional lag, 12 sections)
///   creep:      q + Σ creep_gain (1 − e^(−t/τ)) like lags of q
///   amplifier:  first-order lag on the drive
///   resonance:  second order on the motion
///   sensor:     white noise.
/// Every linear part is propagated exactly for an input that is linear between samples.
struct VirtualStageSettings {
  double full_drive = 1.0;   ///< u_full
  double full_stroke = 1.0;  ///< y at x = 1, at rest
  double alpha = 6.0;
  double slope = 0.62;
  double asymmetry = 0.12;
  double rate_from_hz = 1.0;
  double rate_to_hz = 1000.0;
  double rate_beta = 0.02;           ///< above 0: falls with the rate
  bool rate_on_disturbance = false;  ///< the rate acts on h - x only, the straight line stays (000's reading)
  double amplifier_hz = 0.0;         ///< 0: none
  double resonance_hz = 0.0;         ///< 0: none
  double damping_ratio = 0.05;
  std::vector<double> creep_gains;
  std::vector<double> creep_time_s;
  double noise_rms = 0.0;  ///< of y
  std::uint64_t seed = 1;

  /// The stages of the five papers as far as they print them (000 section V.A, 001 III, 002 Table 1, 004
  /// section 4).
  static VirtualStageSettings nanopositioner();  ///< 000: 6.92 um, 65.1 kHz, damped
  static VirtualStageSettings stack_actuator();  ///< 001: 67.66 um at 150 V, 10 kHz
  static VirtualStageSettings pusher();          ///< 002: 12 um at 100 V, 3.5 kHz
  static VirtualStageSettings
  piezoceramic();  ///< 004: 36 um at 120 V, loops that widen and shrink with the rate
};

class VirtualStage {
 public:
  explicit VirtualStage(VirtualStageSettings settings);
  /// Rests at u after a long time there, come up from 0. Returns the measured y.
  double reset(double u);
  double step(double u, double dt_s);
  const VirtualStageSettings& settings() const { return settings_; }

 private:
  /// First-order section k (s + z)/(s + p) for inputs linear between samples.
  struct Section {
    double p = 1.0, gap = 0.0, gain = 1.0;  ///< gain (1 + (z − p)/(s + p))
    double x = 0.0;
    double move(double from, double to, double dt);
    double rest(double u);
  };
  double memory(double x);
  double measured(double y);

  VirtualStageSettings settings_;
  std::vector<Section> rate_;
  std::vector<Section> creep_;
  Section amplifier_;
  bodesmith::Random random_;
  double x_ = 0.0;
  double h_ = 0.0;
  double drive_ = 0.0;
  double q_ = 0.0;
  std::vector<double> between_;
  Eigen::Vector2d mass_ = Eigen::Vector2d::Zero();
  double force_ = 0.0;
  double prepared_ = -1.0;
  Eigen::Matrix2d mass_decay_ = Eigen::Matrix2d::Identity();
  Eigen::Vector2d hold_0_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d hold_1_ = Eigen::Vector2d::Zero();
};

inline VirtualStageSettings VirtualStageSettings::nanopositioner() {
  VirtualStageSettings out;
  out.full_drive = 1.0;
  out.full_stroke = 6.92;
  out.rate_beta = -0.02;
  out.rate_on_disturbance = true;
  out.rate_to_hz = 5000.0;
  out.amplifier_hz = 60e3;
  out.resonance_hz = 65.1e3;
  out.damping_ratio = 0.7;  // with the damping compensator of eq. 20
  out.noise_rms = 0.004;
  return out;
}

inline VirtualStageSettings VirtualStageSettings::stack_actuator() {
  VirtualStageSettings out;
  out.full_drive = 150.0;
  out.full_stroke = 67.66;
  out.asymmetry = 0.06;
  out.rate_beta = 0.02;
  out.rate_to_hz = 1000.0;
  out.amplifier_hz = 2000.0;
  out.resonance_hz = 10e3;
  out.damping_ratio = 0.05;
  out.creep_gains = {0.01, 0.01, 0.01};
  out.creep_time_s = {0.3, 3.0, 30.0};
  out.noise_rms = 0.004;
  return out;
}

inline VirtualStageSettings VirtualStageSettings::pusher() {
  VirtualStageSettings out;
  out.full_drive = 100.0;
  out.full_stroke = 12.0;
  out.asymmetry = 0.08;
  out.rate_beta = 0.01;
  out.amplifier_hz = 4000.0;
  out.resonance_hz = 3500.0;
  out.damping_ratio = 0.3;
  out.creep_gains = {0.008, 0.008, 0.008};
  out.creep_time_s = {0.3, 3.0, 30.0};
  out.noise_rms = 0.01;
  return out;
}

inline VirtualStageSettings VirtualStageSettings::piezoceramic() {
  VirtualStageSettings out;
  out.full_drive = 120.0;
  out.full_stroke = 36.0;
  out.rate_beta = 0.05;
  out.rate_from_hz = 3.0;
  out.rate_to_hz = 3000.0;
  out.amplifier_hz = 1500.0;
  out.resonance_hz = 900.0;
  out.damping_ratio = 0.4;
  out.creep_gains = {0.01, 0.01};
  out.creep_time_s = {0.5, 5.0};
  out.noise_rms = 0.02;
  return out;
}

inline double VirtualStage::Section::rest(double u) {
  x = u / p;
  return gain * (u + gap * x);
}

inline double VirtualStage::Section::move(double from, double to, double dt) {
  const double e = std::exp(-p * dt);
  const double hold = (1.0 - e) / p;
  x = e * x + hold * from + (dt > 0.0 ? (1.0 - hold / dt) / p : 0.0) * (to - from);
  return gain * (to + gap * x);
}

inline VirtualStage::VirtualStage(VirtualStageSettings settings)
    : settings_(std::move(settings)), random_(settings_.seed) {
  // A fractional lag of order beta: poles and zeros alternate, evenly in log frequency (Oustaloup).
  const double low = kTwoPi * settings_.rate_from_hz;
  const double ratio = settings_.rate_to_hz / settings_.rate_from_hz;
  if (settings_.rate_beta != 0.0) {
    for (int k = 0; k < kRateSections; ++k) {
      const double pole = low * std::pow(ratio, (k + 0.5 - 0.5 * settings_.rate_beta) / kRateSections);
      const double zero = low * std::pow(ratio, (k + 0.5 + 0.5 * settings_.rate_beta) / kRateSections);
      rate_.push_back({pole, zero - pole, pole / zero, 0.0});
    }
  }
  for (std::size_t i = 0; i < settings_.creep_gains.size(); ++i)
    creep_.push_back({1.0 / settings_.creep_time_s[i], 0.0, 1.0, 0.0});
  if (settings_.amplifier_hz > 0.0) amplifier_.p = kTwoPi * settings_.amplifier_hz;
  reset(0.0);
}

inline double VirtualStage::memory(double x) {
  // The branch in small straight pieces of f, each in closed form.
  const double way = x - x_;
  if (way == 0.0) return h_;
  const int pieces = 1 + static_cast<int>(std::abs(way) * 200.0);
  const double a = settings_.alpha;
  for (int i = 0; i < pieces; ++i) {
    const double from = x_ + way * i / pieces;
    const double to = x_ + way * (i + 1) / pieces;
    const auto f = [&](double at) { return at + settings_.asymmetry * at * (1.0 - at); };
    const double s = (f(to) - f(from)) / (to - from);
    const double g = settings_.slope * s;
    const double sign = way > 0.0 ? 1.0 : -1.0;
    const double offset = sign * (g - s) / a;
    h_ = f(to) + offset + (h_ - f(from) - offset) * std::exp(-a * std::abs(to - from));
  }
  x_ = x;
  return h_;
}

inline double VirtualStage::measured(double y) {
  return settings_.full_stroke * y +
         (settings_.noise_rms > 0.0 ? settings_.noise_rms * random_.normal() : 0.0);
}

inline double VirtualStage::reset(double u) {
  x_ = 0.0;
  h_ = 0.0;
  drive_ = u;
  amplifier_.rest(u);
  double y = memory(u / settings_.full_drive);
  const double line = settings_.rate_on_disturbance ? x_ : 0.0;
  between_.assign(rate_.size() + 1, y - line);
  for (Section& section : rate_) section.rest(y - line);
  q_ = y;
  for (std::size_t i = 0; i < creep_.size(); ++i) {
    creep_[i].rest(q_);
    y += settings_.creep_gains[i] * q_;
  }
  force_ = y;
  mass_ << y, 0.0;
  return measured(y);
}

inline double VirtualStage::step(double u, double dt_s) {
  double drive = u;
  if (settings_.amplifier_hz > 0.0) {
    // A pure lag: p/(s + p), the section's state times p.
    amplifier_.move(drive_, u, dt_s);
    drive = amplifier_.p * amplifier_.x;
  }
  drive_ = u;
  double y = memory(drive / settings_.full_drive);
  const double line = settings_.rate_on_disturbance ? x_ : 0.0;
  y -= line;
  for (std::size_t k = 0; k < rate_.size(); ++k) {
    const double before = between_[k];
    between_[k] = y;
    y = rate_[k].move(before, y, dt_s);
  }
  y += line;
  const double q = y;
  for (std::size_t i = 0; i < creep_.size(); ++i) {
    creep_[i].move(q_, q, dt_s);
    y += settings_.creep_gains[i] * creep_[i].p * creep_[i].x;
  }
  q_ = q;
  if (settings_.resonance_hz > 0.0) {
    if (dt_s != prepared_) {
      prepared_ = dt_s;
      const double w = kTwoPi * settings_.resonance_hz;
      Eigen::Matrix2d a;
      a << 0.0, 1.0, -w * w, -2.0 * settings_.damping_ratio * w;
      const Eigen::Vector2d b(0.0, w * w);
      mass_decay_ = (a * dt_s).eval().exp();
      hold_0_ = a.inverse() * ((mass_decay_ - Eigen::Matrix2d::Identity()) * b);
      hold_1_ = a.inverse() * (hold_0_ - dt_s * b) / dt_s;
    }
    mass_ = mass_decay_ * mass_ + hold_0_ * force_ + hold_1_ * (y - force_);
    force_ = y;
    y = mass_(0);
  }
  return measured(y);
}

}  // namespace bench
