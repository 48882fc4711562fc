#include "hysteresis/inverse.hpp"

#include <algorithm>
#include <cmath>

namespace bodesmith::hysteresis {

BracketingInverse::BracketingInverse(std::unique_ptr<Operator> forward, double u_min, double u_max,
                                     double tolerance)
    : forward_(std::move(forward)), u_min_(u_min), u_max_(u_max), tolerance_(tolerance) {
  u_ = u_min;
  achieved_ = forward_->reset(u_);
}

BracketingInverse::BracketingInverse(const BracketingInverse& other)
    : Inverse(other),
      forward_(other.forward_->clone()),
      u_min_(other.u_min_),
      u_max_(other.u_max_),
      tolerance_(other.tolerance_),
      u_(other.u_),
      stride_(other.stride_),
      achieved_(other.achieved_) {}

double BracketingInverse::reset(double y) {
  // At rest the operator is a plain function of u: bisect on reset() itself.
  double low = u_min_;
  double high = u_max_;
  const double at_low = forward_->reset(low);
  const double at_high = forward_->reset(high);
  if (y <= at_low) {
    u_ = low;
  } else if (y >= at_high) {
    u_ = high;
  } else {
    for (int i = 0; i < 200 && high - low > 0.0; ++i) {
      const double middle = 0.5 * (low + high);
      if (middle <= low || middle >= high) break;
      (forward_->reset(middle) < y ? low : high) = middle;
    }
    u_ = low;
  }
  achieved_ = forward_->reset(u_);
  return u_;
}

/// From where the input stands by growing strides towards the reference y, as far as the limits of the input.
BracketingInverse::Bracket BracketingInverse::bracket(double y, double dt_s, double error_here) const {
  Bracket out{u_, error_here, u_, error_here, false};
  const double limit = error_here < 0.0 ? u_max_ : u_min_;
  const double direction = error_here < 0.0 ? 1.0 : -1.0;
  double stride = std::max(stride_, 1e-9 * std::min(u_max_ - u_min_, 1.0 + std::abs(u_)));
  while (out.b != limit) {
    const double next = direction > 0.0 ? std::min(out.b + stride, limit) : std::max(out.b - stride, limit);
    const double error = forward_->peek(next, dt_s) - y;
    if (error == 0.0 || (error < 0.0) != (error_here < 0.0)) return {out.b, out.error_b, next, error, true};
    out.b = next;
    out.error_b = error;
    stride *= 4.0;
  }
  return out;
}

/// The input inside a closed bracket with the smallest error, by false position with halved weights (Illinois)
/// and a bisection every third time.
double BracketingInverse::narrowed(double y, double dt_s, Bracket in) const {
  double best = in.b;
  double best_error = std::abs(in.error_b);
  if (std::abs(in.error_a) < best_error) {
    best = in.a;
    best_error = std::abs(in.error_a);
  }
  double weight_a = in.error_a;
  double weight_b = in.error_b;
  for (int i = 0; i < 200 && best_error > tolerance_; ++i) {
    const double middle = 0.5 * (in.a + in.b);
    double c = i % 3 == 2 ? middle : in.b - weight_b * (in.b - in.a) / (weight_b - weight_a);
    if (!(c > std::min(in.a, in.b) && c < std::max(in.a, in.b))) c = middle;
    if (c == in.a || c == in.b) break;
    const double error = forward_->peek(c, dt_s) - y;
    if (std::abs(error) < best_error) {
      best = c;
      best_error = std::abs(error);
    }
    if (error == 0.0) break;
    if ((error < 0.0) == (in.error_b < 0.0)) {
      in.b = c;
      in.error_b = weight_b = error;
      weight_a *= 0.5;
    } else {
      in.a = c;
      in.error_a = weight_a = error;
      weight_b *= 0.5;
    }
  }
  return best;
}

double BracketingInverse::step(double y, double dt_s) {
  // The error where the input stays; its sign says which way to go.
  const double error_here = forward_->peek(u_, dt_s) - y;
  if (std::abs(error_here) > tolerance_) {
    const Bracket found = bracket(y, dt_s, error_here);
    const double best = found.closed ? narrowed(y, dt_s, found) : found.b;
    stride_ = std::abs(best - u_);
    u_ = best;
  }
  achieved_ = forward_->step(u_, dt_s);
  return u_;
}

RecursiveInverse::RecursiveInverse(std::unique_ptr<Operator> forward, double delta_u, double u_min,
                                   double u_max)
    : forward_(std::move(forward)), delta_u_(delta_u), u_min_(u_min), u_max_(u_max) {
  u_ = u_min;
  achieved_ = forward_->reset(u_);
}

RecursiveInverse::RecursiveInverse(const RecursiveInverse& other)
    : Inverse(other),
      forward_(other.forward_->clone()),
      delta_u_(other.delta_u_),
      u_min_(other.u_min_),
      u_max_(other.u_max_),
      u_(other.u_),
      achieved_(other.achieved_) {}

double RecursiveInverse::reset(double y) {
  u_ = u_min_;
  achieved_ = forward_->reset(u_);
  while (achieved_ < y && u_ < u_max_) {
    u_ = std::min(u_ + delta_u_, u_max_);
    achieved_ = forward_->reset(u_);
  }
  return u_;
}

double RecursiveInverse::step(double y, double dt_s) {
  double u_d = u_;
  double y_d = forward_->peek(u_, dt_s);
  if (y != y_d) {
    const double direction = y > y_d ? 1.0 : -1.0;
    const double limit = y > y_d ? u_max_ : u_min_;
    double u_p = u_d;
    double y_p = y_d;
    while (u_d != limit && (y - y_d) * direction > 0.0) {
      u_p = u_d;
      y_p = y_d;
      u_d = direction > 0.0 ? std::min(u_p + delta_u_, limit) : std::max(u_p - delta_u_, limit);
      y_d = forward_->peek(u_d, dt_s);
    }
    // Eq. 13, 14.
    if ((y - y_d) * direction <= 0.0 && y_d != y_p) u_d = u_p + (y - y_p) / (y_d - y_p) * (u_d - u_p);
  }
  u_ = u_d;
  achieved_ = forward_->step(u_, dt_s);
  return u_;
}

}  // namespace bodesmith::hysteresis
