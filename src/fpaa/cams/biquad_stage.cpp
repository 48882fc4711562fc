#include "fpaa/cams/biquad_stage.hpp"

#include <fmt/format.h>

#include "base/text.hpp"
#include "fpaa/cams/cam.hpp"

namespace bodesmith::fpaa {

BiquadStageCapacitors BiquadStageCapacitors::from(const CapacitorUnits& c, bool high_q, bool c1_inverting) {
  return {.high_q = high_q,
          .c1_inverting = c1_inverting,
          .c1 = c["C1"],
          .cp = c["Cp"],
          .cpp = c["Cpp"],
          .c2 = c["C2"],
          .c3 = c["C3"],
          .c4 = c["C4"],
          .ca = c["CA"],
          .cb = c["CB"]};
}

DeltaTransfer BiquadStageCapacitors::transfer() const {
  const double loop = c2 * c3;
  const double first = (c1_inverting ? 1.0 : -1.0) * c1 * c3;
  DeltaTransfer h;
  // 1/z = 1 - D.
  if (high_q) {
    h.numerator = {-first, first - cp * c3, cp * c3 - cpp * ca};
    h.denominator = {loop, c3 * c4 - loop, ca * cb - c3 * c4};
  } else {
    h.numerator = {-first, first - cp * ca, -cpp * ca};
    h.denominator = {loop, ca * c4 - loop, ca * cb};
  }
  return h;
}

std::string biquad_stage_option(bool high_q, bool c1_inverting) {
  return fmt::format("{}{}", high_q ? "High Q" : "Low Q", c1_inverting ? "" : ", C1 non-inverting");
}

namespace {

BiquadStageCapacitors biquad_stage_of(const PlacedCam& cam, const CapacitorUnits& c) {
  return BiquadStageCapacitors::from(c, cam.option.rfind("High", 0) == 0,
                                     cam.option.find("non-inverting") == std::string::npos);
}

CamFacts biquad_stage_facts() {
  CamFacts f;
  f.name = "BiquadStage";
  f.options = {"Low Q", "Low Q, C1 non-inverting", "High Q", "High Q, C1 non-inverting"};
  f.parameters = {{"natural_hz"}, {"quality"}};
  f.resources = Resources{.opamps = 2, .capacitors = 8};
  f.transfer = "see biquad_stage.hpp";
  f.transfer_ground = Ground::derived;
  f.limits = "not in AnadigmDesigner2's menu: by stream only";
  return f;
}

class BiquadStage : public Cam {
 public:
  BiquadStage() : Cam(biquad_stage_facts()) {}

  std::string assumption() const override {
    return "BiquadStage is the vendor's biquad (switches of its band-pass form) with all three inputs, by charge "
           "balance; AnadigmDesigner2 has no such CAM, so it is made by stream only, and was not tried on "
           "silicon.";
  }

  DeltaTransfer transfer(const PlacedCam& cam, const CapacitorUnits& c) const override {
    return biquad_stage_of(cam, c).transfer();
  }

  /// In the vendor's order for its band pass; what is not there takes no capacitor.
  std::optional<StageSwitches> switches(const PlacedCam& cam) const override {
    const PlateNode in = PlateNode::input();
    const PlateNode first = PlateNode::opamp(1);
    const PlateNode second = PlateNode::opamp(2);
    const BiquadStageCapacitors form = biquad_stage_of(cam, CapacitorUnits(cam.capacitors));
    StageSwitches s;
    s.opamps = {{}, {}};
    s.output = 2;
    const auto add = [&](StageCapacitor c) {
      if (c.units > 0) s.capacitors.push_back(std::move(c));
    };
    const auto units = [&](const char* name) { return cam.units_of(name); };
    StageCapacitor c1 = switched_branch("C1", units("C1"), in, 1);
    if (!form.c1_inverting) c1.far = c1.far.mirrored();
    add(switched_branch("C2", units("C2"), second, 1));
    add(static_branch("CA", units("CA"), first, 1));
    add(c1);
    add(form.high_q ? static_branch("Cp", units("Cp"), in, 1) : switched_branch("Cp", units("Cp"), in, 2));
    add(static_branch("Cpp", units("Cpp"), in, 2));
    add(delayed_branch("C3", units("C3"), first, 2));
    add(form.high_q ? static_branch("C4", units("C4"), second, 1)
                    : switched_branch("C4", units("C4"), second, 2));
    add(static_branch("CB", units("CB"), second, 2));
    return s;
  }

  bool in_vendor_menu(const PlacedCam&) const override { return false; }

  std::string picture_text(const PlacedCam& cam) const override {
    return fmt::format("f0 {} · Q {}",
                       engineering_text(cam.realised.number("natural_hz").value_or(0.0), "Hz", 4),
                       rounded_text(cam.realised.number("quality").value_or(0.0), 3));
  }
};

}  // namespace

BODESMITH_ENTRY(Cam, biquad_stage_cam, BiquadStage)

}  // namespace bodesmith::fpaa
