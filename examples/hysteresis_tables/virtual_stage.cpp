#include "virtual_stage.hpp"

#include <cmath>
#include <numbers>
#include <utility>

#include "numeric/linear_algebra/dense.hpp"

namespace bench {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;
constexpr int kRateSections = 12;

}  // namespace

VirtualStageSettings VirtualStageSettings::nanopositioner() {
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

VirtualStageSettings VirtualStageSettings::stack_actuator() {
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

VirtualStageSettings VirtualStageSettings::pusher() {
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

VirtualStageSettings VirtualStageSettings::piezoceramic() {
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

double VirtualStage::Section::rest(double u) {
  x = u / p;
  return gain * (u + gap * x);
}

double VirtualStage::Section::move(double from, double to, double dt) {
  const double e = std::exp(-p * dt);
  const double hold = (1.0 - e) / p;
  x = e * x + hold * from + (dt > 0.0 ? (1.0 - hold / dt) / p : 0.0) * (to - from);
  return gain * (to + gap * x);
}

VirtualStage::VirtualStage(VirtualStageSettings settings)
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

double VirtualStage::memory(double x) {
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

double VirtualStage::measured(double y) {
  return settings_.full_stroke * y +
         (settings_.noise_rms > 0.0 ? settings_.noise_rms * random_.normal() : 0.0);
}

double VirtualStage::reset(double u) {
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
  place_ = y;
  speed_ = 0.0;
  return measured(y);
}

double VirtualStage::step(double u, double dt_s) {
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
      const double turn = kTwoPi * settings_.resonance_hz * dt_s;
      // Place, speed, the force and what it gains over the step.
      motion_ = {0.0, turn, 0.0, 0.0, -turn, -2.0 * settings_.damping_ratio * turn, turn, 0.0, 0.0, 0.0, 0.0,
                 1.0, 0.0,  0.0, 0.0, 0.0};
      std::vector<double> work;
      bodesmith::matrix_exponential(motion_.data(), 4, work);
    }
    const auto row = [&](std::size_t at) {
      return motion_[at] * place_ + motion_[at + 1] * speed_ + motion_[at + 2] * force_ +
             motion_[at + 3] * (y - force_);
    };
    const double place = row(0);
    speed_ = row(4);
    place_ = place;
    force_ = y;
    y = place;
  }
  return measured(y);
}

}  // namespace bench
