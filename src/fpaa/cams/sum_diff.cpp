#include <fmt/format.h>

#include <cmath>

#include "base/text.hpp"
#include "fpaa/cams/cam.hpp"

namespace bodesmith::fpaa {

namespace {

/// Sum of +-Ci/Cout Vi: inverting inputs without delay, the others z^-1/2; valid for half a cycle (seen).
class SumDiffCam : public Cam {
 public:
  SumDiffCam()
      : Cam(CamFacts{.name = "SumDiff",
                     .resources = Resources{.opamps = 1, .capacitors = 3},
                     .half_cycle_output = true}) {}

  /// One capacitor an input and Cout.
  std::optional<Resources> resources(std::size_t inputs) const override {
    Resources out = facts().resources.value();
    out.capacitors = static_cast<int>(inputs) + 1;
    return out;
  }

  ZTransfer transfer(const PlacedCam& cam, const CapacitorUnits& c) const override {
    ZTransfer out{{}, {c["Cout"]}};
    for (std::size_t i = 1; i <= cam.input_count(); ++i) {
      const double gain = cam.realised.number(fmt::format("gain_{}", i)).value_or(-1.0);
      out.numerators.push_back({std::copysign(c[fmt::format("Cin{}", i)], gain)});
    }
    return out;
  }

  /// Gains below 0 invert.
  std::optional<StageSwitches> switches(const PlacedCam& cam, const CapacitorUnits& c) const override {
    StageSwitches s;
    s.opamps = {{.reset_phase = 2}};
    s.output_phase = 1;
    for (int i = 1; i <= 4; ++i) {
      const std::string name = fmt::format("Cin{}", i);
      const double units = c[name];
      const auto gain = cam.realised.number(fmt::format("gain_{}", i));
      if (!(units > 0.0) || !gain) continue;
      StageCapacitor in = half_period_branch(name, units, PlateNode::input(i));
      if (*gain > 0.0) in.near = in.near.mirrored();
      s.capacitors.push_back(in);
    }
    s.capacitors.push_back(half_period_branch("Cout", c["Cout"], PlateNode::opamp()));
    return cam.phase == 2 ? s.mirrored() : s;
  }
  std::string picture_text(const PlacedCam& cam) const override {
    std::string out;
    for (const CamValues::Entry& entry : cam.realised.entries()) {
      if (!out.empty()) out += ", ";
      out += rounded_text(entry.number().value_or(0.0), 3);
    }
    return "gains " + out;
  }
};

}  // namespace

BODESMITH_ENTRY(Cam, sum_diff_cam, SumDiffCam)

}  // namespace bodesmith::fpaa
