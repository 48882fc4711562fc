#include <fmt/format.h>

#include <cmath>

#include "base/text.hpp"
#include "faults/circuit_board.hpp"

namespace bodesmith::faults {
namespace {

/// What an op-amp's equation leaves out.
constexpr double kSlowModelError = 0.02;
/// t = ln(gain-bandwidth/nominal): from a dead one to one that is slower than the spread of good ones.
constexpr double kSlowest = 1e-6;
constexpr double kFastest = 0.4;

class SlowOpAmp : public FaultKind {
 public:
  SlowOpAmp()
      : FaultKind("opamp_too_slow", "an op-amp (or all of them) of less gain-bandwidth, down to a dead one",
                  0.08) {}

  std::vector<Fault> on_circuit(const CircuitBoard& board) const override {
    std::vector<Fault> out;
    const auto& opamps = board.circuit().opamps;
    for (std::size_t i = 0; i < opamps.size(); ++i) out.push_back(slow(board, {i}, opamps[i].name));
    // The equations of more op-amps at once than this would be slow to solve again.
    if (opamps.size() > 1 && opamps.size() <= kMostAtOnce) {
      std::vector<std::size_t> all(opamps.size());
      for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
      out.push_back(slow(board, all, "every op-amp"));
      for (const schematic::OpAmp& one : opamps) out.back().covers.push_back(one.name);
    }
    return out;
  }

 private:
  static constexpr std::size_t kMostAtOnce = 30;

  static Fault slow(const CircuitBoard& board, const std::vector<std::size_t>& which,
                    const std::string& name) {
    const double hz = board.opamp().gain_bandwidth.value;
    Fault out = Fault::of(name, kSlowest, kFastest);
    out.effect = [&board, which](double t) {
      Effect effect;
      effect.model_error = kSlowModelError;
      for (const std::size_t i : which)
        effect = joined(effect, board.slowed(i, std::exp(t), which.size() == 1));
      for (Stamp& stamp : effect.stamps) stamp.rough = true;
      return effect;
    };
    out.words = [name, hz](double t) {
      return fmt::format("{} is too slow: gain-bandwidth {} instead of {}", name,
                         engineering_text(hz * std::exp(t), "Hz"), engineering_text(hz, "Hz"));
    };
    out.size = [hz](double t) { return FaultSize{"gain_bandwidth_hz", hz * std::exp(t)}; };
    out.rework = fmt::format("replace {} by {}, and look at its supply first", name, board.opamp().name);
    return out;
  }
};

}  // namespace

BODESMITH_ENTRY(FaultKind, slow_opamp_fault, SlowOpAmp)

}  // namespace bodesmith::faults
