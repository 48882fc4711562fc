#include <fmt/format.h>

#include "faults/kinds/load.hpp"

namespace bodesmith::faults {
namespace {

/// t = ln R: from little more than a solder bridge to a leak.
constexpr double kLeast_Ohm = 1.0;
constexpr double kMost_Ohm = 100e6;

class ResistiveLoad : public FaultKind {
 public:
  std::string_view name() const override { return "resistive_load"; }
  std::string_view what() const override {
    return "a resistance from the output or a node to ground: a terminated cable, a probe, a solder bridge";
  }
  double prior() const override { return 0.06; }

  std::vector<Fault> on_circuit(const CircuitBoard& board) const override {
    return load_faults(
        board, {kLeast_Ohm, kMost_Ohm,
                [](const CircuitBoard& on, const std::string& node, double ohm) {
                  return on.admittance(node, "0", 1.0 / ohm, 0.0);
                },
                "Ω", "value_ohm", "",
                [](const std::string& where) {
                  return fmt::format(
                      "take what loads {} away (cable, probe, solder bridge), or put a buffer before it",
                      where);
                }});
  }
};

}  // namespace

BODESMITH_ENTRY(FaultKind, resistive_load_fault, ResistiveLoad)

}  // namespace bodesmith::faults
