#include "lti/fractional_transfer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

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
  const bool any =
      std::any_of(out.begin(), out.end(), [](const FractionalPower& t) { return t.coefficient != 0.0; });
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

std::complex<double> evaluate(const FractionalPolynomial& polynomial, RadPerSecond w) {
  std::complex<double> out = 0.0;
  for (const FractionalPower& term : polynomial) {
    out += term.coefficient * std::polar(std::pow(w.value, term.power), 0.5 * std::numbers::pi * term.power);
  }
  return out;
}

FractionalPolynomial collect_powers(FractionalPolynomial polynomial) {
  std::sort(polynomial.begin(), polynomial.end(),
            [](const FractionalPower& a, const FractionalPower& b) { return a.power < b.power; });
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

std::complex<double> FractionalTransfer::response(RadPerSecond w) const {
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

}  // namespace bodesmith
