#include <fmt/format.h>

#include <algorithm>

#include "base/text.hpp"
#include "fpaa/cams/cam.hpp"

namespace bodesmith::fpaa {
namespace {

constexpr Resources kGainInvResources{.opamps = 1, .capacitors = 4};

/// CAM GainInv: H = -Cin/Cout, valid during the full cycle; four capacitors (the two that set the gain are
/// named Cin and Cout), one op-amp.
class GainInv : public Cam {
 public:
  GainInv()
      : Cam(CamFacts{.name = "GainInv", .parameters = {{"gain", "Gain"}}, .resources = kGainInvResources}) {}

  ZTransfer transfer(const PlacedCam&, const CapacitorUnits& c) const override {
    return {{{-c["Cin"]}}, {c["Cout"]}};
  }

  /// The pair may be there twice.
  std::vector<Capacitor> vendor_capacitors(const PlacedCam& cam,
                                           std::span<const std::string> table) const override {
    std::vector<Capacitor> out;
    for (const Capacitor& c : cam.capacitors) {
      out.push_back(c);
      const std::string second = "a" + c.name;
      if (std::ranges::find(table, second) != table.end()) out.push_back({second, c.units});
    }
    return out;
  }

  /// Both ratios twice, static and switched: the output is right in both phases.
  std::optional<StageSwitches> switches(const PlacedCam&, const CapacitorUnits& c) const override {
    const double cin = c["Cin"];
    const double cout = c["Cout"];
    StageSwitches s;
    s.capacitors = {
        static_branch("aCin", cin, PlateNode::input()), switched_branch("Cin", cin, PlateNode::input()),
        static_branch("aCout", cout, PlateNode::opamp()), switched_branch("Cout", cout, PlateNode::opamp())};
    return s;
  }

  std::optional<ZrnaModule> zrna_module(const PlacedCam&) const override {
    return ZrnaModule{"GainInv", "", {{"gain", "gain"}}};
  }

  std::string picture_text(const PlacedCam& cam) const override {
    return fmt::format("gain {}", rounded_text(cam.realised.required_number("gain"), 4));
  }

  bool is_gain() const override { return true; }
};

}  // namespace

BODESMITH_ENTRY(Cam, gain_inv_cam, GainInv)

}  // namespace bodesmith::fpaa
