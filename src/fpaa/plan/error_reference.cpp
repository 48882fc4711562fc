#include "fpaa/plan/error_reference.hpp"

#include <algorithm>
#include <cmath>

namespace bodesmith::fpaa {
namespace {

constexpr double kFar = 30.0;  ///< outside a stated band

}  // namespace

double error_reference(const Sections& sections, RadPerSecond w) {
  const Complex s(0.0, w.value);
  double out = std::abs(sections.gain);
  for (const Section& section : sections.sections) {
    out *= std::abs(section.gain);
    for (const auto& zero : section.zeros) {
      out *= std::max(std::abs(s - zero), kLeastZeroDamping * std::abs(zero));
    }
    for (const auto& pole : section.poles) out /= std::abs(s - pole);
  }
  return out;
}

bool is_near_zero(const Sections& sections, RadPerSecond w) {
  const Complex s(0.0, w.value);
  for (const Section& section : sections.sections) {
    for (const auto& zero : section.zeros) {
      if (std::abs(s - zero) < kLeastZeroDamping * std::abs(zero)) return true;
    }
  }
  return false;
}

Band judged_band(const Sections& sections) {
  Band corners = sections.corner_band();
  if (sections.error && sections.error->band.from.value > 0.0) {
    const Band stated = sections.error->band;
    corners = stated;
    for (const Section& section : sections.sections) {
      for (const auto* roots : {&section.zeros, &section.poles}) {
        for (const auto& root : *roots) {
          const double f = RadPerSecond{std::abs(root)}.hz().value;
          if (f * kFar < stated.from.value || f > kFar * stated.to.value) continue;
          corners.from.value = std::min(corners.from.value, f);
          corners.to.value = std::max(corners.to.value, f);
        }
      }
    }
  }
  // One corner is no band: a decade of what passes, an octave of what falls off (a decade of which is a millionth at order 6).
  if (corners.to.value < 2.0 * corners.from.value) {
    std::vector<Complex> zeros;
    for (const Section& section : sections.sections)
      zeros.insert(zeros.end(), section.zeros.begin(), section.zeros.end());
    const bool falls_low = std::ranges::count(zeros, Complex(0.0)) > 0;
    const bool falls_high = sections.pole_count() > static_cast<int>(zeros.size());
    return {{corners.from.value / (falls_low ? 2.0 : 10.0)}, {corners.to.value * (falls_high ? 2.0 : 10.0)}};
  }
  return corners;
}

std::vector<Hertz> about_sharp_roots(const Sections& sections, Band band) {
  constexpr double kSharp = 0.2;  // width over frequency; wider ones the grid sees
  constexpr double kWidths[] = {-3.0, -1.0, -0.4, 0.0, 0.4, 1.0, 3.0};
  std::vector<Hertz> out;
  for (const Section& section : sections.sections) {
    for (const auto* roots : {&section.zeros, &section.poles}) {
      for (const Complex& root : *roots) {
        const double size = std::abs(root);
        const double damping = std::max(std::abs(root.real()) / size, kLeastZeroDamping);
        if (root.imag() <= 0.0 || damping > kSharp) continue;
        for (const double widths : kWidths) {
          const Hertz f = RadPerSecond{root.imag() + widths * damping * size}.hz();
          if (f >= band.from && f <= band.to) out.push_back(f);
        }
      }
    }
  }
  return out;
}

}  // namespace bodesmith::fpaa
