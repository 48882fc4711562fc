#include <fmt/format.h>

#include <cmath>

#include "faults/kinds/part_words.hpp"

namespace bodesmith::faults {
namespace {

constexpr double kSolderBridge_S = 100.0;  ///< 10 mohm
/// Another value begins at this many tolerances and ends at a factor of 30; t = ln |ln(value/nominal)|, so that 5 % and a
/// factor of 5 are as likely.
constexpr double kLeastTolerances = 3.0;
constexpr double kLargestFactor = 30.0;

/// What may be wrong with every part by itself.
class PartFault : public FaultKind {
 public:
  using FaultKind::FaultKind;
  std::vector<Fault> on_circuit(const CircuitBoard& board) const final {
    std::vector<Fault> out;
    for (std::size_t i = 0; i < board.circuit().parts.size(); ++i)
      add(out, board, i, board.circuit().parts[i]);
    return out;
  }

 protected:
  virtual void add(std::vector<Fault>& out, const CircuitBoard& board, std::size_t i,
                   const schematic::Part& part) const = 0;
  /// `factor(t)` times its value.
  template <class Factor>
  static Fault with_value(const CircuitBoard& board, std::size_t i, const schematic::Part& part,
                          Factor factor) {
    Fault out = fault_of_part(board, i);
    out.effect = [&board, i, factor](double t) { return board.changed(i, factor(t)); };
    out.size = [part, factor](double t) { return FaultSize{value_key(part), part.realised * factor(t)}; };
    return out;
  }
};

class ShortedPart : public PartFault {
 public:
  ShortedPart() : PartFault("short", "a part that is bridged", 0.10) {}

 private:
  void add(std::vector<Fault>& out, const CircuitBoard& board, std::size_t i,
           const schematic::Part& part) const override {
    Fault& fault = out.emplace_back(fault_of_part(board, i));
    fault.effect = [&board, i](double) { return board.replaced(i, kSolderBridge_S); };
    fault.words = [part](double) {
      return fmt::format("{} ({}) is shorted", part.name, value_text(part, part.realised));
    };
    fault.rework =
        fmt::format("look for a solder bridge across {}; if there is none, {}", part.name, fault.rework);
  }
};

class OpenPart : public PartFault {
 public:
  OpenPart() : PartFault("open", "a part that is missing, broken or not soldered", 0.12) {}

 private:
  void add(std::vector<Fault>& out, const CircuitBoard& board, std::size_t i,
           const schematic::Part& part) const override {
    Fault& fault = out.emplace_back(fault_of_part(board, i));
    // What is left is a leak of a teraohm: a node that only this part fed stays defined.
    fault.effect = [&board, i](double) { return board.replaced(i, 1e-12); };
    fault.words = [part](double) {
      return fmt::format("{} ({}) is open: missing, broken or not soldered", part.name,
                         value_text(part, part.realised));
    };
  }
};

class WrongDecade : public PartFault {
 public:
  WrongDecade()
      : PartFault("wrong_decade", "a part of ten or a hundred times the value, or a tenth or hundredth",
                  0.12) {}

 private:
  void add(std::vector<Fault>& out, const CircuitBoard& board, std::size_t i,
           const schematic::Part& part) const override {
    for (const double factor : {10.0, 0.1, 100.0, 0.01}) {
      Fault& fault = out.emplace_back(with_value(board, i, part, [factor](double) { return factor; }));
      fault.words = [part, factor](double) {
        return fmt::format("{} is {}, the wrong decade of {}", part.name,
                           value_text(part, part.realised * factor), value_text(part, part.realised));
      };
    }
  }
};

class ValueOff : public PartFault {
 public:
  ValueOff() : PartFault("value_off", "a part of another value", 0.30) {}

 private:
  void add(std::vector<Fault>& out, const CircuitBoard& board, std::size_t i,
           const schematic::Part& part) const override {
    for (const double sign : {1.0, -1.0}) {
      const auto factor = [sign](double t) { return std::exp(sign * std::exp(t)); };
      Fault& fault = out.emplace_back(with_value(board, i, part, factor));
      fault.from = std::log(kLeastTolerances * board.tolerance(i));
      fault.to = std::log(std::log(kLargestFactor));
      fault.words = [part, factor](double t) {
        return fmt::format("{} is {} instead of {}", part.name, value_text(part, part.realised * factor(t)),
                           value_text(part, part.realised));
      };
    }
  }
};

}  // namespace

BODESMITH_ENTRY(FaultKind, shorted_part_fault, ShortedPart)
BODESMITH_ENTRY(FaultKind, open_part_fault, OpenPart)
BODESMITH_ENTRY(FaultKind, wrong_decade_fault, WrongDecade)
BODESMITH_ENTRY(FaultKind, value_off_fault, ValueOff)

}  // namespace bodesmith::faults
