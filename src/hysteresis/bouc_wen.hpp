#pragma once

#include <span>

#include "hysteresis/model_type.hpp"

namespace bodesmith::hysteresis {

/// The Bouc-Wen model (Bouc 1967, Wen 1976) as it is used for piezo stages (Low and Guo, IEEE Trans.
/// Ultrasonics 42 (1995) 230):
///   y = k u − z + offset,
///   ż = A u̇ − (beta |u̇| + delta u̇) |z|^(n−1) z − gamma u̇ |z|^n,        |gamma| + |delta| ≤ beta, beta > 0, n ≥ 1, z(0) = z_0.
/// `delta` gives z another rate each way (beta_5 of Song and Der Kiureghian, J. Eng. Mech. 132 (2006) 610); with n = 1 and gamma = 0 it is
/// what Coleman and Hodgdon's loop of two rates lags behind its line, or Dahl's friction of two stiffnesses about its mean.
/// Rate-independent: along a monotone input dz/du = A − (beta sgn(u̇ z) + delta sgn(z) + gamma) |z|^n. For n = 1 this is
/// solved in closed form, otherwise near z = 0 by the series of ∫ dz/(A − …) and elsewhere by Taylor's series of z,
/// to 1e-11 of it.
/// Thermodynamically admissible for −beta ≤ gamma ≤ beta (Ismail, Ikhouane and Rodellar 2009). No wiping-out
/// in the strict sense (loops drift); the inverse is by bracketing and needs dy/du = k − dz/du > 0, i.e. k >
/// A where z = 0.
struct BoucWen {
  double k = 1.0;
  double A = 0.0;
  double beta = 1.0;
  double gamma = 0.0;
  double n = 1.0;
  double z_0 = 0.0;  ///< state that a reset assumes
  double offset = 0.0;
  double delta = 0.0;

  static BoucWen from(const Parameters& values);
  /// z at the end of a monotone move of the input by du.
  double advance(double z, double du) const;
};

class BoucWenOperator final : public Operator {
 public:
  explicit BoucWenOperator(BoucWen model) : model_(model) { reset(0.0); }
  double reset(double u) override {
    u_ = u;
    z_ = model_.z_0;
    return model_.k * u - z_ + model_.offset;
  }
  double step(double u, double) override {
    z_ = model_.advance(z_, u - u_);
    u_ = u;
    return model_.k * u - z_ + model_.offset;
  }
  double peek(double u, double) const override {
    return model_.k * u - model_.advance(z_, u - u_) + model_.offset;
  }
  bool rate_independent() const override { return true; }

 private:
  BoucWen model_;
  double u_ = 0.0;
  double z_ = 0.0;
};

Identified identify_bouc_wen(std::span<const TimeRecord> records, const IdentifyOptions& options);

}  // namespace bodesmith::hysteresis
