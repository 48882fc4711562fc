#include <fmt/format.h>

#include "faults/kinds/load.hpp"

namespace bodesmith::faults {
namespace {

/// t = ln C: from more than a stray capacitance to a metre-long cable and far beyond.
constexpr double kLeast_F = 10e-12;
constexpr double kMost_F = 1e-6;

class CapacitiveLoad : public FaultKind {
 public:
  std::string_view name() const override { return "capacitive_load"; }
  std::string_view what() const override {
    return "a cable or probe whose capacitance loads the output or a node";
  }
  double prior() const override { return 0.06; }

  std::vector<Fault> on_circuit(const CircuitBoard& board) const override {
    return load_faults(board, {kLeast_F, kMost_F,
                               [](const CircuitBoard& on, const std::string& node, double farad) {
                                 return on.admittance(node, "0", 0.0, farad);
                               },
                               "F", "value_f", " (a cable or probe)",
                               [](const std::string& where) {
                                 return fmt::format(
                                     "take what is connected to {} away, or put a buffer before it", where);
                               }});
  }
};

}  // namespace

BODESMITH_ENTRY(FaultKind, capacitive_load_fault, CapacitiveLoad)

}  // namespace bodesmith::faults
