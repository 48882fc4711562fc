#include "fpaa/cams/multiplier.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/text.hpp"
#include "fpaa/cams/cam.hpp"
#include "fpaa/cams/cam_step.hpp"

namespace bodesmith::fpaa {

double Multiplier::quantised(double y_v) {
  const double step = 6.0 / 256.0;
  const double code = std::clamp(std::floor((y_v + 3.0) / step), 0.0, 255.0);
  return (code + 0.5) * step - 3.0;
}

namespace {

CamFacts multiplier_facts() {
  CamFacts f;
  f.name = "Multiplier";
  f.options = {"Sample and Hold Off", "Sample and Hold On"};
  f.parameters = {{"scale_per_v"}};
  f.resources = Resources{.opamps = 1, .capacitors = 4, .comparators = 1, .sars = 1};
  f.transfer = "scale X Y/z, Y converted to 8 bits over +-3 V";
  f.transfer_ground = Ground::seen;
  f.delay_cycles = 1.0;
  f.clock_b_ratio = 16;
  f.limits = "scale 0.33 to 4; with sample and hold 6 capacitors and 2 op-amps";
  return f;
}

class MultiplierStep final : public CamStep {
 public:
  explicit MultiplierStep(double scale_per_v) : multiplier_{.scale_per_v = scale_per_v} {}
  double at_edge(std::span<const double> inputs) override { return multiplier_.output(inputs[0], inputs[1]); }

 private:
  Multiplier multiplier_;
};

class MultiplierCam : public Cam {
 public:
  MultiplierCam() : Cam(multiplier_facts()) {}

  std::unique_ptr<CamStep> step(const PlacedCam& cam) const override {
    return std::make_unique<MultiplierStep>(cam.requested.required_number("scale_per_v"));
  }
  std::string picture_text(const PlacedCam& cam) const override {
    return fmt::format("{} X Y, Y 8 bits",
                       rounded_text(cam.requested.number("scale_per_v").value_or(1.0), 3));
  }
};

}  // namespace

BODESMITH_ENTRY(Cam, multiplier_cam, MultiplierCam)

}  // namespace bodesmith::fpaa
