#include "circuit/realise.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "circuit/opamp_check.hpp"
#include "circuit/realisation.hpp"
#include "lti/judging_grid.hpp"
#include "schematic/analysis/response.hpp"

namespace bodesmith::circuit {
namespace {

constexpr int kReportGrid = 121;
constexpr double kFarZeroRatio = 1000.0;

void measure_nodes(const Circuit& circuit, const std::vector<Hertz>& grid, RealiseReport& report) {
  report.highest_node_db = -std::numeric_limits<double>::infinity();
  report.lowest_node_db = std::numeric_limits<double>::infinity();
  for (const Hertz f : grid) {
    std::complex<double> h = 1.0;
    for (const Stage& stage : circuit.stages) {
      h *= stage.response(f.rad_s());
      report.highest_node_db = std::max(report.highest_node_db, to_decibel(std::abs(h)));
      // A null is no level to speak of, but a number that files can hold.
      report.lowest_node_db = std::min(report.lowest_node_db, to_decibel(std::max(std::abs(h), 1e-300)));
    }
  }
}

}  // namespace

void report_realised(Realised& made, const Sections& sections, Band band,
                     const std::function<std::complex<double>(RadPerSecond)>& nearest) {
  RealiseReport& report = made.report;
  report.band = band;
  const std::vector<Hertz> grid =
      judging_grid([&](Hertz f) { return sections.response(f.rad_s()); }, band, kReportGrid);
  std::vector<std::complex<double>> wanted, rounded;
  for (const Hertz f : grid) {
    wanted.push_back(sections.response(f.rad_s()));
    rounded.push_back(nearest(f.rad_s()));
  }
  const std::vector<std::complex<double>> ideal = made.circuit.responses(grid);
  const std::vector<std::complex<double>> real = schematic::network_response(made.circuit, grid);
  report.parts = compare_responses(grid, ideal, wanted);
  report.nearest = compare_responses(grid, rounded, wanted);
  report.opamps = compare_responses(grid, real, ideal);
  report.all = compare_responses(grid, real, wanted);
  measure_nodes(made.circuit, grid, report);
  report.warnings = check_opamps(made.circuit, band).warnings;
}

Sections without_far_zeros(const Sections& sections) {
  double highest = 0.0;
  for (const Section& section : sections.sections) {
    for (const std::complex<double> pole : section.poles) highest = std::max(highest, std::abs(pole));
  }
  Sections out = sections;
  if (highest == 0.0) return out;  // integrators alone: no corner to be far from
  for (Section& section : out.sections) {
    std::vector<std::complex<double>> kept;
    std::complex<double> gain = section.gain;
    for (const std::complex<double> zero : section.zeros) {
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

Outcome<Realised> try_realise(const Sections& sections, const RealiseOptions& options) {
  options.limits.validate();
  return realisation_registry().get(options.realisation).design(sections, options);
}

Realised realise(const Sections& sections, const RealiseOptions& options) {
  return value_or_throw(try_realise(sections, options));
}

}  // namespace bodesmith::circuit
