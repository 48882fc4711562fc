#include "fpaa/cams/comparator.hpp"

#include "fpaa/cams/cam.hpp"
#include "fpaa/cams/cam_step.hpp"

namespace bodesmith::fpaa {
namespace {

CamFacts comparator_facts() {
  CamFacts f;
  f.name = "Comparator";
  f.options = {ComparatorSpec::kSignalGround, "Dual Input", "Variable Reference"};
  f.parameters = {{"hysteresis_v"}};
  f.resources = Resources{.opamps = 0, .capacitors = 0, .comparators = 1};
  f.transfer = "logic: input above reference";
  f.transfer_ground = Ground::seen;
  f.limits = "hysteresis 0 or 0.01 V";
  return f;
}

/// Input 1 against input 2, or against ground when there is none; it turns half the hysteresis beyond.
class ComparatorStep final : public CamStep {
 public:
  explicit ComparatorStep(double hysteresis_v) : half_v_(0.5 * hysteresis_v) {}
  double at_edge(std::span<const double> inputs) override {
    const double over = inputs[0] - (inputs.size() > 1 ? inputs[1] : 0.0);
    high_ = over > (high_ ? -half_v_ : half_v_);
    return high_ ? 1.0 : 0.0;
  }

 private:
  double half_v_;
  bool high_ = false;
};

class ComparatorCam : public Cam {
 public:
  ComparatorCam() : Cam(comparator_facts()) {}

  std::unique_ptr<CamStep> step(const PlacedCam& cam) const override {
    return std::make_unique<ComparatorStep>(cam.requested.number("hysteresis_v").value_or(0.0));
  }
  std::string picture_text(const PlacedCam&) const override { return "sign of its input"; }
};

}  // namespace

BODESMITH_ENTRY(Cam, comparator_cam, ComparatorCam)

}  // namespace bodesmith::fpaa
