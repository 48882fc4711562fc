#include <cmath>

#include "filters/prototype_parts.hpp"

namespace bodesmith::filters {
namespace {

/// Poles of a Butterworth filter with its circle drawn out to an ellipse of these half axes, in the left half-plane.
std::vector<Complex> ellipse_poles(int order, double real = 1.0, double imaginary = 1.0) {
  std::vector<Complex> out;
  for (const Complex& point : upper_unit_points(order))
    add_pair(out, {-real * point.imag(), imaginary * point.real()});
  if (order % 2 != 0) out.emplace_back(-real, 0.0);
  return out;
}

/// eps^2 = 10^(decibel/10) - 1.
double over_one(double decibel) {
  return std::expm1(decibel * std::log(10.0) / 10.0);
}

/// |H(jw)|^2 = 1/(1 + w^(2N)) (S. Butterworth, "On the theory of filter amplifiers", 1930).
class Butterworth final : public Family {
 public:
  std::string_view name() const override { return "butterworth"; }
  std::string_view what() const override { return "flat as long as possible; corner = -3 dB"; }
  Prototype prototype(const PrototypeTask& task) const override {
    return {.gain = 1.0, .zeros = {}, .poles = ellipse_poles(task.order)};
  }
};

/// A Butterworth filter of half the order, squared: low pass and high pass of one corner add up to an all-pass
/// (S. H. Linkwitz, "Active crossover networks for noncoincident drivers", 1976).
class LinkwitzRiley final : public Family {
 public:
  std::string_view name() const override { return "linkwitz-riley"; }
  std::string_view what() const override { return "crossovers that add up to an all-pass; corner = -6 dB"; }
  Corner corner() const override { return Corner::six_db; }
  bool only_even() const override { return true; }
  Prototype prototype(const PrototypeTask& task) const override {
    std::vector<Complex> poles = ellipse_poles(task.order / 2);
    const std::vector<Complex> once = poles;
    poles.insert(poles.end(), once.begin(), once.end());
    return {.gain = 1.0, .zeros = {}, .poles = std::move(poles)};
  }
};

/// |H(jw)|^2 = 1/(1 + eps^2 T_N(w)^2), eps^2 = 10^(ripple/10) - 1; poles -sinh(mu + j theta), mu = asinh(1/eps)/N.
class Chebyshev1 final : public Family {
 public:
  std::string_view name() const override { return "chebyshev1"; }
  std::string_view what() const override { return "equal ripple in the pass band; corner = its edge"; }
  Corner corner() const override { return Corner::ripple_edge; }
  bool has_ripple() const override { return true; }
  Prototype prototype(const PrototypeTask& task) const override {
    const double epsilon = std::sqrt(over_one(task.ripple_db));
    const double mu = std::asinh(1.0 / epsilon) / task.order;
    Prototype out = all_pole(ellipse_poles(task.order, std::sinh(mu), std::cosh(mu)));
    if (task.order % 2 == 0) out.gain /= std::hypot(1.0, epsilon);
    return out;
  }
};

/// |H(jw)|^2 = 1/(1 + 1/(d^2 T_N(1/w)^2)), d^2 = 1/(10^(stop/10) - 1): poles are the reciprocals of Chebyshev poles,
/// zeros those of the polynomial's own.
class Chebyshev2 final : public Family {
 public:
  std::string_view name() const override { return "chebyshev2"; }
  std::string_view what() const override { return "equal ripple in the stop band; corner = its edge"; }
  Corner corner() const override { return Corner::stop_edge; }
  bool has_stop() const override { return true; }
  Prototype prototype(const PrototypeTask& task) const override {
    const double mu = std::asinh(std::sqrt(over_one(task.stop_db))) / task.order;
    Prototype out;
    out.poles = ellipse_poles(task.order, std::sinh(mu), std::cosh(mu));
    for (Complex& pole : out.poles) pole = pole.imag() == 0.0 ? 1.0 / pole.real() : 1.0 / pole;
    for (const Complex& point : upper_unit_points(task.order)) add_pair(out.zeros, {0.0, 1.0 / point.real()});
    out.gain = product_of_negatives(out.poles) / product_of_negatives(out.zeros);
    return out;
  }
};

}  // namespace

BODESMITH_ENTRY(Family, butterworth_family, Butterworth)
BODESMITH_ENTRY(Family, linkwitz_riley_family, LinkwitzRiley)
BODESMITH_ENTRY(Family, chebyshev1_family, Chebyshev1)
BODESMITH_ENTRY(Family, chebyshev2_family, Chebyshev2)

}  // namespace bodesmith::filters
