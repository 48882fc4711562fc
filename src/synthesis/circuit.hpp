#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "lti/frequency_grid.hpp"
#include "lti/sections.hpp"
#include "schematic/netlist.hpp"

namespace bodesmith::synthesis {

using schematic::OpAmp;
using schematic::OpAmpModel;
using schematic::Part;

/// H(s) = (b0 + b1 s + b2 s^2)/(a0 + a1 s + a2 s^2), a stage with ideal op-amps.
struct Biquad {
  double b0 = 0.0, b1 = 0.0, b2 = 0.0;
  double a0 = 1.0, a1 = 0.0, a2 = 0.0;

  Complex response(Complex s) const { return (b0 + s * (b1 + s * b2)) / (a0 + s * (a1 + s * a2)); }
  Complex response(RadPerSecond w) const { return response(Complex(0.0, w.value)); }
  /// Roots and leading gain. A constant has no section form: its poles are empty.
  Section section() const;
  static Biquad from_section(const Section& section);
};

class StageForm;

/// One stage of the chain: what it should do, what its parts make it do.
struct Stage {
  std::string realisation;  ///< its form, e.g. "first-order", "tow-thomas", "inverter"
  /// Its share of the design, sign included (most stages invert): a product, of one factor unless the stage
  /// makes more than two poles (ladders).
  std::vector<Biquad> wanted;
  std::vector<Biquad> realised;  ///< with the realised parts and ideal op-amps
  std::string in;
  std::string out;
  std::size_t first_part = 0;  ///< its parts are Circuit::parts[first_part, first_part + part_count)
  std::size_t part_count = 0;
  /// Its equations: transfer() of any part values (realisation.hpp). Ladders have none.
  std::shared_ptr<const StageForm> form;

  Complex response(RadPerSecond w) const { return product(realised, w); }
  Complex wanted_response(RadPerSecond w) const { return product(wanted, w); }

 private:
  static Complex product(const std::vector<Biquad>& factors, RadPerSecond w) {
    Complex out = 1.0;
    for (const Biquad& factor : factors) out *= factor.response(w);
    return out;
  }
};

/// A cascade of op-amp RC stages between nodes "in" and "out": wanted sections made of parts that can be
/// bought. Its groups are its stages.
struct Circuit : schematic::Netlist {
  std::vector<Stage> stages;

  std::span<const Part> parts_of(const Stage& stage) const {
    return std::span(parts).subspan(stage.first_part, stage.part_count);
  }
  std::vector<double> realised_values(const Stage& stage) const;

  /// With ideal op-amps and the realised parts.
  Complex response(RadPerSecond w) const;
  std::vector<Complex> responses(const std::vector<Hertz>& grid) const;
  /// The same as sections (for the simulator): the product of the stages' realised transfers. Stages that are
  /// a constant (an inverter) go into the gain.
  Sections realised_sections() const;
};

/// "-1.88 (s + 107.6)/(s + 126.4)" for comments.
std::string transfer_text(const std::vector<Biquad>& factors);

/// `part,section,series,wanted_ohm,realised_ohm,wanted_f,realised_f` (contract). A cell that does not apply
/// is empty.
std::string parts_csv(const Circuit& circuit);

/// Where a design is judged: the band in which the sections state their error, else their corners.
Band judged_band(const Sections& sections);

/// Where parts are searched and errors listed: a decade beyond the corners on both sides, but never more than a decade
/// beyond the band in which the sections state their error (a fit may leave a zero at 1 MHz to a curve that ends at
/// 20 kHz). Without corners 1 Hz to 1 kHz.
Band searched_band(const Sections& sections);

}  // namespace bodesmith::synthesis
