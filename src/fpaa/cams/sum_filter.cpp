#include "fpaa/cams/cam.hpp"

namespace bodesmith::fpaa {
namespace {

/// CAM SumFilter, assumed to be the FilterBilinear low pass with two input branches:
///   Vout = -(C1 V1 + C2 V2)/(Cout + Cint (1 - 1/z)). Four capacitors, one op-amp.
class SumFilterCam : public Cam {
 public:
  SumFilterCam() : Cam(CamFacts{.name = "SumFilter", .resources = Resources{.opamps = 1, .capacitors = 4}}) {}

  ZTransfer transfer(const PlacedCam&, const CapacitorUnits& c) const override {
    return {{{-c["C1"]}, {-c["C2"]}}, {c["Cout"] + c["Cint"], -c["Cint"]}};
  }

  /// Taken to be the FilterBilinear low pass with a second input branch.
  std::optional<StageSwitches> switches(const PlacedCam&, const CapacitorUnits& c) const override {
    StageSwitches s;
    s.capacitors = {switched_branch("C1", c["C1"], PlateNode::input(1)),
                    switched_branch("C2", c["C2"], PlateNode::input(2)),
                    switched_branch("Cout", c["Cout"], PlateNode::opamp()),
                    static_branch("Cint", c["Cint"], PlateNode::opamp())};
    return s;
  }
};

}  // namespace

BODESMITH_ENTRY(Cam, sum_filter_cam, SumFilterCam)

}  // namespace bodesmith::fpaa
