#include "circuit/ladders/fractional_element.hpp"

#include <fmt/format.h>

#include <cmath>

#include "circuit/ladders/two_terminal_network.hpp"

namespace bodesmith::circuit {
namespace {

using Real = long double;

RcImpedance oustaloup(double alpha, double q, Band band, int order) {
  const Real low = static_cast<Real>(band.from.rad_s().value) / 10.0L;
  const Real high = static_cast<Real>(band.to.rad_s().value) * 10.0L;
  RcImpedance out;
  for (int k = 1; k <= order; ++k) {
    const auto at = [&](Real shift) {
      return static_cast<double>(low * std::pow(high / low, (k - 0.5L + shift) / order));
    };
    out.poles.push_back(at(-0.5L * alpha));
    out.zeros.push_back(at(0.5L * alpha));
  }
  out.high = static_cast<double>(std::pow(high, -static_cast<Real>(alpha)) / q);
  return out;
}

}  // namespace

std::complex<double> FractionalElement::ideal(RadPerSecond w) const {
  return 1.0 / (q * std::pow(std::complex<double>(0.0, w.value), alpha));
}

std::complex<double> FractionalElement::impedance(RadPerSecond w) const {
  std::vector<TwoTerminalPart> network;
  for (const Part& part : parts) network.push_back({part.resistor, part.from, part.to, part.realised});
  return impedance_between(network, "a", "b", w);
}

std::string FractionalElement::subcircuit(const std::string& name) const {
  std::string out = fmt::format("* 1/(Q s^alpha), alpha = {}, Q = {:.6g}\n.subckt {} a b\n", alpha, q, name);
  for (const Part& part : parts)
    out += fmt::format("{} {} {} {:.12g}\n", part.name, part.from, part.to, part.realised);
  return out + ".ends " + name + "\n";
}

Outcome<FractionalElement> try_fractional_element(double alpha, double q, Band band, int order,
                                                  const RcLadder& ladder, const Series& resistors,
                                                  const Series& capacitors) {
  if (!(alpha > 0.0) || !(alpha < 1.0))
    return Refusal{fmt::format("alpha is {}, expected 0 to 1, both left out", alpha)};
  if (!(q > 0.0)) return Refusal{fmt::format("Q is {}, expected a value above 0", q)};
  if (order < 1 || order > 12)
    return Refusal{fmt::format("{} RC pairs were asked for, expected 1 to 12", order)};
  if (!(band.from.value > 0.0) || !(band.to > band.from))
    return Refusal{"the band is empty, expected 0 < from < to"};
  FractionalElement out;
  out.alpha = alpha;
  out.q = q;
  out.band = band;
  for (const LadderPart& drawn : ladder.parts(oustaloup(alpha, q, band, order))) {
    FractionalElement::Part part{drawn.resistor, drawn.name, drawn.from, drawn.to, drawn.value, drawn.value};
    if (!(part.wanted > 0.0) || !std::isfinite(part.wanted)) {
      return Refusal{fmt::format(
          "{} comes out as {}: the continued fraction is ill-conditioned, expected a lower order or a "
          "Foster form",
          part.name, part.wanted)};
    }
    part.realised = (part.resistor ? resistors : capacitors).nearest(part.wanted);
    out.parts.push_back(std::move(part));
  }
  return out;
}

FractionalElement make_fractional_element(double alpha, double q, Band band, int order,
                                          const RcLadder& ladder, const Series& resistors,
                                          const Series& capacitors) {
  return value_or_throw(try_fractional_element(alpha, q, band, order, ladder, resistors, capacitors));
}

}  // namespace bodesmith::circuit
