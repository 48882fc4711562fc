#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.hpp"
#include "filters/design.hpp"
#include "filters/prototype_parts.hpp"
#include "lti/section_making.hpp"

namespace bodesmith::filters {
namespace {

/// Both roots of s^2 - 2 h s + w0^2, the smaller one without cancellation.
void add_band_roots(std::vector<Complex>& roots, Complex h, double w0) {
  // h^2 - w0^2 as a product keeps narrow bands exact.
  Complex root = std::sqrt(h - w0) * std::sqrt(h + w0);
  if (std::real(std::conj(h) * root) < 0.0) root = -root;
  const Complex large = h + root;
  roots.push_back(large);
  roots.push_back(w0 * (w0 / large));
}

struct Placed {
  double gain = 1.0;
  std::vector<Complex> zeros;
  std::vector<Complex> poles;
};

/// Exact conjugates (and real roots exactly real) after the arithmetic of a transformation.
std::vector<Complex> mirrored(const std::vector<Complex>& roots) {
  std::vector<Complex> out;
  for (const Complex& r : roots) {
    const bool real = std::abs(r.imag()) <= 1e-14 * std::abs(r);
    if (real) out.emplace_back(r.real(), 0.0);
    if (!real && r.imag() > 0.0) add_pair(out, r);
  }
  return out;
}

Placed lowpass(const Prototype& p, double corner) {
  Placed out;
  for (const Complex& z : p.zeros) out.zeros.push_back(z * corner);
  for (const Complex& q : p.poles) out.poles.push_back(q * corner);
  out.gain = p.gain * std::pow(corner, static_cast<double>(p.poles.size() - p.zeros.size()));
  return out;
}

Placed highpass(const Prototype& p, double corner) {
  Placed out;
  for (const Complex& z : p.zeros) out.zeros.push_back(corner / z);
  for (const Complex& q : p.poles) out.poles.push_back(corner / q);
  out.zeros.resize(out.poles.size(), 0.0);
  out.gain = p.gain * product_of_negatives(p.zeros) / product_of_negatives(p.poles);
  return out;
}

Placed bandpass(const Prototype& p, double w0, double width) {
  Placed out;
  for (const Complex& z : p.zeros) add_band_roots(out.zeros, 0.5 * width * z, w0);
  for (const Complex& q : p.poles) add_band_roots(out.poles, 0.5 * width * q, w0);
  const std::size_t excess = p.poles.size() - p.zeros.size();
  out.zeros.resize(out.zeros.size() + excess, 0.0);
  out.gain = p.gain * std::pow(width, static_cast<double>(excess));
  return out;
}

Placed bandstop(const Prototype& p, double w0, double width) {
  Placed out;
  for (const Complex& z : p.zeros) add_band_roots(out.zeros, 0.5 * width / z, w0);
  for (const Complex& q : p.poles) add_band_roots(out.poles, 0.5 * width / q, w0);
  while (out.zeros.size() < out.poles.size()) add_pair(out.zeros, {0.0, w0});
  out.gain = p.gain * product_of_negatives(p.zeros) / product_of_negatives(p.poles);
  return out;
}

Placed transformed(const Prototype& prototype, const Placing& placing) {
  const double low = placing.corner.from.rad_s().value;
  const double high = placing.corner.to.rad_s().value;
  const double w0 = std::sqrt(low) * std::sqrt(high);
  switch (placing.kind) {
    case Kind::lowpass:
      return lowpass(prototype, low);
    case Kind::highpass:
      return highpass(prototype, low);
    case Kind::bandpass:
      return bandpass(prototype, w0, high - low);
    case Kind::bandstop:
      return bandstop(prototype, w0, high - low);
  }
  return {};
}

void check_corner(const Placing& placing) {
  const auto usable = [](Hertz f) { return std::isfinite(f.value) && f.value >= 1e-9 && f.value <= 1e12; };
  if (!usable(placing.corner.from)) {
    throw InputError(fmt::format("a corner of {} Hz, expected 1e-9 to 1e12 Hz", placing.corner.from.value));
  }
  if (placing.kind == Kind::lowpass || placing.kind == Kind::highpass) return;
  if (!usable(placing.corner.to) || !(placing.corner.to > placing.corner.from)) {
    throw InputError(fmt::format("a band from {} to {} Hz, expected rising corners of 1e-9 to 1e12 Hz",
                                 placing.corner.from.value, placing.corner.to.value));
  }
}

/// |prototype frequency| of a band edge when the pass band's edges lie at 1.
double selectivity_at(const Band& pass, Hertz edge) {
  const double square = pass.from.value * pass.to.value;
  const double w = edge.value;
  return std::abs(w * w - square) / ((pass.to.value - pass.from.value) * w);
}

/// How far the stop band's nearer edge lies from the pass band's, as a ratio of prototype frequencies.
double selectivity(const Mask& mask) {
  switch (mask.kind) {
    case Kind::lowpass:
      return mask.stop.from.value / mask.pass.from.value;
    case Kind::highpass:
      return mask.pass.from.value / mask.stop.from.value;
    case Kind::bandpass:
      return std::min(selectivity_at(mask.pass, mask.stop.from), selectivity_at(mask.pass, mask.stop.to));
    case Kind::bandstop:
      return 1.0 /
             std::max(selectivity_at(mask.pass, mask.stop.from), selectivity_at(mask.pass, mask.stop.to));
  }
  return 0.0;
}

void check_mask(const Mask& mask) {
  const auto above_zero = [](double value) { return std::isfinite(value) && value > 0.0; };
  const bool band = mask.kind == Kind::bandpass || mask.kind == Kind::bandstop;
  bool fine = above_zero(mask.pass.from.value) && above_zero(mask.stop.from.value);
  if (band) {
    const Band& outer = mask.kind == Kind::bandpass ? mask.stop : mask.pass;
    const Band& inner = mask.kind == Kind::bandpass ? mask.pass : mask.stop;
    fine = fine && outer.from < inner.from && inner.from < inner.to && inner.to < outer.to;
  } else {
    fine = fine &&
           (mask.kind == Kind::lowpass ? mask.pass.from < mask.stop.from : mask.stop.from < mask.pass.from);
  }
  if (!fine) {
    throw InputError(fmt::format(
        "pass and stop band of this {} lie the wrong way round or overlap, expected every edge above 0 Hz and the {}",
        to_string(mask.kind),
        mask.kind == Kind::lowpass    ? "stop band above the pass band"
        : mask.kind == Kind::highpass ? "stop band below the pass band"
        : mask.kind == Kind::bandpass ? "pass band inside the stop edges"
                                      : "stop band inside the pass edges"));
  }
  if (!above_zero(mask.ripple_db) || !above_zero(mask.stop_db) || mask.stop_db <= mask.ripple_db) {
    throw InputError(
        fmt::format("a mask of {} dB in the pass band and {} dB in the stop band, expected both above 0 "
                    "and the second larger",
                    mask.ripple_db, mask.stop_db));
  }
}

/// The frequency at which a monotone prototype has fallen by so much.
double frequency_of_attenuation(const Prototype& prototype, double db) {
  double low = 1e-6;
  double high = 1e6;
  for (int i = 0; i < 200; ++i) {
    const double middle = std::sqrt(low * high);
    (prototype.attenuation_db(middle) < db ? low : high) = middle;
  }
  return std::sqrt(low * high);
}

/// The edge of the pass band in the prototype's frequency.
double pass_edge(const Family& family, const Prototype& prototype, const Mask& mask) {
  if (family.corner() == Family::Corner::ripple_edge) return 1.0;
  return frequency_of_attenuation(prototype, mask.ripple_db);
}

/// Places the prototype so that the pass band's edges get the attenuation of `edge`.
Placing placing_of(const Mask& mask, double edge) {
  Placing out{mask.kind, mask.pass};
  switch (mask.kind) {
    case Kind::lowpass:
      out.corner.from.value /= edge;
      break;
    case Kind::highpass:
      out.corner.from.value *= edge;
      break;
    case Kind::bandpass:
    case Kind::bandstop: {
      // The same centre, another width: f2 - f1 = width, f1 f2 = centre^2.
      const double square = mask.pass.from.value * mask.pass.to.value;
      double width = mask.pass.to.value - mask.pass.from.value;
      width = mask.kind == Kind::bandpass ? width / edge : width * edge;
      const double from = std::sqrt(square + 0.25 * width * width) - 0.5 * width;
      out.corner = {Hertz{square / (from + width)}, Hertz{from + width}};
      break;
    }
  }
  return out;
}

}  // namespace

const char* to_string(Kind kind) {
  constexpr std::array kWords = {"lowpass", "highpass", "bandpass", "bandstop"};
  return kWords.at(static_cast<std::size_t>(kind));
}

Sections place(const Prototype& prototype, const Placing& placing) {
  check_corner(placing);
  const Placed placed = transformed(prototype, placing);
  if (!std::isfinite(placed.gain) || std::abs(placed.gain) < 1e-300) {
    throw InputError(fmt::format("{} poles with corners at {} Hz leave the range of numbers",
                                 placed.poles.size(), placing.corner.from.value));
  }
  return make_sections(placed.gain, mirrored(placed.zeros), mirrored(placed.poles));
}

MaskedDesign least_order(const Family& family, const Mask& mask) {
  check_mask(mask);
  const double ratio = selectivity(mask);
  const int step = family.only_even() ? 2 : 1;
  for (int order = step; order <= family.highest_order(); order += step) {
    MaskedDesign out;
    out.order = order;
    out.prototype = make_prototype(family, {order, mask.ripple_db, mask.stop_db});
    const double edge = pass_edge(family, out.prototype, mask);
    out.ripple_db = mask.ripple_db;
    out.stop_db = out.prototype.attenuation_db(edge * ratio);
    const bool from_stop_edge = family.corner() == Family::Corner::stop_edge;
    const bool kept = from_stop_edge ? edge * ratio >= 1.0 : out.stop_db >= mask.stop_db * (1.0 - 1e-12);
    if (!kept) continue;
    out.placing = placing_of(mask, edge);
    return out;
  }
  throw DesignError(
      fmt::format("no {} filter up to order {} keeps this mask: expected a wider gap between the bands "
                  "than {:.6g} to 1, less attenuation or another family",
                  family.name(), family.highest_order(), ratio));
}

}  // namespace bodesmith::filters
