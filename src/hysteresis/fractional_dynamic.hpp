#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "hysteresis/model_type.hpp"
#include "lti/fractional_transfer.hpp"

namespace bodesmith::hysteresis {

/// The linearised fractional dynamic hysteresis model of a fast tool servo (tool-servo paper, eq. 8-19):
///   P(s) = 1/(τ s + 1) · K_M/(s² + 2ξω_n s + ω_n²) · F(s),   F(s) = (K_p + Θ s^η)/(1 + χ s^λ)   (15)
///   y(t) = P u + ρ t + δ                                                                        (18)
/// with 0 < η, λ < 1. Linear: one frequency, one ellipse, whatever the amplitude. s^α has its cut on the
/// negative real axis, where F has no pole, so F is exactly a spread of first-order lags,
///   F(s) = K_p − s ∫ r(σ)/(σ (s + σ)) dσ,   r(σ) = −(1/π) Im F(σ e^(iπ)),
/// and `modes` first-order sections (trapezoid rule in ln σ, points crowded where r has its pole near the
/// axis) are the simulation by sections. They, the lag and the resonance are propagated exactly for an input
/// that is linear between samples, at any sampling time.
///
/// Note on eq. 20: with Table 1 the printed denominator agrees within 1 % where it has terms (τχ s^3.811, τ s³,
/// χ(1 + 2ξω_nτ) s^2.811, (1 + 2ξω_nτ) s², χ(ω_n²τ + 2ξω_n) s^1.811), but its last term lacks its s, and
/// χω_n² s^λ and ω_n² are missing.
///
/// Stability: the factors are stable for τ, ξ, ω_n > 0, and 1 + χ s^λ has no root with χ > 0, λ < 1; check any denominator with
/// fractional_stability() (argument principle, and Matignon's theorem where the powers have a common step).
///
/// Inverse: of F and the constant gain (F⁻¹ has the same form). The lag and the resonance are left in: an
/// exact inverse of them is improper. achieved() is the whole model's answer.
struct FractionalDynamic {
  double k_m = 1.0;
  double xi = 0.1;
  double omega_n = 1.0;
  double tau = 1.0;
  double eta = 0.5;
  double lambda = 0.5;
  double k_p = 1.0;
  double theta = 0.0;
  double chi = 0.0;
  double rho = 0.0;
  double delta = 0.0;
  int modes = 60;

  static FractionalDynamic from(const Parameters& values);
  Complex fractional_part(Complex s) const;  ///< F
  Complex response(Complex s) const;         ///< P
  FractionalPolynomial denominator() const;  ///< of eq. 15 multiplied out; eight terms
  /// Constant gain of P: K_M K_p/ω_n².
  double static_gain() const { return k_m * k_p / (omega_n * omega_n); }
};

/// F as constant + Σ weight_k/(s + sigma_k), sigma from 1e-8 of the slower of lag and resonance to 1e5 times the faster: within
/// some 1e-5 from a ten-thousandth of these up to both.
struct LagSpread {
  double direct = 0.0;
  std::vector<double> sigma;
  std::vector<double> weight;

  /// No section falls on `anchor`.
  static LagSpread of(const FractionalDynamic& model, double anchor);
  Complex response(Complex s) const;
};

class FractionalOperator final : public Operator {
 public:
  explicit FractionalOperator(const FractionalDynamic& model);
  double reset(double u) override;
  double step(double u, double dt_s) override;
  double peek(double u, double dt_s) const override;
  bool rate_independent() const override { return false; }

 private:
  void prepare(double dt_s);
  void advance(double u, double dt_s, double* lags, Eigen::Vector3d& plant) const;

  FractionalDynamic model_;
  LagSpread spread_;
  std::vector<double> lag_;  ///< states of the sections
  mutable std::vector<double> scratch_;
  Eigen::Vector3d plant_ = Eigen::Vector3d::Zero();  ///< lag's output, resonator's position and velocity
  double u_ = 0.0;
  double time_ = 0.0;
  /// delta, and what lags slower than all sections hold of the input that a reset rested under.
  double constant_ = 0.0;
  // For the sampling time `prepared_`:
  double prepared_ = -1.0;
  std::vector<double> decay_;   ///< e^(−σ h)
  std::vector<double> hold_0_;  ///< ∫ e^(−σ(h−t)) dt
  std::vector<double> hold_1_;  ///< the same of a ramp 0 → 1
  Eigen::Matrix3d plant_decay_ = Eigen::Matrix3d::Identity();
  Eigen::Vector3d input_0_ =
      Eigen::Vector3d::Zero();  ///< answer to u(t) = 1 through everything but the sections' states
  Eigen::Vector3d input_1_ = Eigen::Vector3d::Zero();  ///< to the ramp
  Eigen::Matrix3Xd from_lag_;                          ///< answer of the plant to a section's state
};

Identified identify_fractional_dynamic(std::span<const TimeRecord> records, const IdentifyOptions& options);

}  // namespace bodesmith::hysteresis
