#include "fpaa/cams/gain_inv.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/text.hpp"
#include "fpaa/cams/cam.hpp"

namespace bodesmith::fpaa {
namespace {

constexpr Resources kGainInvResources{.opamps = 1, .capacitors = 4};

class GainInvTask : public CamTask {
 public:
  GainInvTask(const Cam& cam, const std::string& name) : CamTask(cam, name, std::nullopt) {}

  Resources resources() const override { return kGainInvResources; }
  std::complex<double> response(RadPerSecond) const override { return 1.0; }
  std::vector<Branch> branches() const override {
    return {{Branch::Kind::constant, {}, true, 0}, {Branch::Kind::constant, {}, false, 0}};
  }
  PlacedCam realise(std::span<const BranchValue> values, const TaskSetting& setting) const override {
    const GainInvCapacitors c{values[0].c0, values[1].c0};
    PlacedCam out = start(setting, "");
    out.requested = {{"gain", setting.gain}};
    out.realised = {{"gain", c.gain()}};
    out.capacitors = {{"Cin", c.cin}, {"Cout", c.cout}};
    out.z = c.transfer();
    return out;
  }
};

CamFacts gain_inv_facts() {
  CamFacts f;
  f.name = "GainInv";
  f.parameters = {{"gain", "Gain"}};
  f.resources = kGainInvResources;
  f.transfer = "-Cin/Cout";
  f.transfer_ground = Ground::derived;
  f.limits = "output valid the full cycle";
  return f;
}

class GainInv : public Cam {
 public:
  GainInv() : Cam(gain_inv_facts()) {}

  CamTaskPtr gain_stage(const std::string& name) const override {
    return std::make_shared<GainInvTask>(*this, name);
  }

  std::string note(const PlacedCam&) const override {
    return "GainInv is there to keep the total sign (every FilterBilinear inverts) or to carry gain.";
  }

  DeltaTransfer transfer(const PlacedCam&, const CapacitorUnits& c) const override {
    return {{-c["Cin"]}, {c["Cout"]}};
  }

  std::vector<NoiseCharge> noise_charges(const PlacedCam& cam) const override {
    const CapacitorUnits c(cam.capacitors);
    return {{c["Cin"] + c["Cout"], {{1.0}, {c["Cout"]}}}};
  }

  /// The pair may be there twice.
  std::vector<Capacitor> vendor_capacitors(const PlacedCam& cam,
                                           std::span<const std::string> table) const override {
    std::vector<Capacitor> out;
    for (const Capacitor& c : cam.capacitors) {
      out.push_back(c);
      const std::string second = "a" + c.name;
      if (std::find(table.begin(), table.end(), second) != table.end()) out.push_back({second, c.units});
    }
    return out;
  }

  /// Both ratios twice, static and switched: the output is right in both phases.
  std::optional<StageSwitches> switches(const PlacedCam& cam) const override {
    const int cin = cam.units_of("Cin");
    const int cout = cam.units_of("Cout");
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

const Cam& gain_inv_cam() {
  static const GainInv cam;
  return cam;
}

}  // namespace bodesmith::fpaa
