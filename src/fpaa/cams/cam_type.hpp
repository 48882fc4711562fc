#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "fpaa/board.hpp"

namespace bodesmith::fpaa {

/// How well a fact about a CAM is founded.
enum class Ground {
  seen,     ///< read in public vendor-generated code
  derived,  ///< follows from what was read
  assumed,  ///< a standard circuit that fits what was read; plans that use it say so
  unknown,  ///< not publicly known: parameters can be listed, nothing is computed
};
std::string_view word(Ground ground);

/// What the library knows of one CAM. Each is described in its own file, cams/<cam>.cpp.
struct CamType {
  std::string_view name;  ///< as AnadigmDesigner2 writes it
  std::vector<std::string_view> options;
  std::vector<std::string_view> parameters;  ///< keys of `requested`, ending in their unit
  std::optional<Resources> resources;        ///< of the plainest option; absent: not publicly known
  std::string_view transfer;                 ///< in z, as text
  Ground transfer_ground = Ground::unknown;
  double delay_cycles = 0.0;
  bool half_cycle_output = false;  ///< valid only during one phase: needs a Hold before a bypass output
  int clock_b_ratio = 0;           ///< ClockB = ratio * ClockA; 0: no ClockB
  bool chopped = false;            ///< ClockA must be Clock 0-3 with a divisor that is a multiple of 4
  std::string_view limits;
};

/// Every CAM, in the order of the menu.
const std::vector<const CamType*>& cam_types();
/// Throws DesignError for a name that is not in the library.
const CamType& cam_type(std::string_view name);

}  // namespace bodesmith::fpaa
