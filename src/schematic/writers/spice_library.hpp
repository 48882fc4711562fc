#pragma once

#include <functional>
#include <string>
#include <vector>

#include "schematic/netlist.hpp"

namespace bodesmith::schematic {

// The models that netlists use, as portable subcircuits; no end of line after the last line.

/// `.subckt NAME p n o`: two poles, slew rate, swing, output resistance and noise by resistors and diodes only, so that every
/// simulator has it; two lines for an ideal model.
std::string opamp_subcircuit(const OpAmpModel& model, const std::string& name = "bodesmith_opamp");
/// Of OpAmp::type.
std::string opamp_subcircuit_name(std::size_t type);
/// `.subckt NAME x y z w`: W = X Y/U + Z behind one pole, limited.
std::string multiplier_subcircuit(const MultiplierModel& model, const std::string& name,
                                  const MultiplierDeviation& off = {});
/// `.subckt bodesmith_switch a o e`: one contact; DesignError as SwitchTimer::of.
std::string switch_subcircuit(const SwitchModel& model);
/// `.model bodesmith_diode`.
std::string diode_model(const DiodeModel& model);

/// `.subckt NAME PINS … .ends NAME` with what is said above it.
struct Subcircuit {
  std::string name;
  std::vector<std::string> pins;
  std::vector<std::string> comments;
  Netlist netlist;
};

/// A portable library: no analysis, no control section, plain numbers, products instead of powers, E and G sources with
/// VALUE={…} only, so that ngspice, LTspice and Xyce read the same. The last subcircuits may use the first as instances; the
/// models of op-amps, multipliers, switches and diodes that any of them uses stand behind them.
struct SpiceLibrary {
  std::string title;
  std::string written_by;          ///< program and version
  std::string top;                 ///< the subcircuit that it is made for
  std::vector<std::string> notes;  ///< comments at its head
  std::vector<Subcircuit> subcircuits;

  /// InputError when there is none.
  const Subcircuit& subcircuit(const std::string& name) const;
  /// A subcircuit of resistors, capacitors, contacts and op-amps with what its instances hold in their places: a group each, the inner
  /// node k of instance 2 is s2_k. InputError for other elements in them, for one that holds itself, and for more than
  /// kMostParts.
  Netlist flat(const std::string& name) const { return flat(name, 0); }
  /// The same from node "in" to node "out": its first and its second pin. InputError where it has more or fewer, or nothing at
  /// its output.
  Netlist two_port(const std::string& name) const;

  /// Far more than a board has: subcircuits in subcircuits grow by powers.
  static constexpr std::size_t kMostParts = 10000;

 private:
  Netlist flat(const std::string& name, std::size_t depth) const;
};

/// Edges of a ClockPhase, as a share of its gap.
constexpr double kEdgeOfGap = 0.25;

struct SpiceOptions {
  /// Of the subcircuit `top`.
  const Deviations* off = nullptr;
  /// How a part's value is written; none: plain_number().
  std::function<std::string(const Part&)> value = nullptr;
  bool noise = true;  ///< false: op-amps without their noise sources, which time-domain runs do not need
};

std::string spice_text(const SpiceLibrary& library, const SpiceOptions& options = {});

/// What spice_text() has written, read back: printed again it is the same bytes; and what people write of such elements:
///   R1 a b 4.7k, C1 a 0 {c}, V1 vcc 0 DC 15, Xu1 plus minus [vcc vee] out OPA1611 (a type of OpAmpLibrary; its own
///   definition is passed over), E1 out 0 plus minus 1e6 (an op-amp of that gain), .param c=10n, subcircuits in subcircuits.
/// Switched capacitors:
///   .clock NAME FREQUENCY       phase 1 is the first half of its period; all clocks begin at t = 0
///   S1 a b NAME.1               closed in phase 1 or 2 of a clock
///   O1 plus minus out [noise=V/rtHz gbw=HZ]   an op-amp, ideal but for noise at its input and the bandwidth that limits it
/// Elements outside a subcircuit are one from the node of the source without a value or with an AC value (else `in`) to
/// `.output NODE` (else `out`); analyses and outputs are passed over. Another element or a second model of a part is an
/// InputError with file and line. Deviations are read as the netlist's own values.
SpiceLibrary read_spice(const std::string& text, const std::string& file);

}  // namespace bodesmith::schematic
