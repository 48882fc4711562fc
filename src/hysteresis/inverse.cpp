#include "hysteresis/inverse.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

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

double BracketingInverse::step(double y, double dt_s) {
  // The miss where the input stays; its sign says which way to go.
  double a = u_;
  double miss_a = forward_->peek(a, dt_s) - y;
  if (std::abs(miss_a) <= tolerance_) {
    achieved_ = forward_->step(u_, dt_s);
    return u_;
  }
  const double limit = miss_a < 0.0 ? u_max_ : u_min_;
  const double direction = miss_a < 0.0 ? 1.0 : -1.0;
  double stride = std::max(stride_, 1e-9 * std::min(u_max_ - u_min_, 1.0 + std::abs(u_)));
  double b = a;
  double miss_b = miss_a;
  bool bracketed = false;
  while (b != limit) {
    const double next = direction > 0.0 ? std::min(b + stride, limit) : std::max(b - stride, limit);
    const double miss = forward_->peek(next, dt_s) - y;
    if (miss == 0.0 || (miss < 0.0) != (miss_a < 0.0)) {
      a = b;
      miss_a = miss_b;
      b = next;
      miss_b = miss;
      bracketed = true;
      break;
    }
    b = next;
    miss_b = miss;
    stride *= 4.0;
  }
  double best = b;
  double best_miss = std::abs(miss_b);
  if (bracketed) {
    if (std::abs(miss_a) < best_miss) {
      best = a;
      best_miss = std::abs(miss_a);
    }
    double weight_a = miss_a;
    double weight_b = miss_b;
    for (int i = 0; i < 200 && best_miss > tolerance_; ++i) {
      double c = i % 3 == 2 ? 0.5 * (a + b) : b - weight_b * (b - a) / (weight_b - weight_a);
      if (!(c > std::min(a, b) && c < std::max(a, b))) c = 0.5 * (a + b);
      if (c == a || c == b) break;
      const double miss = forward_->peek(c, dt_s) - y;
      if (std::abs(miss) < best_miss) {
        best = c;
        best_miss = std::abs(miss);
      }
      if (miss == 0.0) break;
      if ((miss < 0.0) == (miss_b < 0.0)) {
        b = c;
        miss_b = weight_b = miss;
        weight_a *= 0.5;
      } else {
        a = c;
        miss_a = weight_a = miss;
        weight_b *= 0.5;
      }
    }
  }
  stride_ = std::abs(best - u_);
  u_ = best;
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
