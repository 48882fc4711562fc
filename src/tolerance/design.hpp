#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/documents/document.hpp"
#include "fpaa/plan/plan.hpp"
#include "lti/frequency_grid.hpp"
#include "lti/sections.hpp"
#include "synthesis/circuit.hpp"
#include "synthesis/circuit_file.hpp"

namespace bodesmith::tolerance {

/// A part as statistics see it.
struct Part {
  enum class Kind { resistor, capacitor, switched_capacitor };
  std::string name;
  Kind kind = Kind::resistor;
  double nominal = 0.0;  ///< ohm, farad, or units of capacitance
};

/// A stage of a circuit, whose transfer is a ratio of two quadratics in s with coefficients made by its parts.
struct Stage {
  std::string name;
  std::size_t first_part = 0;
  std::size_t part_count = 0;
  std::function<synthesis::Biquad(std::span<const double>)> transfer;
};

/// What a yield run needs to know of a design: op-amp RC or FPAA.
struct Design {
  std::string name;
  std::vector<Part> parts;
  /// Their product, with ideal op-amps; none for a board, and where one has no such transfer (ladders, a user's netlist):
  /// then the netlist is solved.
  std::vector<Stage> stages;
  /// The circuit whose first parts they are, in the same order; none for a plan.
  std::shared_ptr<const schematic::Netlist> netlist;
  bool ideal_opamps = true;  ///< in it
  /// A board as it runs, wires, clocks and holds in it; its capacitors are the parts, in the same order.
  std::shared_ptr<const fpaa::Plan> board;
  std::function<Complex(Hertz)> wanted;  ///< deviations are counted from here, and judged by its flanks
  /// What the op-amps make of the response at the nominal parts, 1 where they are ideal; none: ideal.
  std::function<Complex(Hertz)> opamps;
  std::string reference_name;  ///< "sections" or "nominal"
  std::string band_name;       ///< where the band below comes from
  Band band;
  int poles = 0;
  std::vector<std::string> notes;

  std::vector<double> nominal_values() const;
  Complex response(Hertz f, std::span<const double> values) const;
  Complex nominal(Hertz f) const;
  /// What the response of ideal op-amps is compared with: wanted/opamps.
  Complex reference(Hertz f) const { return opamps ? wanted(f) / opamps(f) : wanted(f); }
  /// Products of quadratics, none of them with a pole at 0: what the kernel evaluates in lanes.
  bool is_quick() const;
};

enum class OpAmps { ideal, as_built };

/// Deviations from the sections, in the band in which the sections state their error, else that of their corners.
/// `as_built`: the op-amps' own error, at the parts' nominal values, counts too.
Design design_of_circuit(const synthesis::Circuit& circuit, const Sections& wanted, std::string name,
                         OpAmps opamps);
/// A circuit.json as it was built, in the band in which it was judged.
Design design_of_file(const Node& circuit, std::string name, OpAmps opamps);
/// A user's netlist from its input to its output, with its op-amps: deviations from its own nominal response. Band: a decade
/// beyond the products of its resistors and capacitors. InputError where it has no response at the band's middle.
Design design_of_netlist(const schematic::Netlist& netlist, std::string name);
/// A plan.json (`bodesmith.fpaa_plan/1`) as it runs, every CAM by its capacitors. Deviations from the plan's
/// own nominal response, or from `wanted` (the plan's designed error is then in them). A plan whose capacitors
/// do not make its z-domain coefficients is an error (file and line).
Design design_of_plan(const Node& plan, std::string name, const std::optional<Sections>& wanted = {});

/// Takes away the frequencies at which the response of one of the designs is below kJudgedFloor of its largest on the grid
/// (notches, stop bands): deviations in dB, degrees and percent say nothing there. Returns them.
std::vector<Hertz> leave_out_nulls(const std::vector<Design>& designs, std::vector<Hertz>& grid);

}  // namespace bodesmith::tolerance
