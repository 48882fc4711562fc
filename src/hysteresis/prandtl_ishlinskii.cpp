#include "hysteresis/prandtl_ishlinskii.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.hpp"
#include "numeric/optimisation/root.hpp"

namespace bodesmith::hysteresis {

namespace {

using Start = PrandtlIshlinskii::Start;

constexpr std::array kStarts = {Start::rest_zero, Start::from_above, Start::from_below};

/// S must rise on every piece.
void validate_dead_zones(const PrandtlIshlinskii& model) {
  if (model.s.size() != model.v.size())
    throw DesignError(
        fmt::format("s has {} and v has {} numbers, expected as many", model.s.size(), model.v.size()));
  for (const double side : {1.0, -1.0}) {
    std::vector<std::pair<double, double>> knees;
    for (std::size_t k = 0; k < model.s.size(); ++k) {
      if (model.s[k] == 0.0) throw DesignError("s holds a 0, expected thresholds on either side of it");
      if (model.s[k] * side > 0.0) knees.emplace_back(std::abs(model.s[k]), model.v[k]);
    }
    std::ranges::sort(knees);
    double slope = 1.0;
    for (const auto& knee : knees) {
      slope += knee.second;
      if (!(slope > 0.0))
        throw DesignError("the dead zones s, v make the output fall, expected 1 + the sum of v > 0");
    }
  }
}

void validate_plays(const PrandtlIshlinskii& model) {
  if (model.r.empty() || model.r.size() != model.w.size())
    throw DesignError(
        fmt::format("r has {} and w has {} numbers, expected as many", model.r.size(), model.w.size()));
  if (model.r.front() != 0.0) throw DesignError("r does not begin with 0, expected 0 = r[0] < r[1] < …");
  if (!model.e.empty() && model.e.size() != model.w.size())
    throw DesignError(
        fmt::format("e has {} numbers, expected none or as many as w ({})", model.e.size(), model.w.size()));
  double sum = 0.0;
  for (const double e : model.e) sum += std::min(0.0, e);
  for (std::size_t i = 0; i < model.r.size(); ++i) {
    if (i > 0 && !(model.r[i] > model.r[i - 1]))
      throw DesignError("r does not rise, expected 0 = r[0] < r[1] < …");
    sum += model.w[i] - (model.e.empty() ? 0.0 : std::min(0.0, model.e[i]));
    if (!(sum > 0.0))
      throw DesignError(fmt::format("the sum of w[0..{}] is not above 0, expected a rising output", i));
  }
}

}  // namespace

std::string_view to_string(PrandtlIshlinskii::Start start) {
  switch (start) {
    case Start::rest_zero:
      return "rest_zero";
    case Start::from_above:
      return "from_above";
    case Start::from_below:
      break;
  }
  return "from_below";
}

PrandtlIshlinskii PrandtlIshlinskii::from(const Parameters& values) {
  PrandtlIshlinskii out;
  out.r = values.list("r");
  out.w = values.list("w");
  out.s = values.list("s");
  out.v = values.list("v");
  out.e = values.list("e");
  out.gamma = values.list("gamma");
  out.u_0 = values.number("u_0");
  out.offset = values.number("offset");
  out.start =
      *std::ranges::find_if(kStarts, [&](Start one) { return to_string(one) == values.word("start"); });
  validate_plays(out);
  if (!out.gamma.empty() && (out.gamma.size() != 4 || !(out.gamma[0] * out.gamma[1] > 0.0)))
    throw DesignError("gamma is not [c0, c1, c2, c3] with c0 c1 > 0");
  validate_dead_zones(out);
  return out;
}

double PrandtlIshlinskii::envelope(double u) const {
  const double x = u - u_0;
  return gamma.empty() ? x : gamma[0] * std::tanh(gamma[1] * x + gamma[2]) + gamma[3];
}

double PrandtlIshlinskii::envelope_inverse(double value) const {
  if (gamma.empty()) return u_0 + value;
  const double limit = 1.0 - 1e-12;
  const double t = std::clamp((value - gamma[3]) / gamma[0], -limit, limit);
  return u_0 + (std::atanh(t) - gamma[2]) / gamma[1];
}

double PrandtlIshlinskii::shape_inverse(double y) const {
  if (s.empty()) return y;
  // Piecewise linear and rising with S(0) = 0: walk outwards knee by knee on the side of y.
  const double side = y >= 0.0 ? 1.0 : -1.0;
  const double target = std::abs(y);
  double at = 0.0;
  double value = 0.0;
  double slope = 1.0;
  for (;;) {
    double next = std::numeric_limits<double>::infinity();
    for (const double knee : s) {
      if (knee * side > 0.0 && std::abs(knee) > at) next = std::min(next, std::abs(knee));
    }
    const double reach = value + slope * (next - at);
    if (!(reach < target)) return side * (at + (target - value) / slope);
    value = reach;
    at = next;
    for (std::size_t k = 0; k < s.size(); ++k)
      if (s[k] * side > 0.0 && std::abs(s[k]) == next) slope += v[k];
  }
}

namespace {

/// Two numbers side by side, wherever they lie.
using Two __attribute__((vector_size(16), aligned(8), may_alias)) = double;
const Two* two_at(const double* from) {
  return reinterpret_cast<const Two*>(from);
}
Two* two_at(double* to) {
  return reinterpret_cast<Two*>(to);
}

void set_states(const PrandtlIshlinskii& model, double v, std::vector<double>& z) {
  for (std::size_t i = 0; i < z.size(); ++i) {
    switch (model.start) {
      case Start::rest_zero:
        z[i] = std::max(v - model.r[i], std::min(v + model.r[i], 0.0));
        break;
      case Start::from_above:
        z[i] = v + model.r[i];
        break;
      case Start::from_below:
        z[i] = v - model.r[i];
        break;
    }
  }
}

}  // namespace

PrandtlIshlinskiiOperator::PrandtlIshlinskiiOperator(PrandtlIshlinskii model)
    : model_(std::move(model)), z_(model_.r.size(), 0.0) {
  for (std::size_t k = 0; k < model_.s.size(); ++k)
    (model_.s[k] > 0.0 ? above_ : below_).push_back({model_.s[k], model_.v[k]});
  reset(model_.u_0);
}

double PrandtlIshlinskiiOperator::shape(double p) const {
  double out = p;
  if (p > 0.0) {
    for (const DeadZone& zone : above_)
      if (p > zone.s) out += zone.v * (p - zone.s);
  } else {
    for (const DeadZone& zone : below_)
      if (p < zone.s) out += zone.v * (p - zone.s);
  }
  return out;
}

double PrandtlIshlinskiiOperator::reset(double u) {
  set_states(model_, model_.envelope(u), z_);
  return step(u, 0.0);
}

double PrandtlIshlinskiiOperator::step(double u, double) {
  const double v = model_.envelope(u);
  const double* r = model_.r.data();
  const double* w = model_.w.data();
  double* z = z_.data();
  // Two plays at a time, and two sums, neither of which waits for the other.
  Two sums = {0.0, 0.0};
  const Two input = {v, v};
  const std::size_t n = z_.size();
  for (std::size_t i = 0; i + 1 < n; i += 2) {
    const Two& radius = *two_at(r + i);
    Two& states = *two_at(z + i);
    const Two high = input + radius;
    const Two low = input - radius;
    const Two below = states < high ? states : high;
    states = low < below ? below : low;
    sums += *two_at(w + i) * states;
  }
  double p = sums[0];
  if (n % 2 != 0) {
    z[n - 1] = std::max(v - r[n - 1], std::min(v + r[n - 1], z[n - 1]));
    p += w[n - 1] * z[n - 1];
  }
  p += sums[1];
  for (std::size_t i = 0; i < model_.e.size(); ++i) p += model_.e[i] * std::max(0.0, v - z[i]);
  return model_.offset + shape(p);
}

double PrandtlIshlinskiiOperator::peek(double u, double) const {
  const double v = model_.envelope(u);
  double p = 0.0;
  for (std::size_t i = 0; i < z_.size(); ++i) {
    const double z = std::max(v - model_.r[i], std::min(v + model_.r[i], z_[i]));
    p += model_.w[i] * z;
    if (!model_.e.empty()) p += model_.e[i] * std::max(0.0, v - z);
  }
  return model_.offset + shape(p);
}

PrandtlIshlinskiiInverse::PrandtlIshlinskiiInverse(PrandtlIshlinskii model) : model_(std::move(model)) {
  if (!model_.e.empty()) throw DesignError("stops of unlike halves, e, have no inverse in closed form");
  const std::size_t n = model_.r.size();
  r_.resize(n);
  w_.resize(n);
  z_.resize(n);
  double before = 0.0;
  double upto = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    before = upto;
    upto += model_.w[i];
    r_[i] = 0.0;
    for (std::size_t j = 0; j <= i; ++j) r_[i] += model_.w[j] * (model_.r[i] - model_.r[j]);
    w_[i] = i == 0 ? 1.0 / model_.w[0] : -model_.w[i] / (upto * before);
  }
  reset(model_.offset);
}

double PrandtlIshlinskiiInverse::reset(double y) {
  // At rest p is a rising piecewise linear function of v: its root, then the states.
  const double p = model_.shape_inverse(y - model_.offset);
  std::vector<double>& z = z_;
  const auto bank = [&](double v) {
    set_states(model_, v, z);
    double sum = 0.0;
    for (std::size_t i = 0; i < z.size(); ++i) sum += model_.w[i] * z[i];
    return sum;
  };
  double low = -1.0;
  double high = 1.0;
  while (bank(low) > p && low > -1e300) low *= 2.0;
  while (bank(high) < p && high < 1e300) high *= 2.0;
  const double v = root_between([&](double at) { return bank(at) - p; }, low, high);
  bank(v);
  // z' from z (in place: z'_i needs z_j of j ≥ i only, so rising i is safe).
  double upto = 0.0;
  for (std::size_t i = 0; i < z.size(); ++i) {
    upto += model_.w[i];
    double value = upto * z[i];
    for (std::size_t j = i + 1; j < z.size(); ++j) value += model_.w[j] * z[j];
    z[i] = value;
  }
  if (!model_.gamma.empty()) {
    if (!forward_) forward_.emplace(model_);
    forward_->reset(model_.envelope_inverse(v));
  }
  return step(y, 0.0);
}

double PrandtlIshlinskiiInverse::step(double y, double) {
  const double p = model_.shape_inverse(y - model_.offset);
  double v = 0.0;
  for (std::size_t i = 0; i < z_.size(); ++i) {
    z_[i] = std::max(p - r_[i], std::min(p + r_[i], z_[i]));
    v += w_[i] * z_[i];
  }
  const double u = model_.envelope_inverse(v);
  achieved_ = forward_ ? forward_->step(u, 0.0) : y;
  return u;
}

namespace {

class PrandtlIshlinskiiType final
    : public ShapedModelType<PrandtlIshlinskii, PrandtlIshlinskiiOperator, PrandtlIshlinskiiInverse> {
 public:
  PrandtlIshlinskiiType()
      : ShapedModelType(
            "prandtl_ishlinskii",
            "weighted plays, optionally with dead zones (asymmetry) and an envelope; analytic inverse",
            {
                list_of(not_negative("r", "u", "thresholds of the plays, 0 = r[0] < r[1] < …")),
                list_of(
                    any_number("w", "y/u", "weights of the plays; w[0] > 0 and every partial sum above 0")),
                optional_list_of(any_number("s", "y", "thresholds of the one-sided dead zones (asymmetry)")),
                optional_list_of(
                    any_number("v", "1", "weights of the dead zones, 1 + their sum on either side > 0")),
                optional_list_of(any_number("e", "y/u", "weights of the stops' positive halves (asymmetry)")),
                optional_list_of(
                    any_number("gamma", "1", "[c0, c1, c2, c3] of the envelope c0 tanh(c1 x + c2) + c3")),
                any_number("u_0", "u", "input at which the virgin curve starts").with_default(0.0),
                any_number("offset", "y", "constant added at the output").with_default(0.0),
                one_word_of("start", "the past that a reset assumes",
                            {"rest_zero", "from_above", "from_below"}),
            }) {}

 protected:
  Identified fit(std::span<const TimeRecord> records, const IdentifyOptions& options) const override {
    return identify_prandtl_ishlinskii(records, options);
  }
};

}  // namespace

BODESMITH_ENTRY(ModelType, prandtl_ishlinskii_type, PrandtlIshlinskiiType)

}  // namespace bodesmith::hysteresis
