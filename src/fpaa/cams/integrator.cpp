#include "fpaa/cams/cam.hpp"

namespace bodesmith::fpaa {
namespace {

constexpr const char* kNonInverting = "Non-inverting";

/// Inverting -(Cin/Cint)/(1 - 1/z), not inverting (Cin/Cint) z^-1/(1 - 1/z) (derived).
class IntegratorCam : public Cam {
 public:
  IntegratorCam()
      : Cam(CamFacts{.name = "Integrator", .resources = Resources{.opamps = 1, .capacitors = 2}}) {}

  ZTransfer transfer(const PlacedCam& cam, const CapacitorUnits& c) const override {
    const std::vector<double> above =
        cam.option == kNonInverting ? std::vector{0.0, c["Cin"]} : std::vector{-c["Cin"]};
    return {{above}, {c["Cint"], -c["Cint"]}};
  }

  /// Not inverting: Cin takes up the input in phase 1 and gives it in phase 2, so that the sample is in the
  /// next phase 1 for the first time.
  std::optional<StageSwitches> switches(const PlacedCam& cam, const CapacitorUnits& c) const override {
    StageCapacitor in = switched_branch("Cin", c["Cin"], PlateNode::input());
    if (cam.option == kNonInverting) in.far = in.far.mirrored();
    StageSwitches s;
    s.capacitors = {in, static_branch("Cint", c["Cint"], PlateNode::opamp())};
    return s;
  }
};

}  // namespace

BODESMITH_ENTRY(Cam, integrator_cam, IntegratorCam)

}  // namespace bodesmith::fpaa
