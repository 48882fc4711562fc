#include "filters/equalisers.hpp"

#include <fmt/format.h>

#include <cmath>

#include "base/error.hpp"
#include "filters/prototype_parts.hpp"
#include "lti/section_making.hpp"

namespace bodesmith::filters {
namespace {

void check_gain(double gain_db) {
  if (!(std::abs(gain_db) <= 200.0))
    throw InputError(fmt::format("a gain of {} dB, expected -200 to 200 dB", gain_db));
}

void check_corner_frequency(Hertz corner) {
  if (!(corner.value >= 1e-9 && corner.value <= 1e12)) {
    throw InputError(fmt::format("a corner of {} Hz, expected 1e-9 to 1e12 Hz", corner.value));
  }
}

/// Roots of s^2 + 2 zeta w0 s + w0^2.
std::vector<Complex> pair_of(double w0, double zeta) {
  if (zeta >= 1.0) {
    const double large = -w0 * (zeta + std::sqrt((zeta - 1.0) * (zeta + 1.0)));
    return {{large, 0.0}, {w0 * (w0 / large), 0.0}};
  }
  const Complex root(-zeta * w0, w0 * std::sqrt((1.0 - zeta) * (1.0 + zeta)));
  return {root, std::conj(root)};
}

Sections one_section(double gain, std::vector<Complex> zeros, std::vector<Complex> poles) {
  Sections out;
  out.sections = {Section{gain, std::move(zeros), std::move(poles)}};
  return out;
}

}  // namespace

Sections peaking(Hertz centre, double gain_db, double quality) {
  check_corner_frequency(centre);
  check_gain(gain_db);
  if (!(quality >= 1e-6 && quality <= 1e6)) {
    throw InputError(fmt::format("a Q of {}, expected 1e-6 to 1e6", quality));
  }
  const double amplitude = from_decibel(0.5 * gain_db);
  const double w0 = centre.rad_s().value;
  return one_section(1.0, pair_of(w0, 0.5 * amplitude / quality), pair_of(w0, 0.5 / (amplitude * quality)));
}

Sections low_shelf(Hertz corner, double gain_db) {
  check_corner_frequency(corner);
  check_gain(gain_db);
  const double root = from_decibel(0.5 * gain_db);
  const double w = corner.rad_s().value;
  return one_section(1.0, {{-w * root, 0.0}}, {{-w / root, 0.0}});
}

Sections high_shelf(Hertz corner, double gain_db) {
  check_corner_frequency(corner);
  check_gain(gain_db);
  const double root = from_decibel(0.5 * gain_db);
  const double w = corner.rad_s().value;
  return one_section(from_decibel(gain_db), {{-w / root, 0.0}}, {{-w * root, 0.0}});
}

Sections delay_allpass(double delay_s, int order) {
  if (!(delay_s >= 1e-12 && delay_s <= 1e9)) {
    throw InputError(fmt::format("a delay of {} s, expected 1e-12 to 1e9 s", delay_s));
  }
  if (order < 1 || order > 20)
    throw InputError(fmt::format("order {} of an all-pass, expected 1 to 20", order));
  std::vector<Complex> poles = bessel_poles(order);
  std::vector<Complex> zeros;
  for (Complex& p : poles) {
    p *= 2.0 / delay_s;
    zeros.push_back(-std::conj(p));
  }
  return make_sections(order % 2 == 0 ? 1.0 : -1.0, zeros, poles);
}

}  // namespace bodesmith::filters
