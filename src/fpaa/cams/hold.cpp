#include "fpaa/cams/cam.hpp"

namespace bodesmith::fpaa {
namespace {

/// 1/z (seen). Two in series need opposite phases.
class HoldCam : public Cam {
 public:
  HoldCam()
      : Cam(CamFacts{.name = "Hold",
                     .resources = Resources{.opamps = 1, .capacitors = 2},
                     .delay_cycles = 0.5,  // sampled in its phase, shown from the other one on
                     .takes_half_cycle_anywhere = true}) {}

  /// It samples in the phase that is stated; the output is new in the other one.
  std::optional<StageSwitches> switches(const PlacedCam& cam, const CapacitorUnits&) const override {
    using Node = PlateNode;
    const Node virtual_ground = Node::virtual_ground();
    StageSwitches s;
    s.capacitors = {
        {"C1", kHoldUnits, {Node::input(), Node::opamp()}, {Node::ground(), virtual_ground}},
        {"C2", kHoldUnits, Plate::fixed(Node::opamp()), {virtual_ground, Node::ground()}},
    };
    return cam.phase == 2 ? s.mirrored() : s;
  }
  std::string picture_text(const PlacedCam& cam) const override {
    return cam.phase == 2 ? "samples in phase 2" : "samples in phase 1";
  }
};

}  // namespace

BODESMITH_ENTRY(Cam, hold_cam, HoldCam)

}  // namespace bodesmith::fpaa
