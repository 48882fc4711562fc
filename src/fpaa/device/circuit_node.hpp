#pragma once

#include <string>
#include <string_view>

namespace bodesmith::fpaa::an231 {

/// What a capacitor's plate or an output cell is joined to.
struct CircuitNode {
  enum class Kind { open, ground, virtual_ground, opamp, pin, reference, undriven, local_input, direct_line };
  Kind kind = Kind::open;
  int cab = 0;     ///< of an op-amp or virtual ground
  int number = 0;  ///< of the op-amp, the I/O cell, the line or local input; sign of the reference

  /// "CAB1.op2", "IO3", "ground", "+2 V", …
  std::string text() const;
  friend bool operator==(const CircuitNode&, const CircuitNode&) = default;
};

struct IoCell {
  enum class Mode { off, input, amplifier_input, output, sampled_output, unconnected, unknown };
  int number = 1;
  Mode mode = Mode::off;
  CircuitNode source;    ///< of an output: what drives it
  int sample_phase = 0;  ///< of a sampled output
  int sample_clock = -1;
  bool is_input() const { return mode == Mode::input || mode == Mode::amplifier_input; }
  bool is_output() const { return mode == Mode::output || mode == Mode::sampled_output; }
};
std::string_view to_string(IoCell::Mode mode);

}  // namespace bodesmith::fpaa::an231
