#include "synthesis/realise.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lti/bulk_response.hpp"
#include "lti/judge_responses.hpp"
#include "schematic/analysis/response.hpp"
#include "synthesis/opamp_check.hpp"

namespace bodesmith::synthesis {
namespace {

constexpr int kNodeGrid = 121;
constexpr double kFarZeroRatio = 1000.0;

void measure_nodes(const Circuit& circuit, const std::vector<Hertz>& grid, RealiseReport& report) {
  report.highest_node_db = -std::numeric_limits<double>::infinity();
  report.lowest_node_db = std::numeric_limits<double>::infinity();
  for (const Hertz f : grid) {
    Complex h = 1.0;
    for (const Stage& stage : circuit.stages) {
      h *= stage.response(f.rad_s());
      report.highest_node_db = std::max(report.highest_node_db, to_decibel(std::abs(h)));
      // A null is no level to speak of, but a number that files can hold.
      report.lowest_node_db = std::min(report.lowest_node_db, to_decibel(std::max(std::abs(h), 1e-300)));
    }
  }
}

}  // namespace

void PartLimits::validate() const {
  if (!(min_ohm > 0.0) || !(max_ohm >= min_ohm)) {
    throw InputError("the limits of the resistors are empty, expected 0 < min <= max");
  }
  if (!(min_f > 0.0) || !(max_f >= min_f)) {
    throw InputError("the limits of the capacitors are empty, expected 0 < min <= max");
  }
}

void report_realised(Realised& made, const Sections& sections, Band band,
                     const std::function<Complex(RadPerSecond)>& nearest) {
  RealiseReport& report = made.report;
  report.band = band;
  using Grid = std::vector<Hertz>;
  const auto wanted = [&](const Grid& grid) { return responses(sections, grid); };
  const auto ideal = [&](const Grid& grid) { return made.circuit.responses(grid); };
  const auto real = [&](const Grid& grid) { return schematic::network_response(made.circuit, grid); };
  report.parts = judge_responses(ideal, wanted, band);
  report.nearest = judge_responses(at_each(nearest), wanted, band);
  report.opamps = judge_responses(real, ideal, band);
  report.all = judge_responses(real, wanted, band);
  measure_nodes(made.circuit,
                judging_grid([&](Hertz f) { return sections.response(f.rad_s()); }, band, kNodeGrid), report);
  report.warnings = check_opamps(made.circuit, band).warnings;
}

Sections without_far_zeros(const Sections& sections) {
  double highest = 0.0;
  for (const Section& section : sections.sections) {
    for (const Complex pole : section.poles) highest = std::max(highest, std::abs(pole));
  }
  Sections out = sections;
  if (highest == 0.0) return out;  // integrators alone: no corner to be far from
  for (Section& section : out.sections) {
    std::vector<Complex> kept;
    Complex gain = section.gain;
    for (const Complex zero : section.zeros) {
      if (std::abs(zero) <= kFarZeroRatio * highest) {
        kept.push_back(zero);
      } else {
        gain *= -zero;
      }
    }
    section.gain = gain.real();  // complex zeros come in pairs
    section.zeros = kept;
  }
  return out;
}

}  // namespace bodesmith::synthesis
