#include "fpaa/cams/biquad_stage.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/text.hpp"
#include "base/whole_number.hpp"
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

Hertz BiquadStageCapacitors::corner(Hertz clock) const {
  const double root = std::sqrt(c2 * c3 / (ca * cb));
  return {clock.value / std::numbers::pi * std::asin(std::min(1.0, 0.5 * root))};
}

double BiquadStageCapacitors::quality() const {
  return high_q ? std::sqrt(ca * cb * c2 / c3) / c4 : cb * std::sqrt(c2 * c3 / (ca * cb)) / c4;
}

double BiquadStageCapacitors::gain() const {
  if (c1 > 0.0) return c1 / c2;
  return cp > 0.0 ? cp / c4 : cpp / cb;
}

/// Op-amp 1 integrates input and output, op-amp 2 what op-amp 1 was a period before (C3). The vendor's band pass of low
/// quality is in public streams; the other inputs move as their equations say.
StageSwitches BiquadStageCapacitors::switches(bool banks) const {
  constexpr int kUnitsOfBank = 255;
  const PlateNode in = PlateNode::input();
  const PlateNode first = PlateNode::opamp(1);
  const PlateNode second = PlateNode::opamp(2);
  StageSwitches s;
  s.opamps = {{}, {}};
  s.output = 2;
  const auto add = [&](StageCapacitor c) {
    if (c.units > 0) s.capacitors.push_back(std::move(c));
  };
  const auto whole = [](double units) { return nearest_whole<int>(units); };
  const auto add_feedback = [&](const std::string& name, double units, PlateNode from, int opamp) {
    const int one = banks ? std::min(whole(units), kUnitsOfBank) : whole(units);
    add(static_branch(banks ? name + "1" : name, one, from, opamp));
    add(static_branch(name + "2", whole(units) - one, from, opamp));
  };
  StageCapacitor from_c1 = switched_branch("C1", whole(c1), in, 1);
  if (!c1_inverting) from_c1.far = from_c1.far.mirrored();
  add(switched_branch("C2", whole(c2), second, 1));
  add_feedback("CA", ca, first, 1);
  add(from_c1);
  add(high_q ? static_branch("Cp", whole(cp), in, 1) : switched_branch("Cp", whole(cp), in, 2));
  add(static_branch("Cpp", whole(cpp), in, 2));
  add(delayed_branch("C3", whole(c3), first, 2));
  add(high_q ? static_branch("C4", whole(c4), second, 1) : switched_branch("C4", whole(c4), second, 2));
  add_feedback("CB", cb, second, 2);
  return s;
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

  std::optional<StageSwitches> switches(const PlacedCam& cam) const override {
    return biquad_stage_of(cam, CapacitorUnits(cam.capacitors)).switches(false);
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
