#include "fpaa/cams/cam.hpp"

namespace bodesmith::fpaa {
namespace {

/// Logic: input above reference; hysteresis of 0 or 10 mV (seen).
class ComparatorCam : public Cam {
 public:
  ComparatorCam()
      : Cam(CamFacts{.name = "Comparator",
                     .resources = Resources{.opamps = 0, .capacitors = 0, .comparators = 1}}) {}

  /// Input 1 against input 2, or against ground when there is none; it turns half the hysteresis beyond.
  CamStep step(const PlacedCam& cam) const override {
    const double half_v = 0.5 * cam.requested.number("hysteresis_v").value_or(0.0);
    return [half_v, high = false](std::span<const double> inputs) mutable {
      const double over = inputs[0] - (inputs.size() > 1 ? inputs[1] : 0.0);
      high = over > (high ? -half_v : half_v);
      return high ? 1.0 : 0.0;
    };
  }
  std::string picture_text(const PlacedCam&) const override { return "sign of its input"; }
};

}  // namespace

BODESMITH_ENTRY(Cam, comparator_cam, ComparatorCam)

}  // namespace bodesmith::fpaa
