#include "exchange/discretise.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "base/error.hpp"
#include "base/text.hpp"
#include "lti/judge_responses.hpp"

namespace bodesmith::exchange {
namespace {

/// z^-1 polynomial 1 + c1/z + c2/z^2 of up to two roots that are real or a conjugate pair.
std::array<double, 3> polynomial(const std::vector<Complex>& roots) {
  if (roots.empty()) return {1.0, 0.0, 0.0};
  if (roots.size() == 1) return {1.0, -roots[0].real(), 0.0};
  return {1.0, -(roots[0] + roots[1]).real(), (roots[0] * roots[1]).real()};
}

Complex response_of(const Biquad& q, Complex z) {
  const Complex d = 1.0 / z;
  return (q.b0 + d * (q.b1 + d * q.b2)) / (1.0 + d * (q.a1 + d * q.a2));
}

Biquad from_roots(double gain, const std::vector<Complex>& zeros, const std::vector<Complex>& poles) {
  const auto b = polynomial(zeros);
  const auto a = polynomial(poles);
  return {gain * b[0], gain * b[1], gain * b[2], a[1], a[2]};
}

double tustin_constant(const Section& section, const DiscretiseOptions& options) {
  const double step = 1.0 / options.sample_hz;
  double w = options.prewarp ? options.prewarp->rad_s().value : 0.0;
  if (!options.prewarp) {
    double product = 1.0;
    for (const Complex& p : section.poles) product *= std::abs(p);
    w = std::pow(product, 1.0 / static_cast<double>(section.poles.size()));
  }
  // A corner near or above half the sampling rate cannot be met.
  if (!(w > 0.0) || w * step > 0.9 * std::numbers::pi) return 2.0 / step;
  return w / std::tan(0.5 * w * step);
}

Biquad tustin(const Section& section, const DiscretiseOptions& options) {
  const double k = tustin_constant(section, options);
  Complex gain = section.gain;
  std::vector<Complex> zeros;
  std::vector<Complex> poles;
  for (const Complex& s : section.zeros) {
    gain *= k - s;
    zeros.push_back((k + s) / (k - s));
  }
  for (const Complex& s : section.poles) {
    gain /= k - s;
    poles.push_back((k + s) / (k - s));
  }
  zeros.resize(poles.size(), -1.0);
  return from_roots(gain.real(), zeros, poles);
}

/// Where a matched section has its gain.
Hertz match_frequency(const Section& section, const DiscretiseOptions& options) {
  if (options.prewarp) return *options.prewarp;
  const double dc = section.dc_gain();
  if (std::isfinite(dc) && dc != 0.0) return Hertz{0.0};
  double highest = 0.0;
  for (const Complex& p : section.poles) highest = std::max(highest, std::abs(p));
  return Hertz{
      std::clamp(RadPerSecond{highest}.hz().value, options.sample_hz * 1e-4, options.sample_hz / 8.0)};
}

Biquad matched(const Section& section, const DiscretiseOptions& options) {
  std::vector<Complex> zeros;
  std::vector<Complex> poles;
  for (const Complex& s : section.zeros) zeros.push_back(std::exp(s / options.sample_hz));
  for (const Complex& s : section.poles) poles.push_back(std::exp(s / options.sample_hz));
  zeros.resize(poles.size(), -1.0);
  Biquad q = from_roots(1.0, zeros, poles);
  const Hertz f = match_frequency(section, options);
  const Complex z = std::polar(1.0, 2.0 * std::numbers::pi * f.value / options.sample_hz);
  const Complex ratio = section.response(f.rad_s()) / response_of(q, z);
  const double gain = std::copysign(std::abs(ratio), ratio.real());
  q.b0 *= gain;
  q.b1 *= gain;
  q.b2 *= gain;
  return q;
}

void round_to_single(DigitalFilter& filter) {
  const auto round = [](double& value) { value = static_cast<double>(static_cast<float>(value)); };
  round(filter.gain);
  for (Biquad& q : filter.biquads) {
    for (double* value : {&q.b0, &q.b1, &q.b2, &q.a1, &q.a2}) round(*value);
  }
}

/// The gain goes into the first section's numerator.
void round_to_fixed(DigitalFilter& filter, int bits) {
  if (filter.biquads.empty()) filter.biquads.emplace_back();
  Biquad& first = filter.biquads.front();
  for (double* value : {&first.b0, &first.b1, &first.b2}) *value *= filter.gain;
  filter.gain = 1.0;
  double greatest = 0.0;
  const auto each = [&](const auto& act) {
    for (Biquad& q : filter.biquads) {
      for (double* value : {&q.b0, &q.b1, &q.b2, &q.a1, &q.a2}) act(*value);
    }
  };
  each([&](double value) { greatest = std::max(greatest, std::abs(value)); });
  // The sign takes one bit.
  filter.fraction_bits = bits - 1 - std::max(std::ilogb(std::max(greatest, 0.5)) + 1, 0);
  if (filter.fraction_bits < 1)
    throw InputError(
        fmt::format("a coefficient of {} leaves no bits behind the point of {}, expected more bits",
                    rounded_text(greatest, 4), bits));
  each([&](double& value) {
    value = std::ldexp(std::nearbyint(std::ldexp(value, filter.fraction_bits)), -filter.fraction_bits);
  });
}

bool is_stable(const Biquad& q) {
  return std::abs(q.a2) < 1.0 && std::abs(q.a1) < 1.0 + q.a2;
}

DigitalFilter::Error error_of(const DigitalFilter& filter, const Sections& sections) {
  Band band;
  const Band corners = sections.corner_band();
  const double limit = 0.45 * filter.sample_hz;
  const bool flat = !(corners.to.value > 0.0);
  band.to = Hertz{flat ? limit : std::min(limit, 10.0 * corners.to.value)};
  band.from = Hertz{flat ? limit * 1e-3 : std::min(0.1 * corners.from.value, 0.5 * band.to.value)};
  const auto wanted = [&sections](RadPerSecond w) {
    const Complex s(0.0, w.value);
    return sections.response(s) * std::exp(s * sections.delay_s);
  };
  const auto got = [&filter](RadPerSecond w) { return filter.response(w.hz()); };
  const bool steep = has_flanks([&](Hertz f) { return wanted(f.rad_s()); }, band);
  return {judge_responses(at_each(got), at_each(wanted), band), band, steep ? kFlanksText : ""};
}

}  // namespace

std::string_view to_string(Discretisation method) {
  return method == Discretisation::tustin ? "tustin" : "matched";
}

Complex DigitalFilter::response(Hertz f) const {
  const Complex z = std::polar(1.0, 2.0 * std::numbers::pi * f.value / sample_hz);
  Complex out = gain;
  for (const Biquad& q : biquads) out *= response_of(q, z);
  return out;
}

DigitalFilter discretise(const Sections& sections, const DiscretiseOptions& options) {
  const Hertz lowest = sections.corner_band().from;
  if (!(options.sample_hz > 2.0 * lowest.value))
    throw InputError(fmt::format("the sampling rate of {} Hz is not above twice the lowest corner, {} Hz",
                                 rounded_text(options.sample_hz, 6), rounded_text(lowest.value, 6)));
  if (options.prewarp && !(options.prewarp->value < 0.5 * options.sample_hz))
    throw InputError(
        fmt::format("{} Hz cannot be met exactly at a sampling rate of {} Hz, expected below half of it",
                    rounded_text(options.prewarp->value, 6), rounded_text(options.sample_hz, 6)));
  DigitalFilter out;
  out.gain = sections.gain;
  out.sample_hz = options.sample_hz;
  out.method = options.method;
  for (const Section& section : sections.sections) {
    out.biquads.push_back(options.method == Discretisation::tustin ? tustin(section, options)
                                                                   : matched(section, options));
  }
  if (options.single_precision) round_to_single(out);
  for (std::size_t i = 0; i < out.biquads.size(); ++i) {
    const Biquad& q = out.biquads[i];
    if (!std::isfinite(q.b0 + q.b1 + q.b2 + q.a1 + q.a2))
      throw InputError(fmt::format("section {} has a root that {} at {} Hz takes beyond all numbers", i + 1,
                                   to_string(options.method), rounded_text(options.sample_hz, 6)));
  }
  if (options.fixed_bits > 0) round_to_fixed(out, options.fixed_bits);
  for (std::size_t i = 0; i < out.biquads.size(); ++i) {
    if (!is_stable(out.biquads[i]) && sections.sections[i].is_stable())
      throw InputError(
          fmt::format("section {} has a pole that rounding puts on the unit circle at {} Hz: a lower rate "
                      "or more bits a coefficient",
                      i + 1, rounded_text(options.sample_hz, 6)));
  }
  out.error = error_of(out, sections);
  return out;
}

}  // namespace bodesmith::exchange
