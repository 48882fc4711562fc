#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "circuit/circuit.hpp"
#include "circuit/series.hpp"
#include "lti/frequency_grid.hpp"
#include "lti/sections.hpp"

namespace bodesmith::circuit {

struct RealiseOptions {
  /// "opamp-rc": first-order sections for real roots, Tow-Thomas for complex ones; or one of realizations();
  /// or a ladder, "foster1", "foster2", "cauer1", "cauer2" (realise_ladder.hpp).
  std::string realization = "opamp-rc";
  Series resistors = Series::named("E96");
  Series capacitors = Series::named("E12");
  /// Parts outside these are not used (DesignError when a corner cannot be reached with them).
  double least_ohm = 1e3;
  double greatest_ohm = 2.2e6;
  double least_f = 47e-12;
  double greatest_f = 220e-9;
  OpAmpModel opamp;
  /// In series with every C1 of a first-order stage, so that the op-amp before it does not ring. Without a
  /// value: the a fifth of the op-amp's output resistance, none with exact parts, or where that would take
  /// more than 0.005 dB within the band.
  std::optional<double> isolation_ohm;
  /// Where the realised response is compared; default: 1/10 of the lowest to 10 times the highest corner.
  std::optional<Band> band;
};

/// Realised against wanted, over `band`.
struct RealiseReport {
  Band band;
  ResponseDifference parts;    ///< preferred values, ideal op-amps, against the sections
  ResponseDifference nearest;  ///< the same with every value rounded on its own (what joint search saves)
  ResponseDifference
      opamps;  ///< finite gain-bandwidth and output resistance (loading included), against ideal ones
  ResponseDifference all;        ///< real parts and real op-amps against the sections
  double highest_node_db = 0.0;  ///< greatest |gain| from the input to any stage's output, over frequency
  double lowest_node_db = 0.0;   ///< least of the stages' output gains over frequency
  std::vector<std::string> warnings;
};

struct Realised {
  Circuit circuit;
  RealiseReport report;
};

/// Without the zeros that lie more than 1000 times above the highest pole (a fit's way to say that there is
/// none): below ten times that pole they count for less than 0.0005 dB and 0.6 degrees, and would take parts
/// that cannot be had. The gain at rest is kept.
Sections without_far_zeros(const Sections& sections);

/// Fills made.report for made.circuit; `nearest` is the response with every value rounded on its own.
void report_realised(Realised& made, const Sections& sections, Band band,
                     const std::function<std::complex<double>(RadPerSecond)>& nearest);

/// Sections as a chain of op-amp RC stages. Real poles and zeros of all sections are pooled, paired sorted by
/// frequency (least span a stage) and each pair becomes R1||C1 into R2||C2 around an inverting op-amp,
///   H(s) = -(R2/R1)(1 + s R1 C1)/(1 + s R2 C2);
/// complex pairs become biquads. Stages are ordered so that no node between them is far above or below the
/// signal, the gain is spread over them, an inverter is added where the number of inversions is odd.
/// Resistors and capacitors of all stages are then searched jointly in their series for the least complex
/// error of the whole chain.
Realised realise(const Sections& sections, const RealiseOptions& options = {});

}  // namespace bodesmith::circuit
