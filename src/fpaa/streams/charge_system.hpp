#pragma once

#include <Eigen/Core>
#include <complex>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "fpaa/device/circuit.hpp"

namespace bodesmith::fpaa::an231 {

using Complex = std::complex<double>;

/// A wire outside the chips, from an output cell to an input cell, or from one input cell to another (both then
/// have the same signal).
struct PinLink {
  int from_chip = 0;  ///< index into the chips
  int from_cell = 1;
  int to_chip = 0;
  int to_cell = 1;
};

/// The chips of a board and what is wired between them.
struct BoardCircuit {
  Hertz master{16e6};
  std::vector<ChipCircuit> chips;
  std::vector<PinLink> links;
};

/// A node of one of the chips.
struct BoardNode {
  std::size_t chip = 0;
  CircuitNode node;
  friend bool operator==(const BoardNode&, const BoardNode&) = default;
};

/// ACLK periods of one period of the clock that drives an op-amp; 0: none does.
struct OpAmpClock {
  int divisor = 0;
  std::string obstacle;  ///< why charge balance cannot be written (two clocks, comparator switches, …)
};
OpAmpClock opamp_clock(const ChipCircuit& chip, int cab, int opamp);

/// Charge balance of op-amps, in z. Unknown are V1 and V2 of each op-amp, its output at the end of phase 1 and
/// of phase 2 (phase 1 comes first within a period n). The charge of a capacitor is C times the voltage of its
/// near plate while both plates are joined (the far plate is at a virtual ground or at ground), and stays what
/// it was while one of them is open. What flows into a virtual ground in a phase adds up to nothing; a closed
/// feedback switch makes the output zero.
class ChargeSystem {
 public:
  /// `opamps` are the unknowns; every other op-amp and pin that they read is a source.
  ChargeSystem(const BoardCircuit& board, std::vector<BoardNode> opamps);

  const std::vector<BoardNode>& opamps() const { return opamps_; }
  const std::vector<BoardNode>& sources() const { return sources_; }
  /// Why there is no answer; empty: there is one.
  const std::string& obstacle() const { return obstacle_; }

  /// Voltages of a source at the end of phase 1 and of phase 2.
  struct Phases {
    Complex first = 0.0;
    Complex second = 0.0;
  };
  /// z^(-1/2) for a clock of so many ACLK periods.
  using HalfDelay = std::function<Complex(int divisor)>;
  /// V1 and V2 of every op-amp, in order; nothing when they are not determined (no feedback).
  std::optional<std::vector<Phases>> solve(const std::vector<Phases>& sources, const HalfDelay& delay) const;

  /// For one clock: determinant of the system at a value of 1/z, and the same with the column of one output
  /// replaced by what a source of these voltages brings in (Cramer's rule).
  Complex determinant(Complex z_inverse) const;
  Complex numerator(Complex z_inverse, std::size_t opamp, int phase,
                    const std::vector<Phases>& sources) const;

 private:
  /// value · delay^half_cycles, in a row, on an unknown or a source.
  struct Entry {
    std::size_t row;
    std::size_t column;
    bool is_source;
    int phase;  ///< of a source
    double value;
    int half_cycles;
    int divisor;
  };
  void balance(std::size_t row_opamp, const CabCell& cab);
  void charge(std::size_t row, const BoardNode& who, const CapacitorCell& c, int phase, double sign,
              int half_cycles, int divisor);
  void add(std::size_t row, BoardNode node, int phase, double value, int half_cycles, int divisor);
  Eigen::MatrixXcd matrix(const HalfDelay& delay) const;
  Eigen::VectorXcd right_hand_side(const std::vector<Phases>& sources, const HalfDelay& delay) const;

  const BoardCircuit& board_;
  std::vector<BoardNode> opamps_;
  std::vector<int> divisors_;
  std::vector<BoardNode> sources_;
  std::vector<Entry> entries_;
  std::string obstacle_;
};

/// What drives a pin that is an input of a chip: the node behind the link, with the phase in which a sampling
/// output cell took it (0: it is not sampled). Nothing for a pin that is wired to nothing.
struct LinkedSource {
  BoardNode node;
  int sampled_phase = 0;
};
std::optional<LinkedSource> behind_link(const BoardCircuit& board, std::size_t chip, int cell);

/// The phase in which an op-amp's output is to be read: 2 when it is zero in phase 1.
int valid_phase(const ChipCircuit& chip, int cab, int opamp);

}  // namespace bodesmith::fpaa::an231
