#include "fpaa/filter_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"

namespace bodesmith::fpaa {
namespace {

/// Positive corner frequencies of real left-half-plane roots, ascending.
std::vector<double> corners(const std::vector<std::complex<double>>& roots, int number, const char* what) {
  std::vector<double> out;
  for (const auto& root : roots) {
    if (root.imag() != 0.0) {
      throw DesignError(
          fmt::format("section {} has complex {}s, which the FilterBilinear CAM cannot make and the "
                      "FilterBiquad only with nothing but zeros at 0, expected real ones "
                      "(fit with --real, or make this section with spice)",
                      number, what));
    }
    if (root.real() > 0.0) {
      throw DesignError(
          fmt::format("section {} has a {} in the right half plane (s = {:.6g} rad/s), expected Re s <= 0: "
                      "capacitors are not negative",
                      number, what, root.real()));
    }
    out.push_back(-root.real());
  }
  std::sort(out.begin(), out.end());
  return out;
}

/// A complex pair with nothing but zeros at s = 0.
FilterPart biquad_part(const Section& section, int number, double& log_gain) {
  for (const auto& zero : section.zeros) {
    if (zero == 0.0) continue;
    throw DesignError(
        fmt::format("section {} has complex poles and a zero that is not at s = 0; the FilterBiquad's "
                    "pole-and-zero form is not "
                    "publicly known, expected real poles (fit with --real), no zeros, zeros at 0, or this "
                    "section made with spice",
                    number));
  }
  using Kind = BiquadCapacitors::Kind;
  FilterPart part;
  part.kind = FilterPart::Kind::biquad;
  part.section = number - 1;
  part.name = fmt::format("Section{}", number);
  const double natural = std::abs(section.poles[0]);
  part.biquad.natural = {natural};
  part.biquad.quality = natural / (-2.0 * section.poles[0].real());
  part.biquad.kind = section.zeros.empty()       ? Kind::low_pass
                     : section.zeros.size() == 1 ? Kind::band_pass
                                                 : Kind::high_pass;
  log_gain += std::log(std::abs(section.gain));
  if (part.biquad.kind == Kind::low_pass) log_gain -= 2.0 * std::log(natural);
  if (part.biquad.kind == Kind::band_pass) log_gain += std::log(part.biquad.quality / natural);
  return part;
}

double width(double zero, double pole) {
  return zero > 0.0 ? std::abs(std::log(zero / pole)) : 0.0;
}

}  // namespace

std::complex<double> FilterPart::response(RadPerSecond w) const {
  if (kind == Kind::biquad) return biquad.response(w);
  const std::complex<double> s(0.0, w.value);
  const std::complex<double> below = 1.0 + s / pole.value;
  switch (kind) {
    case Kind::pole_zero:
      return (1.0 + s / zero.value) / below;
    case Kind::high_pass:
      return s / below;
    case Kind::low_pass:
    case Kind::biquad:
      break;
  }
  return 1.0 / below;
}

FilterParts split_into_parts(const Sections& sections) {
  FilterParts out;
  double gain = sections.gain;
  out.negative = gain < 0.0;
  out.log_gain = std::log(std::abs(gain));
  for (size_t i = 0; i < sections.sections.size(); ++i) {
    const Section& section = sections.sections[i];
    const int number = static_cast<int>(i) + 1;
    if (section.poles[0].imag() != 0.0) {
      out.parts.push_back(biquad_part(section, number, out.log_gain));
      out.negative = out.negative != (section.gain < 0.0);
      continue;
    }
    std::vector<double> poles = corners(section.poles, number, "pole");
    const std::vector<double> zeros = corners(section.zeros, number, "zero");
    out.negative = out.negative != (section.gain < 0.0);
    out.log_gain += std::log(std::abs(section.gain));
    for (const double pole : poles) out.log_gain -= std::log(pole);
    for (const double zero : zeros) {
      if (zero > 0.0) out.log_gain += std::log(zero);
    }
    // Two and two: ascending with ascending is the pairing whose widest pair is narrowest. One and two: the
    // zero takes the nearer pole.
    if (zeros.size() == 1 && poles.size() == 2 && width(zeros[0], poles[1]) < width(zeros[0], poles[0])) {
      std::swap(poles[0], poles[1]);
    }
    for (size_t k = 0; k < poles.size(); ++k) {
      FilterPart part;
      part.section = static_cast<int>(i);
      part.name = fmt::format("Section{}{}", number, poles.size() == 1 ? "" : k == 0 ? "a" : "b");
      part.pole = {poles[k]};
      if (k >= zeros.size()) {
        part.kind = FilterPart::Kind::low_pass;
      } else if (zeros[k] == 0.0) {
        part.kind = FilterPart::Kind::high_pass;
      } else {
        part.kind = FilterPart::Kind::pole_zero;
        part.zero = {zeros[k]};
      }
      out.parts.push_back(part);
    }
  }
  return out;
}

}  // namespace bodesmith::fpaa
