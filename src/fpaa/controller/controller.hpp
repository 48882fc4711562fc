#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/documents/json_fwd.hpp"
#include "fpaa/plan/plan.hpp"
#include "signal/disturbance.hpp"

namespace bodesmith::fpaa {

/// How the branch polynomials d(x) = a1 x + a2 x^2 + a3 x^3 are made.
enum class PolynomialBy {
  outside,      ///< AD835 multipliers and a branch switch off the board; weights on the board
  multipliers,  ///< Multiplier CAMs (one input through 8 bits); weights on the board
  lookup,       ///< a TransferFunction CAM a branch (256 bytes; one table a chip)
};
const char* to_string(PolynomialBy by);

/// What the polynomials are a function of. The stage answers y = v + K d(v) to its drive v, so that only the
/// drive itself is right; a polynomial of the reference leaves d(v) - d(r).
enum class ControllerStructure {
  loop,      ///< v = r - K d(v): fed by its own drive, one Hold in the loop
  two_pass,  ///< v = r - K d(r - K d(r)), the reference delayed as long as the disturbance
  delayed,   ///< v = r - K d(r), the reference delayed as long as the disturbance
  open,      ///< v = r - K d(r), the reference straight through
};
const char* to_string(ControllerStructure structure);
/// "v = r - K d(v)".
const char* equation(ControllerStructure structure);

struct ControllerOptions {
  std::string board = "an231k04-quad4";
  std::optional<PolynomialBy> polynomial;        ///< absent: the best that fits
  std::optional<ControllerStructure> structure;  ///< absent: the best that works
  Hertz fast_clock{250e3};                       ///< ClockA of everything but the compensators
  /// The branch is chosen by an analogue switch next to the board, by the reference generator: no comparator and
  /// no GainSwitch, whose bytes are not publicly known. (`outside` always has it there.)
  bool outside_switch = false;
  double outside_error_percent = 0.1;  ///< gain error of each AD835 after trimming (to be measured)
};

/// Volts of a signal that stands for a share x of the stroke: volts_per_stroke (x - centre).
struct VoltScale {
  double volts_per_stroke = 6.0;
  double centre = 0.5;
  double volts(double x) const { return volts_per_stroke * (x - centre); }
  double stroke(double v) const { return v / volts_per_stroke + centre; }
};

/// One CAM of the controller, placed: what a plan says of it, and what it reads.
struct ControllerCam : WiredCam {
  std::vector<bool> late;  ///< inputs read half a cycle before the edge (SumDiff's that do not invert)
  int group = 0;           ///< CAMs of a group stay on one chip where they can
  /// Wanted gain of each input where the rate gain is 1 (negative: inverting), and how errors of them count:
  /// mean products of the inputs over the stroke, row by row. Empty: nothing is weighed here.
  std::vector<double> weights;
  std::vector<double> products;
  std::optional<Disturbance::Branch> scheduled;  ///< its weights carry this branch's rate gain
};

/// What stands or comes from off the board.
struct OutsidePart {
  enum class Kind {
    reference,   ///< r, in volts by the variant's VoltScale
    constant,    ///< `value` volts
    multiplier,  ///< AD835 with its scaling: inputs 1 and 2 multiplied, times `value` a volt
    switched,    ///< an analogue switch: input 1 while the reference rises, else input 2
  };
  Kind kind = Kind::reference;
  std::string name;
  std::vector<std::string> inputs;
  double value = 0.0;
};

/// A way to make the polynomials and a structure, worked out as a whole controller.
struct ControllerVariant {
  PolynomialBy by = PolynomialBy::outside;
  ControllerStructure structure = ControllerStructure::loop;
  std::string board;
  std::optional<Refusal> refusal;  ///< what does not fit on the board, or cannot work
  VoltScale scale;
  double contraction = 0.0;        ///< max |K d'| over stroke, branches and rate table
  double max_error_percent = 0.0;  ///< of d over x in [0, 1], both branches, in percent of the stroke
  double rms_error_percent = 0.0;
  double delay_s = 0.0;       ///< from the polynomials' argument to the drive
  double bandwidth_hz = 0.0;  ///< of the polynomial: where its own delay is a tenth of a period, or 250 MHz
  std::vector<ControllerCam> cams;
  std::vector<OutsidePart> outside;
  std::string drive;  ///< the CAM whose output is the drive
  int chips = 0;
  std::vector<int> io_cells;  ///< used, of each chip
  Resources resources;

  bool fits() const { return !refusal; }
  std::string name() const;  ///< "lookup, loop"
  int outside_multipliers() const;
  /// With the capacitors that carry the rate gains of this frequency.
  ControllerVariant at(const Disturbance& disturbance, Hertz operating) const;
  const ControllerCam* find(std::string_view name) const;
  const OutsidePart* find_outside(std::string_view name) const;
};

/// Finished plans of the compensators of kBranches; null: that branch has none.
using BranchPlans = std::array<const Plan*, 2>;

struct Controller {
  std::vector<ControllerVariant> variants;
  std::size_t chosen = 0;
  std::string why;
  std::vector<std::string> assumptions;
  const ControllerVariant& best() const { return variants[chosen]; }
  Json to_json() const;
};

/// The whole controller on the board: reference in, drive out (disturbance paper, Fig. 2 and section V-A,
/// with the drive fed back): the branch by the slope's sign, rate gains as capacitor sets that a host sends
/// (or a compensator for each branch), amplitude gains by a control voltage where the disturbance has them.
/// Refused when no way (or not
/// the one asked for) fits the board, saying what would make it fit. Of those that fit the one with the least
/// polynomial error is chosen, the loop before two passes before one; with a stage at hand, choose by
/// tracking.
Outcome<Controller> make_controller(const Disturbance& disturbance, const BranchPlans& compensators,
                                    const ControllerOptions& options);

std::string controller_sheet(const Controller& controller);

}  // namespace bodesmith::fpaa
