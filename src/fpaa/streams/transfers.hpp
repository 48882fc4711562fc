#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "fpaa/streams/charge_system.hpp"

namespace bodesmith::fpaa::an231 {

/// What a group of op-amps that feed each other makes of what it reads, as its capacitors and switches have
/// it: for one of its outputs, numerators (one a source) over a common denominator, in ascending powers of
/// 1/z; whole numbers in capacitor units where they stay exact. Sources count as held over a period.
struct StageTransfer {
  BoardNode opamp;
  int clock_divisor = 0;  ///< ACLK periods of a period
  int phase = 1;          ///< in which the output is valid (1: from then on, unless it is reset)
  bool half_period = false;
  std::vector<BoardNode> inputs;
  std::vector<std::vector<double>> numerators;
  std::vector<double> denominator;
  std::string obstacle;  ///< why there is none
};

/// Of every op-amp that is on and has capacitors at its virtual ground.
std::vector<StageTransfer> stage_transfers(const BoardCircuit& board);

/// From one pin to another, sample to sample: the output at the end of the phase in which it is valid over the
/// input at the same instant. Holds at the outputs are not in it; delays are.
class PinResponse {
 public:
  PinResponse(const BoardCircuit& board, std::size_t from_chip, int from_cell, std::size_t to_chip,
              int to_cell);
  /// Why there is none; empty: there is one.
  const std::string& obstacle() const { return obstacle_; }
  /// Nothing where the network has no answer (an integrator at 0 Hz, an op-amp without feedback).
  std::optional<Complex> at(RadPerSecond w) const;

 private:
  Hertz master_;
  std::string obstacle_;
  bool wire_ = false;  ///< no op-amp in between
  std::optional<ChargeSystem> system_;
  std::size_t output_ = 0;
  int output_phase_ = 1;
  int output_divisor_ = 1;
  std::optional<std::size_t> source_;  ///< nothing: the output does not depend on the input
};

}  // namespace bodesmith::fpaa::an231
