#include "synthesis/circuit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "base/text.hpp"
#include "numeric/quadratic_roots.hpp"
#include "schematic/writers/parts_table.hpp"
#include "signal/csv.hpp"

namespace bodesmith::synthesis {
namespace {

bool states_a_band(const Sections& sections) {
  return sections.error && sections.error->band.from.value > 0.0 &&
         sections.error->band.to > sections.error->band.from;
}

std::string factors_text(const std::vector<Complex>& roots) {
  if (roots.empty()) return "1";
  if (std::abs(roots[0]) == 0.0 && std::abs(roots.back()) == 0.0) return roots.size() == 1 ? "s" : "s^2";
  if (roots[0].imag() != 0.0) {
    return fmt::format("(s^2 + {}s + {})", rounded_text(-2.0 * roots[0].real(), 6),
                       rounded_text(std::norm(roots[0]), 6));
  }
  std::string out;
  for (const auto& root : roots) {
    out += root.real() > 0.0 ? fmt::format("(s - {})", rounded_text(root.real(), 6))
                             : fmt::format("(s + {})", rounded_text(-root.real(), 6));
  }
  return out;
}

/// Coefficients c0 + c1 s + c2 s^2 of prod (s - r).
void expand(const std::vector<Complex>& r, double& c0, double& c1, double& c2) {
  c0 = c1 = c2 = 0.0;
  if (r.empty()) {
    c0 = 1.0;
  } else if (r.size() == 1) {
    c0 = -r[0].real();
    c1 = 1.0;
  } else {
    c0 = (r[0] * r[1]).real();
    c1 = -(r[0] + r[1]).real();
    c2 = 1.0;
  }
}

}  // namespace

Band judged_band(const Sections& sections) {
  if (states_a_band(sections)) return sections.error->band;
  const Band corners = sections.corner_band();
  if (corners.to.value == 0.0) return {Hertz{1.0}, Hertz{1000.0}};
  // One corner is no band, however its zeros and poles round (a peaking equaliser's).
  if (corners.to.value < 1.000001 * corners.from.value)
    return {Hertz{corners.from.value / 10.0}, Hertz{corners.to.value * 10.0}};
  return corners;
}

Band searched_band(const Sections& sections) {
  const Band corners = sections.corner_band();
  if (corners.to.value == 0.0) return {Hertz{1.0}, Hertz{1000.0}};
  Band out = corners;
  if (states_a_band(sections)) {
    out.from = std::clamp(sections.error->band.from, corners.from, corners.to);
    out.to = std::clamp(sections.error->band.to, corners.from, corners.to);
  }
  return {Hertz{out.from.value / 10.0}, Hertz{out.to.value * 10.0}};
}

std::string transfer_text(const std::vector<Biquad>& product) {
  double gain = 1.0;
  std::string zeros, poles;
  for (const Biquad& h : product) {
    const Section section = h.section();
    gain *= section.gain;
    zeros += factors_text(section.zeros);
    poles += factors_text(section.poles);
  }
  // A constant is a number, and a denominator needs a numerator of its own only where there are zeros.
  const std::string k = rounded_text(gain, 6);
  if (poles == "1") return zeros == "1" ? k : fmt::format("{} {}", k, zeros);
  return zeros == "1" ? fmt::format("{}/{}", k, poles) : fmt::format("{} {}/{}", k, zeros, poles);
}

std::string parts_csv(const Circuit& circuit) {
  CsvTable table({"part", "section", "series", "wanted_ohm", "realised_ohm", "wanted_f", "realised_f"});
  for (const Part& part : circuit.parts) {
    table.add_row(schematic::part_cells(part, std::to_string(part.group + 1)));
  }
  return table.text();
}

Section Biquad::section() const {
  Section out{.zeros = quadratic_roots(b0, b1, b2), .poles = quadratic_roots(a0, a1, a2)};
  const double top = b2 != 0.0 ? b2 : (b1 != 0.0 ? b1 : b0);
  const double bottom = a2 != 0.0 ? a2 : (a1 != 0.0 ? a1 : a0);
  out.gain = top / bottom;
  return out;
}

Biquad Biquad::from_section(const Section& section) {
  if (section.poles.size() > 2 || section.zeros.size() > section.poles.size()) {
    throw std::logic_error("a section of more than two poles or improper");
  }
  Biquad out;
  expand(section.zeros, out.b0, out.b1, out.b2);
  out.b0 *= section.gain;
  out.b1 *= section.gain;
  out.b2 *= section.gain;
  expand(section.poles, out.a0, out.a1, out.a2);
  return out;
}

std::vector<double> Circuit::realised_values(const Stage& stage) const {
  std::vector<double> out;
  for (const Part& part : parts_of(stage)) out.push_back(part.realised);
  return out;
}

Complex Circuit::response(RadPerSecond w) const {
  Complex h = 1.0;
  for (const Stage& stage : stages) h *= stage.response(w);
  return h;
}

std::vector<Complex> Circuit::responses(const std::vector<Hertz>& grid) const {
  std::vector<Complex> out;
  out.reserve(grid.size());
  for (const Hertz f : grid) out.push_back(response(f.rad_s()));
  return out;
}

Sections Circuit::realised_sections() const {
  Sections out;
  for (const Stage& stage : stages) {
    for (const Biquad& factor : stage.realised) {
      Section section = factor.section();
      if (section.poles.empty()) {
        out.gain *= section.gain;
      } else {
        out.sections.push_back(std::move(section));
      }
    }
  }
  return out;
}

}  // namespace bodesmith::synthesis
