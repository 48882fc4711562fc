#include "approximate/approximation_error.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <stdexcept>

#include "base/units.hpp"
#include "base/whole_number.hpp"
#include "lti/judge_responses.hpp"
#include "numeric/elliptic_k.hpp"

namespace bodesmith {
namespace {

/// ln |H(jw)|: one logarithm for a section, whose ratios are taken root by root, so that nothing overflows.
double log_magnitude(const Section& section, RadPerSecond w) {
  const auto squared = [&](const Complex& root) {
    const double above = w.value - root.imag();
    return root.real() * root.real() + above * above;
  };
  double out = section.gain * section.gain;
  for (std::size_t i = 0; i < section.poles.size(); ++i)
    out *= (i < section.zeros.size() ? squared(section.zeros[i]) : 1.0) / squared(section.poles[i]);
  return 0.5 * std::log(out);
}

/// arg H(jw), each root's share by itself, so that it does not wrap: of a zero and a pole on the left the difference of two
/// angles within 90 degrees, which is that of their ratio.
double phase_rad(const Section& section, RadPerSecond w) {
  double out = section.gain < 0.0 ? std::numbers::pi : 0.0;
  const Complex s(0.0, w.value);
  for (std::size_t i = 0; i < std::max(section.zeros.size(), section.poles.size()); ++i) {
    const bool both = i < section.zeros.size() && i < section.poles.size();
    if (both && section.zeros[i].real() < 0.0 && section.poles[i].real() < 0.0) {
      const Complex zero = s - section.zeros[i];
      const Complex pole = s - section.poles[i];
      out += std::atan2(zero.imag() * pole.real() - zero.real() * pole.imag(),
                        zero.real() * pole.real() + zero.imag() * pole.imag());
      continue;
    }
    if (i < section.zeros.size()) out += std::arg(s - section.zeros[i]);
    if (i < section.poles.size()) out -= std::arg(s - section.poles[i]);
  }
  return out;
}

double error_db(const Sections& sections, const Cascade& cascade, RadPerSecond w) {
  double np = std::log(std::abs(sections.gain / cascade.gain));
  for (const Section& section : sections.sections) np += log_magnitude(section, w);
  for (const FractionalLeadLag& term : cascade.terms) np -= term.log_magnitude(w);
  return kDecibelPerNeper * np;
}
double error_deg(const Sections& sections, const Cascade& cascade, RadPerSecond w) {
  double rad = 0.0;
  for (const Section& section : sections.sections) rad += phase_rad(section, w);
  for (const FractionalLeadLag& term : cascade.terms) rad -= term.phase_rad(w);
  return to_degrees(rad);
}

/// Ends of the frequency axis, exactly.
double error_db_at_zero(const Sections& sections, const Cascade& cascade) {
  double np = std::log(std::abs(sections.gain / cascade.gain));
  for (const Section& section : sections.sections) np += std::log(std::abs(section.dc_gain()));
  return kDecibelPerNeper * np;
}
double error_db_at_infinity(const Sections& sections, const Cascade& cascade) {
  double np = std::log(std::abs(sections.gain / cascade.gain));
  for (const Section& section : sections.sections) np += std::log(std::abs(section.high_frequency_gain()));
  for (const FractionalLeadLag& term : cascade.terms) np += term.beta * std::log(term.x);
  return kDecibelPerNeper * np;
}

/// From the lowest to the highest corner of either.
Band common_corner_band(const Sections& sections, const Cascade& cascade) {
  Band band = cascade.corner_band();
  const Band corners = sections.corner_band();
  if (corners.to.value > 0.0) {
    band.from = std::min(band.from, corners.from);
    band.to = std::max(band.to, corners.to);
  }
  if (!(band.to.value > 0.0) || !std::isfinite(band.from.value)) return {Hertz{1.0}, Hertz{1.0}};
  return band;
}

}  // namespace

ApproximationError approximation_error(const Sections& sections, const Cascade& cascade) {
  ApproximationError out;
  out.band = common_corner_band(sections, cascade);
  // Beyond 100 times the corners nothing turns any more; in between the ripples are wider than the grid by
  // far.
  const double below = out.band.from.value / 100.0;
  const double above = out.band.to.value * 100.0;
  const int count = whole_number(120.0 * std::log10(above / below), 200, 4000);
  const auto grid = log_grid({Hertz{below}, Hertz{above}}, count);
  const auto level = [&](Hertz f) { return std::abs(error_db(sections, cascade, f.rad_s())); };
  const auto angle = [&](Hertz f) { return std::abs(error_deg(sections, cascade, f.rad_s())); };
  const auto visit_db = [&](double db, Hertz f) {
    if (db <= out.everywhere_db) return;
    out.everywhere_db = db;
    out.worst = f;
  };
  for (const Hertz f : grid) visit_db(level(f), f);
  visit_db(level(out.band.from), out.band.from);
  visit_db(level(out.band.to), out.band.to);
  // What lies between the points, in the band and everywhere.
  std::vector<Hertz> inside{out.band.from};
  for (const Hertz f : grid)
    if (f > out.band.from && f < out.band.to) inside.push_back(f);
  inside.push_back(out.band.to);
  out.band_db = refined_maximum(inside, level);
  out.band_deg = refined_maximum(inside, angle);
  out.everywhere_db = std::max(out.everywhere_db, refined_maximum(grid, level));
  out.everywhere_deg = std::max(out.band_deg, refined_maximum(grid, angle));
  visit_db(std::abs(error_db_at_zero(sections, cascade)), grid.front());
  visit_db(std::abs(error_db_at_infinity(sections, cascade)), grid.back());
  return out;
}

namespace {

/// ln Gamma(x), x > 0. The standard's own leaves its sign in a variable that all threads share.
double log_gamma(double x) {
  int sign = 0;
  return ::lgamma_r(x, &sign);
}

}  // namespace

double minimax_limit_db(double kappa, double beta, int n) {
  const double size = std::abs(beta);
  if (!(kappa > 1.0) || n < 0 || !(size < n + 1))
    throw std::domain_error("the limit law needs kappa > 1 and |beta| < n + 1");
  if (beta == std::round(beta)) return 0.0;
  const double k = 1.0 / kappa;
  // K(1/kappa) / K(sqrt(1 - kappa^-2))
  const auto ratio =
      static_cast<double>(complete_elliptic_k(std::sqrt((1.0 - k) * (1.0 + k))) / complete_elliptic_k(k));
  const double exponent =
      log_gamma(n + 1 + size) + log_gamma(n + 1 - size) - log_gamma(n + 0.5) - log_gamma(n + 1.5);
  return 2.0 * kDecibelPerNeper * std::abs(std::sin(std::numbers::pi * beta)) *
         std::exp(exponent - std::numbers::pi * (2 * n + 1) * ratio);
}

int minimax_order(double kappa, double beta, double max_db, int max_order) {
  for (int n = whole_number<int>(std::floor(std::abs(beta))); n <= max_order; ++n) {
    if (minimax_limit_db(kappa, beta, n) <= max_db) return n;
  }
  return max_order + 1;
}

}  // namespace bodesmith
