#pragma once

#include <string>
#include <vector>

#include "fpaa/device/board.hpp"

namespace bodesmith::fpaa {

// The switches of a stage: ONE description, read by the stream generator (as switch words), by the ngspice netlist (as switches) and by
// the solver (circuit_of); streams that are read give it back. Facts: an231, part 2. Within a clock period phase 1 comes first, then
// phase 2.

/// What one plate of a capacitor is connected to.
struct PlateNode {
  enum class Kind {
    open,
    ground,
    input,           ///< input `number` of the stage, from 1
    opamp,           ///< output of the stage's op-amp `number` (1 or 2)
    virtual_ground,  ///< inverting input of the stage's op-amp `number`
  };
  Kind kind = Kind::open;
  int number = 0;

  static constexpr PlateNode ground() { return {Kind::ground, 0}; }
  static constexpr PlateNode input(int number = 1) { return {Kind::input, number}; }
  static constexpr PlateNode opamp(int number = 1) { return {Kind::opamp, number}; }
  static constexpr PlateNode virtual_ground(int number = 1) { return {Kind::virtual_ground, number}; }
  friend bool operator==(const PlateNode&, const PlateNode&) = default;
};

/// One plate: where it is in phase 1 and in phase 2.
struct Plate {
  PlateNode phase1;
  PlateNode phase2;
  int clock = 0;  ///< index, of a stage that is switched by several

  static constexpr Plate fixed(PlateNode node) { return {node, node}; }
  bool is_static() const { return phase1 == phase2; }
  Plate mirrored() const { return {phase2, phase1, clock}; }
};

struct StageCapacitor {
  std::string name;    ///< as PlacedCam::capacitors has it; banks of one capacitor end in 1, 2
  double units = 0.0;  ///< whole, unless they were drawn
  Plate near;          ///< the plate that selects a source
  Plate far;           ///< the plate at an op-amp's inverting input
};

/// Units of a capacitor that only holds.
inline constexpr int kHoldUnits = kMostUnits;

struct StageOpAmp {
  int reset_phase =
      0;  ///< its feedback switch is closed in this phase (its output 0 there); 0: there is none
  int reset_clock = 0;
};

/// One stage, ready to be placed: capacitors in the order in which the vendor numbers them.
struct StageSwitches {
  std::vector<StageCapacitor> capacitors;
  std::vector<StageOpAmp> opamps{{}};
  int output = 1;        ///< the op-amp that is the stage's output
  int output_phase = 0;  ///< its output is valid in this phase only; 0: for the whole period

  int inputs() const;  ///< highest number of an input
  /// Both phases exchanged.
  StageSwitches mirrored() const;
};

/// Inverting, without delay: at `from` and at the virtual ground in phase 1, emptied in phase 2.
StageCapacitor switched_branch(std::string name, double units, PlateNode from, int opamp = 1);
/// Always at `from` and at the virtual ground.
StageCapacitor static_branch(std::string name, double units, PlateNode from, int opamp = 1);
/// Not inverting, late: takes up `from` in phase 2, gives it to the virtual ground in phase 1.
StageCapacitor delayed_branch(std::string name, double units, PlateNode from, int opamp);
/// Inverting in phase 1 with an op-amp that is reset in phase 2: its far plate stays at the virtual ground.
StageCapacitor half_period_branch(std::string name, double units, PlateNode from);

}  // namespace bodesmith::fpaa
