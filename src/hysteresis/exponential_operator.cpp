#include "hysteresis/exponential_operator.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.hpp"
#include "numeric/optimisation/root.hpp"

namespace bodesmith::hysteresis {

ExponentialOperators ExponentialOperators::from(const Parameters& values) {
  ExponentialOperators out;
  out.k = values.list("k");
  out.tau = values.list("tau");
  out.v_off = values.number("V_off");
  out.l_off = values.number("L_off");
  if (out.k.empty() || out.k.size() != out.tau.size())
    throw DesignError(
        fmt::format("k has {} and tau has {} numbers, expected as many", out.k.size(), out.tau.size()));
  return out;
}

double ExponentialOperators::gain_curve(double x) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < k.size(); ++i) sum -= k[i] * std::expm1(-tau[i] * x);
  return sum * x;
}

double ExponentialOperators::slope(double x) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < k.size(); ++i) {
    const double decay = std::exp(-tau[i] * x);
    sum += k[i] * (1.0 - decay + tau[i] * x * decay);
  }
  return sum;
}

double ExponentialOperators::solve(double y) const {
  if (!(y > 0.0)) return 0.0;
  double total = 0.0;
  for (const double part : k) total += part;
  double high = y / total;
  while (gain_curve(high) < y && high < 1e300) high *= 2.0;
  return root_between([&](double x) { return gain_curve(x) - y; }, 0.0, high);
}

bool ExponentialOperators::rises() const {
  double total = 0.0;
  double slowest = std::numeric_limits<double>::infinity();
  double fastest = 0.0;
  for (std::size_t i = 0; i < k.size(); ++i) {
    total += k[i];
    slowest = std::min(slowest, tau[i]);
    fastest = std::max(fastest, tau[i]);
  }
  if (!(total > 0.0)) return false;
  for (double x = 1e-3 / fastest; x < 60.0 / slowest; x *= 1.03)
    if (!(slope(x) > 0.0)) return false;
  return true;
}

ExponentialOperators ExponentialOperators::dominant_only() const {
  const auto d = static_cast<std::size_t>(std::ranges::min_element(tau) - tau.begin());
  double total = 0.0;
  for (const double part : k) total += part;
  ExponentialOperators out = *this;
  out.k = {total - k[d], k[d]};
  out.tau = {1e9, tau[d]};
  return out;
}

ExponentialOperator::ExponentialOperator(ExponentialOperators model) : loops_(std::move(model), 4096) {
  reset(loops_.rule().v_off);
}

double ExponentialOperator::reset(double u) {
  const ExponentialOperators& rule = loops_.rule();
  loops_.start(rule.v_off, rule.l_off, u >= rule.v_off ? 1 : -1);
  return loops_.step(u);
}

ExponentialInverse::ExponentialInverse(ExponentialOperators model) : forward_(std::move(model)) {
  if (!forward_.loops_.rule().rises())
    throw DesignError(
        "the operators' curve g(x) = sum of k (1 - exp(-tau x)) x falls somewhere: there is no inverse");
}

double ExponentialInverse::reset(double y) {
  const ExponentialOperators& rule = forward_.loops_.rule();
  forward_.loops_.start(rule.v_off, rule.l_off, y >= rule.l_off ? 1 : -1);
  return forward_.loops_.invert(y);
}

TimeRecord exchanged(const TimeRecord& record) {
  TimeRecord out = record;
  std::swap(out.u, out.y);
  return out;
}

namespace {

class ExponentialOperatorType final
    : public ShapedModelType<ExponentialOperators, ExponentialOperator, ExponentialInverse> {
 public:
  ExponentialOperatorType()
      : ShapedModelType("exponential_operator",
                        "sum of exponential branches from the last turning point, on a stack of extremes",
                        {
                            list_of(any_number("k", "y/u", "gains of the operators")),
                            list_of(above_zero("tau", "1/u", "lags of the operators")),
                            any_number("V_off", "u", "input of the first turning point").with_default(0.0),
                            any_number("L_off", "y", "output of the first turning point").with_default(0.0),
                        }) {}

 protected:
  Identified fit(std::span<const TimeRecord> records, const IdentifyOptions& options) const override {
    return identify_exponential_operators(records, options);
  }
};

}  // namespace

BODESMITH_ENTRY(ModelType, exponential_operator_type, ExponentialOperatorType)

}  // namespace bodesmith::hysteresis
