#include <fmt/format.h>

#include "base/text.hpp"
#include "fpaa/cams/cam.hpp"

namespace bodesmith::fpaa {
namespace {

/// -+Cin/Cout, both emptied in the other phase; not inverting it is half a cycle late (derived).
class SampledGainCam : public Cam {
 public:
  using Cam::Cam;

  ZTransfer transfer(const PlacedCam& cam, const CapacitorUnits& c) const final {
    return {{{(is_inverting(cam) ? -1.0 : 1.0) * c["Cin"]}}, {c["Cout"]}};
  }

  /// SumDiff with one input, and what keeps its output.
  std::optional<StageSwitches> switches(const PlacedCam& cam, const CapacitorUnits& c) const final {
    StageCapacitor in = half_period_branch("Cin", c["Cin"], PlateNode::input());
    if (!is_inverting(cam)) in.near = in.near.mirrored();
    StageSwitches s;
    s.capacitors = {in, half_period_branch("Cout", c["Cout"], PlateNode::opamp())};
    keep_output(s);
    return cam.phase == 2 ? s.mirrored() : s;
  }

 private:
  static bool is_inverting(const PlacedCam& cam) { return cam.option != "Non-inverting"; }
  virtual void keep_output(StageSwitches& s) const = 0;
};

/// Back at ground in the other half cycle.
class GainHalfCam : public SampledGainCam {
 public:
  GainHalfCam()
      : SampledGainCam(CamFacts{.name = "GainHalf",
                                .resources = Resources{.opamps = 1, .capacitors = 2},
                                .half_cycle_output = true}) {}

 private:
  void keep_output(StageSwitches& s) const override {
    s.opamps = {{.reset_phase = 2}};
    s.output_phase = 1;
  }
};

/// Held for the whole period by the third capacitor, which keeps the output while Cin and Cout are emptied.
///
/// Not inverting and in phase 2 it is not quite held: while the third capacitor holds (phase 1), Cin already follows the input, so that
/// the output moves by -Cin/255 of the input's next step, until phase 2 sets it. (In phase 1 the same input is still there; where it
/// inverts, Cin is at ground then.)
class GainHoldCam : public SampledGainCam {
 public:
  GainHoldCam()
      : SampledGainCam(CamFacts{.name = "GainHold", .resources = Resources{.opamps = 1, .capacitors = 3}}) {}

  std::string picture_text(const PlacedCam& cam) const override {
    return fmt::format("gain {}, held", rounded_text(cam.realised.number("gain").value_or(1.0), 4));
  }

 private:
  void keep_output(StageSwitches& s) const override {
    s.capacitors.push_back({"Chold",
                            kHoldUnits,
                            Plate::fixed(PlateNode::opamp()),
                            {PlateNode::ground(), PlateNode::virtual_ground()}});
  }
};

}  // namespace

BODESMITH_ENTRY(Cam, gain_half_cam, GainHalfCam)
BODESMITH_ENTRY(Cam, gain_hold_cam, GainHoldCam)

}  // namespace bodesmith::fpaa
