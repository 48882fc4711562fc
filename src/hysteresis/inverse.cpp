#include "hysteresis/inverse.hpp"

#include <algorithm>
#include <cmath>

#include "numeric/optimisation/root.hpp"

namespace bodesmith::hysteresis {

SearchedInverse::SearchedInverse(std::unique_ptr<Operator> forward, double u_min, double u_max)
    : forward_(std::move(forward)), u_min_(u_min), u_max_(u_max), u_(u_min) {
  achieved_ = forward_->reset(u_);
}

double BracketingInverse::reset(double y) {
  // At rest the operator is a plain function of u.
  const auto error = [&](double u) { return forward_->reset(u) - y; };
  u_ = root_between(error, u_min_, u_max_);
  achieved_ = forward_->reset(u_);
  return u_;
}

double BracketingInverse::step(double y, double dt_s) {
  const auto error = [&](double u) { return forward_->peek(u, dt_s) - y; };
  // The error where the input stays; its sign says which way to go: by growing strides, as far as the input's limits.
  double behind = u_;
  double error_behind = error(u_);
  const bool up = error_behind < 0.0;
  const double limit = up ? u_max_ : u_min_;
  double best = u_;
  if (error_behind != 0.0) {
    double stride = std::max(stride_, 1e-9 * std::min(u_max_ - u_min_, 1.0 + std::abs(u_)));
    for (best = behind; best != limit; stride *= 4.0) {
      best = up ? std::min(behind + stride, limit) : std::max(behind - stride, limit);
      const double error_there = error(best);
      if (error_there == 0.0) break;
      if ((error_there < 0.0) != up) {
        best = up ? root_between(error, behind, error_behind, best, error_there)
                  : root_between(error, best, error_there, behind, error_behind);
        break;
      }
      behind = best;
      error_behind = error_there;
    }
  }
  if (best != u_) stride_ = std::abs(best - u_);
  u_ = best;
  achieved_ = forward_->step(u_, dt_s);
  return u_;
}

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
