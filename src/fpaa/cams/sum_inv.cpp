#include "fpaa/cams/sum_inv.hpp"

#include <fmt/format.h>

#include "base/text.hpp"
#include "fpaa/cams/cam.hpp"

namespace bodesmith::fpaa {

std::vector<Capacitor> SumInvCapacitors::named() const {
  std::vector<Capacitor> out;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    out.push_back({fmt::format("Cin{}", i + 1), inputs[i].cin});
    if (inputs[i].acin > 0) out.push_back({fmt::format("aCin{}", i + 1), inputs[i].acin});
  }
  out.push_back({"Cout", cout});
  out.push_back({"aCout", acout});
  return out;
}

namespace {

CamFacts sum_inv_facts() {
  CamFacts f;
  f.name = "SumInv";
  f.options = {"2 inputs", "3 inputs"};
  f.parameters = {{"gain_1", "Gain 1"}, {"gain_2", "Gain 2"}, {"gain_3", "Gain 3"},
                  {"gain_4", "Gain 4"}, {"gain_5", "Gain 5"}, {"gain_6", "Gain 6"}};
  f.resources = Resources{.opamps = 1, .capacitors = 6};
  f.transfer = "sum of -(Cin_i + aCin_i(1 - 1/z))/(Cout + aCout(1 - 1/z)) V_i";
  f.transfer_ground = Ground::derived;
  f.limits = "two capacitors an input and two more; one less for an input without aCin";
  return f;
}

class SumInv : public Cam {
 public:
  SumInv() : Cam(sum_inv_facts()) {}

  /// As AnadigmDesigner2 makes it: two capacitors an input, two of feedback.
  std::optional<Resources> resources(std::size_t inputs) const override {
    return Resources{.opamps = 1, .capacitors = 2 * static_cast<int>(inputs) + 2};
  }

  std::string assumption() const override {
    return "SumInv is the whole-period sum with a capacitor pair an input; where a plan leaves out a static "
           "one (aCin) or makes it differ from Cin, the capacitors are set by stream: AnadigmDesigner2 itself "
           "makes pairs of equal ones, up to three inputs.";
  }

  DeltaTransfer transfer(const PlacedCam& cam, const CapacitorUnits& c) const override {
    return transfers(cam, c).front();
  }

  std::vector<DeltaTransfer> transfers(const PlacedCam& cam, const CapacitorUnits& c) const override {
    std::vector<DeltaTransfer> out;
    for (std::size_t i = 1; i <= cam.input_count(); ++i) {
      out.push_back({{-c[fmt::format("Cin{}", i)], -c[fmt::format("aCin{}", i)]}, {c["Cout"], c["aCout"]}});
    }
    return out;
  }

  std::optional<StageSwitches> switches(const PlacedCam& cam) const override {
    StageSwitches s;
    const auto add = [&](const std::string& name, PlateNode from) {
      const int fixed = cam.units_of("a" + name);
      if (fixed > 0) s.capacitors.push_back(static_branch("a" + name, fixed, from));
      s.capacitors.push_back(switched_branch(name, cam.units_of(name), from));
    };
    for (std::size_t i = 1; i <= cam.input_count(); ++i) {
      add(fmt::format("Cin{}", i), PlateNode::input(static_cast<int>(i)));
    }
    // The feedback as in GainInv, though here every capacitor has a value of its own.
    add("Cout", PlateNode::opamp());
    return s;
  }

  std::string picture_text(const PlacedCam& cam) const override {
    std::string out = "gains";
    for (std::size_t i = 1; i <= cam.input_count(); ++i) {
      out += " " + rounded_text(cam.realised.number(fmt::format("gain_{}", i)).value_or(0.0), 3);
    }
    return out;
  }

  /// Up to three inputs of equal pairs.
  bool in_vendor_menu(const PlacedCam& cam) const override {
    if (cam.input_count() > 3 || cam.units_of("Cout") != cam.units_of("aCout")) return false;
    for (std::size_t i = 1; i <= cam.input_count(); ++i) {
      if (cam.units_of(fmt::format("Cin{}", i)) != cam.units_of(fmt::format("aCin{}", i))) return false;
    }
    return true;
  }
  bool is_gain() const override { return true; }
};

}  // namespace

BODESMITH_ENTRY(Cam, sum_inv_cam, SumInv)

}  // namespace bodesmith::fpaa
