#include <fmt/format.h>

#include "base/text.hpp"
#include "fpaa/cams/cam.hpp"

namespace bodesmith::fpaa {
namespace {

constexpr const char* kGainHoldNonInverting = "Non-inverting";

/// -+Cin/Cout, held for the whole period; not inverting it is half a cycle late (derived).
///
/// Not inverting and in phase 2 it is not quite held: while the third capacitor holds (phase 1), Cin already follows the input, so that
/// the output moves by -Cin/255 of the input's next step, until phase 2 sets it. (In phase 1 the same input is still there; where it
/// inverts, Cin is at ground then.)
class GainHoldCam : public Cam {
 public:
  GainHoldCam() : Cam(CamFacts{.name = "GainHold", .resources = Resources{.opamps = 1, .capacitors = 3}}) {}

  ZTransfer transfer(const PlacedCam& cam, const CapacitorUnits& c) const override {
    return {{{(cam.option == kGainHoldNonInverting ? 1.0 : -1.0) * c["Cin"]}}, {c["Cout"]}};
  }

  /// Cin and Cout are emptied in the other phase, while the third capacitor keeps the output.
  std::optional<StageSwitches> switches(const PlacedCam& cam, const CapacitorUnits& c) const override {
    StageCapacitor in = half_period_branch("Cin", c["Cin"], PlateNode::input());
    if (cam.option == kGainHoldNonInverting) in.near = in.near.mirrored();
    StageSwitches s;
    s.capacitors = {in,
                    half_period_branch("Cout", c["Cout"], PlateNode::opamp()),
                    {"Chold",
                     kHoldUnits,
                     Plate::fixed(PlateNode::opamp()),
                     {PlateNode::ground(), PlateNode::virtual_ground()}}};
    return cam.phase == 2 ? s.mirrored() : s;
  }
  std::string picture_text(const PlacedCam& cam) const override {
    return fmt::format("gain {}, held", rounded_text(cam.realised.number("gain").value_or(1.0), 4));
  }
};

}  // namespace

BODESMITH_ENTRY(Cam, gain_hold_cam, GainHoldCam)

}  // namespace bodesmith::fpaa
