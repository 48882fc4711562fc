#include "fpaa/cams/multiplier.hpp"

#include <fmt/format.h>

#include "base/text.hpp"
#include "fpaa/cams/cam.hpp"
#include "fpaa/cams/transfer_function.hpp"

namespace bodesmith::fpaa {

double Multiplier::quantised(double y_v) {
  return LookupTable::input_v(LookupTable::entry_of(y_v));
}

namespace {

class MultiplierCam : public Cam {
 public:
  MultiplierCam()
      : Cam(CamFacts{.name = "Multiplier",
                     .resources = Resources{.opamps = 1, .capacitors = 4, .comparators = 1, .sars = 1},
                     .delay_cycles = 1.0,
                     .clock_b_ratio = 16}) {}

  CamStep step(const PlacedCam& cam) const override {
    return [made = Multiplier{.scale_per_v = cam.requested.required_number("scale_per_v")}](
               std::span<const double> inputs) { return made.output(inputs[0], inputs[1]); };
  }
  std::string picture_text(const PlacedCam& cam) const override {
    return fmt::format("{} X Y, Y 8 bits",
                       rounded_text(cam.requested.number("scale_per_v").value_or(1.0), 3));
  }
};

}  // namespace

BODESMITH_ENTRY(Cam, multiplier_cam, MultiplierCam)

}  // namespace bodesmith::fpaa
