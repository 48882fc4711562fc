#include <fmt/format.h>

#include <cmath>

#include "base/error.hpp"
#include "filters/design.hpp"
#include "filters/prototype_parts.hpp"
#include "lti/section_making.hpp"

namespace bodesmith::filters {
namespace {

using Complex = std::complex<double>;

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

}  // namespace

const char* to_string(Kind kind) {
  switch (kind) {
    case Kind::lowpass:
      return "lowpass";
    case Kind::highpass:
      return "highpass";
    case Kind::bandpass:
      return "bandpass";
    case Kind::bandstop:
      return "bandstop";
  }
  return "";
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

}  // namespace bodesmith::filters
