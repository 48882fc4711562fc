#include "lti/fractional_transfer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "base/whole_number.hpp"
#include "numeric/index.hpp"
#include "numeric/linear_algebra/dense.hpp"

namespace bodesmith {
namespace {

/// s^100 rises by 2000 dB a decade: three of them are all that a double holds, and far beyond what can be built.
double power_of(const Node& node, double power) {
  constexpr double kMostPower = 100.0;
  if (power > kMostPower) node.fail(fmt::format("is {}, expected a power of at most {}", power, kMostPower));
  return power;
}

FractionalPolynomial read_polynomial(const Node& node) {
  FractionalPolynomial out;
  for (const Node& item : node.items()) {
    item.allow_only({"coefficient", "power"});
    out.push_back(
        {item.at("coefficient").number(), power_of(item.at("power"), item.at("power").non_negative())});
  }
  const bool any = std::ranges::any_of(out, [](const FractionalPower& t) { return t.coefficient != 0.0; });
  if (!any) node.fail("has no coefficient other than 0");
  return out;
}

FractionalTransfer read_pid(const Node& pid) {
  pid.allow_only({"kp", "ki", "lambda", "kd", "mu"});
  const double kp = pid.number_or("kp", 0.0);
  const double ki = pid.number_or("ki", 0.0);
  const double kd = pid.number_or("kd", 0.0);
  const double lambda = ki != 0.0 ? power_of(pid.at("lambda"), pid.at("lambda").positive()) : 0.0;
  const double mu = kd != 0.0 ? power_of(pid.at("mu"), pid.at("mu").positive()) : 0.0;
  if (kp == 0.0 && ki == 0.0 && kd == 0.0) pid.fail("has no gain other than 0, expected kp, ki or kd");
  return {collect_powers({{ki, 0.0}, {kp, lambda}, {kd, lambda + mu}}), {{1.0, lambda}}};
}

}  // namespace

Complex evaluate(const FractionalPolynomial& polynomial, RadPerSecond w) {
  Complex out = 0.0;
  for (const FractionalPower& term : polynomial) {
    out += term.coefficient * std::polar(std::pow(w.value, term.power), 0.5 * std::numbers::pi * term.power);
  }
  return out;
}

FractionalPolynomial collect_powers(FractionalPolynomial polynomial) {
  std::ranges::sort(polynomial, {}, &FractionalPower::power);
  FractionalPolynomial out;
  for (const FractionalPower& term : polynomial) {
    if (!out.empty() && std::abs(out.back().power - term.power) < 1e-12)
      out.back().coefficient += term.coefficient;
    else
      out.push_back(term);
  }
  std::erase_if(out, [](const FractionalPower& term) { return term.coefficient == 0.0; });
  return out;
}

Complex FractionalTransfer::response(RadPerSecond w) const {
  return evaluate(numerator, w) / evaluate(denominator, w);
}

FractionalTransfer FractionalTransfer::from_node(const Node& node) {
  node.expect_schema("fractional");
  node.allow_only({"schema", "numerator", "denominator", "pid"});
  if (!node.has("pid"))
    return {read_polynomial(node.at("numerator")), read_polynomial(node.at("denominator"))};
  if (node.has("numerator") || node.has("denominator"))
    node.fail("has both 'pid' and a fraction, expected one of them");
  return read_pid(node.at("pid"));
}

FractionalTransfer FractionalTransfer::read(const std::filesystem::path& path, Provenance& from) {
  return from_node(read_document(path, from));
}

namespace {

/// Ends in ln w of the frequencies at which any term can matter: outside, the lowest or the highest power rules alone.
struct LogSpan {
  double from;
  double to;
};

LogSpan span_of_interest(const FractionalPolynomial& terms) {
  double low = INFINITY;
  double high = 0.0;
  for (std::size_t i = 0; i < terms.size(); ++i) {
    for (std::size_t j = i + 1; j < terms.size(); ++j) {
      const double cross = std::pow(std::abs(terms[i].coefficient / terms[j].coefficient),
                                    1.0 / (terms[j].power - terms[i].power));
      low = std::min(low, cross);
      high = std::max(high, cross);
    }
  }
  double min_gap = INFINITY;
  for (std::size_t i = 0; i + 1 < terms.size(); ++i)
    min_gap = std::min(min_gap, terms[i + 1].power - terms[i].power);
  // A factor of 1e-8 between neighbouring terms.
  const double margin = std::clamp(8.0 / min_gap, 2.0, 120.0) * std::numbers::ln10;
  // Within what exp() and pow() of a double can do.
  constexpr double kMaxLog = 600.0;
  return {std::max(std::log(std::max(low, 1e-290)) - margin, -kMaxLog),
          std::min(std::log(std::min(high, 1e290)) + margin, kMaxLog)};
}

/// D(jw) and the sum of the sizes of its terms, both over the largest term: whatever the coefficients, neither overflows.
struct ScaledValue {
  Complex value;
  double size = 0.0;
};
ScaledValue scaled_value(const FractionalPolynomial& terms, double log_w) {
  const auto log_size = [&](const FractionalPower& term) {
    return std::log(std::abs(term.coefficient)) + term.power * log_w;
  };
  double largest = -INFINITY;
  for (const FractionalPower& term : terms) largest = std::max(largest, log_size(term));
  ScaledValue out;
  for (const FractionalPower& term : terms) {
    const double size = std::exp(log_size(term) - largest);
    out.value += std::copysign(1.0, term.coefficient) * std::polar(size, 0.5 * std::numbers::pi * term.power);
    out.size += size;
  }
  return out;
}

struct AxisWalk {
  double turn_rad = 0.0;         ///< of D(jw) from w = 0 to infinity
  double nearest_to_axis = 1.0;  ///< smallest |D(jw)| over the size of its terms
};

/// Along the imaginary axis in steps of ln w that turn D by no more than kMaxTurn.
AxisWalk walk_axis(const FractionalPolynomial& terms) {
  constexpr double kMaxTurn = 0.3;
  constexpr double kMinStep = 1e-9;  // a pole on the axis: the turn there is not resolved any further
  constexpr double kMaxStep = 0.1;
  const auto [from, to] = span_of_interest(terms);
  AxisWalk out;
  double at = from;
  double step = 0.05;
  Complex now = scaled_value(terms, at).value;
  // From exactly 0: D(0) is the lowest coefficient.
  out.turn_rad = std::arg(now / terms.front().coefficient);
  while (at < to) {
    const double next = std::min(to, at + step);
    const auto [value, size] = scaled_value(terms, next);
    const double change = std::arg(value / now);
    if (std::abs(change) > kMaxTurn && step > kMinStep) {
      step *= 0.5;
      continue;
    }
    out.nearest_to_axis = std::min(out.nearest_to_axis, std::abs(value) / size);
    out.turn_rad += change;
    now = value;
    at = next;
    if (std::abs(change) < 0.05) step = std::min(kMaxStep, step * 1.5);
  }
  // What is left to infinity, where the highest power rules.
  const FractionalPower& highest = terms.back();
  out.turn_rad +=
      std::arg(highest.coefficient *
               std::polar(1.0, std::fmod(0.5 * std::numbers::pi * highest.power, 2 * std::numbers::pi)) /
               (now / std::abs(now)));
  return out;
}

/// Common step of the powers, 0 when none with a denominator up to 60 fits; at most 1, for above that s^step takes several
/// points of the plane to one.
double common_step_of(const FractionalPolynomial& terms) {
  for (int denominator = 1; denominator <= 60; ++denominator) {
    const bool fits = std::ranges::all_of(terms, [&](const FractionalPower& t) {
      return std::abs(t.power * denominator - std::round(t.power * denominator)) < 1e-9;
    });
    if (!fits) continue;
    long common = 0;
    for (const FractionalPower& t : terms)
      common = std::gcd(common, nearest_whole<long>(t.power * denominator));
    const double step = static_cast<double>(common) / denominator;
    return step / std::max(1.0, std::ceil(step));
  }
  return 0.0;
}

/// Roots of the polynomial in sigma = s^step within |arg sigma| < step pi/2, by its companion matrix; nothing when its
/// degree is too high for that.
std::optional<int> matignon_count_of(const FractionalPolynomial& terms, double step) {
  constexpr double kMaxDegree = 120.0;
  const double steps = step > 0.0 ? terms.back().power / step : 0.0;
  if (!(steps >= 1.0 && steps <= kMaxDegree)) return std::nullopt;
  const Eigen::Index n = nearest_whole<long>(steps);
  // Scaled so that first and last coefficient have one size.
  const double scale =
      std::pow(std::abs(terms.front().coefficient / terms.back().coefficient), 1.0 / static_cast<double>(n));
  Eigen::MatrixXd companion = Eigen::MatrixXd::Zero(n, n);
  for (const FractionalPower& term : terms) {
    const Eigen::Index k = nearest_whole<long>(term.power / step);
    if (k == n) continue;
    companion(k, n - 1) =
        -term.coefficient / terms.back().coefficient * std::pow(scale, static_cast<double>(k - n));
  }
  for (Eigen::Index k = 1; k < n; ++k) companion(k, k - 1) = 1.0;
  const Eigen::VectorXcd roots = eigenvalues(companion);
  return static_cast<int>(std::ranges::count_if(
      roots, [&](const Complex& root) { return std::abs(std::arg(root)) < 0.5 * std::numbers::pi * step; }));
}

}  // namespace

FractionalStability fractional_stability(const FractionalPolynomial& denominator) {
  FractionalStability out;
  FractionalPolynomial terms = collect_powers(denominator);
  if (terms.empty()) return out;
  out.powers_of_s = terms.front().power;
  for (FractionalPower& term : terms) term.power -= out.powers_of_s;
  out.nearest_to_axis = 1.0;
  if (terms.size() == 1) return out;
  const AxisWalk walk = walk_axis(terms);
  out.nearest_to_axis = walk.nearest_to_axis;
  const double turn_of_highest = 0.5 * std::numbers::pi * terms.back().power;
  out.unstable_poles = nearest_whole<int>((turn_of_highest - walk.turn_rad) / std::numbers::pi);
  out.common_step = common_step_of(terms);
  out.matignon_count = matignon_count_of(terms, out.common_step);
  return out;
}

}  // namespace bodesmith
