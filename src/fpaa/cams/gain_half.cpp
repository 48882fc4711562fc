#include "fpaa/cams/cam.hpp"

namespace bodesmith::fpaa {
namespace {

constexpr const char* kGainHalfNonInverting = "Non-inverting";

/// -+Cin/Cout, back at ground in the other half cycle; not inverting it is half a cycle late (derived).
class GainHalfCam : public Cam {
 public:
  GainHalfCam()
      : Cam(CamFacts{.name = "GainHalf",
                     .resources = Resources{.opamps = 1, .capacitors = 2},
                     .half_cycle_output = true}) {}

  ZTransfer transfer(const PlacedCam& cam, const CapacitorUnits& c) const override {
    return {{{(cam.option == kGainHalfNonInverting ? 1.0 : -1.0) * c["Cin"]}}, {c["Cout"]}};
  }

  /// SumDiff with one input.
  std::optional<StageSwitches> switches(const PlacedCam& cam, const CapacitorUnits& c) const override {
    StageCapacitor in = half_period_branch("Cin", c["Cin"], PlateNode::input());
    if (cam.option == kGainHalfNonInverting) in.near = in.near.mirrored();
    StageSwitches s;
    s.opamps = {{.reset_phase = 2}};
    s.output_phase = 1;
    s.capacitors = {in, half_period_branch("Cout", c["Cout"], PlateNode::opamp())};
    return cam.phase == 2 ? s.mirrored() : s;
  }
};

}  // namespace

BODESMITH_ENTRY(Cam, gain_half_cam, GainHalfCam)

}  // namespace bodesmith::fpaa
