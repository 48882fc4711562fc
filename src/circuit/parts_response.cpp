#include "circuit/parts_response.hpp"

#include "circuit/ladders/rc_ladder.hpp"
#include "circuit/realisation.hpp"

namespace bodesmith::circuit {

PartsResponse ladder_response(const Stage& stage) {
  // "foster1 in the feedback", "cauer2 at the input".
  const Realisation* realisation =
      realisation_registry().find(stage.realisation.substr(0, stage.realisation.find(' ')));
  if (realisation == nullptr || realisation->ladder() == nullptr) return nullptr;
  const bool in_feedback = !stage.realisation.ends_with("input");
  return [ladder = realisation->ladder(), in_feedback](std::span<const double> values, RadPerSecond w) {
    const std::complex<double> z = ladder->impedance(values.subspan(1), {0.0, w.value});
    return -(in_feedback ? z / values[0] : values[0] / z);
  };
}

}  // namespace bodesmith::circuit
