#include <fmt/format.h>

#include "base/text.hpp"
#include "fpaa/cams/filter_stage.hpp"

namespace bodesmith::fpaa {
namespace {

/// A stage of this program's own: the FilterBiquad's two integrators with all three inputs at once, so that any second-order numerator
/// over any second-order denominator is one CAB. One bank each, 8 capacitors at most.
class BiquadStage : public FilterCam {
 public:
  BiquadStage()
      : FilterCam(CamFacts{.name = "BiquadStage", .resources = Resources{.opamps = 2, .capacitors = 8}}) {}

  std::string assumption() const override {
    return "BiquadStage is the vendor's biquad (switches of its band-pass form) with all three inputs, by charge "
           "balance; AnadigmDesigner2 has no such CAM, so it is made by stream only, and was not tried on "
           "silicon.";
  }

  bool in_vendor_menu(const PlacedCam&) const override { return false; }

  std::string picture_text(const PlacedCam& cam) const override {
    return fmt::format("f0 {} · Q {}",
                       engineering_text(cam.realised.number("natural_hz").value_or(0.0), "Hz", 4),
                       rounded_text(cam.realised.number("quality").value_or(0.0), 3));
  }

 protected:
  std::vector<Named> names(const PlacedCam&) const override { return second_order_named(); }
  bool makes(const FilterStage& stage) const override { return !stage.is_first() && !stage.is_vendors(); }
  std::string option_of(const FilterStage& stage) const override {
    return fmt::format("{}{}", stage.kind == FilterStage::Kind::second_high ? "High Q" : "Low Q",
                       stage.c1_inverting ? "" : ", C1 non-inverting");
  }
  CamValues shown(const FilterStage& stage, Hertz clock) const override {
    return {{"natural_hz", stage.corner(clock).value}, {"quality", stage.quality()}};
  }
  FilterStage form(const PlacedCam& cam) const override {
    const bool high = cam.option.rfind("High", 0) == 0;
    return {high ? FilterStage::Kind::second_high : FilterStage::Kind::second_low, std::vector<double>(8),
            cam.option.find("non-inverting") == std::string::npos};
  }
};

}  // namespace

BODESMITH_ENTRY(Cam, biquad_stage_cam, BiquadStage)

}  // namespace bodesmith::fpaa
