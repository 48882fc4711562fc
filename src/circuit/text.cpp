#include "circuit/text.hpp"

#include <fmt/format.h>

#include <cmath>

#include "base/text.hpp"
#include "signal/csv.hpp"

namespace bodesmith::circuit {
namespace {

std::string factors_text(const std::vector<std::complex<double>>& roots) {
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

}  // namespace

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
    const std::string wanted = number_text(part.wanted), realised = number_text(part.realised);
    const std::string stage = std::to_string(part.group + 1);
    if (part.kind == Part::Kind::resistor) {
      table.add_row({part.name, stage, part.series, wanted, realised, "", ""});
    } else {
      table.add_row({part.name, stage, part.series, "", "", wanted, realised});
    }
  }
  return table.text();
}

}  // namespace bodesmith::circuit
