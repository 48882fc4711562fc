#include "fpaa/cams/filter_bilinear.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/text.hpp"
#include "fpaa/cams/cam.hpp"

namespace bodesmith::fpaa {
namespace {

constexpr const char* kPoleAndZero = "Pole and Zero";
constexpr const char* kLowPass = "Low Pass";
constexpr const char* kHighPass = "High Pass";

/// -(Ca + Cb D)/(Cc + Cd D), D = 1 - 1/z.
DeltaTransfer pole_zero_form(double ca, double cb, double cc, double cd) {
  return {{-ca, -cb}, {cc, cd}};
}
/// -Cin/(Cout + Cint D).
DeltaTransfer low_pass_form(double cin, double cint, double cout) {
  return {{-cin}, {cout, cint}};
}

CamFacts filter_bilinear_facts() {
  CamFacts f;
  f.name = "FilterBilinear";
  f.options = {kLowPass, kHighPass, "All Pass", kPoleAndZero};
  f.parameters = {{"corner_hz", "Corner Frequency", true},
                  {"gain", "Gain"},
                  {"pole_hz", "Pole Frequency", true},
                  {"zero_hz", "Zero Frequency", true},
                  {"dc_gain", "DC Gain"},
                  {"high_frequency_gain", "High Frequency Gain"}};
  f.resources = Resources{.opamps = 1, .capacitors = 4};
  f.transfer =
      "Low Pass: -Cin/(Cout + Cint(1 - 1/z)). Pole and Zero: -(Ca + Cb(1 - 1/z))/(Cc + Cd(1 - 1/z)). High "
      "Pass: the same without Ca. All Pass: not made (it needs a zero in the right half plane)";
  f.transfer_ground = Ground::assumed;
  f.limits = "corners from fc/1605 to about fc/4; low pass and high pass take 3 capacitors";
  return f;
}

class FilterBilinear : public Cam {
 public:
  FilterBilinear() : Cam(filter_bilinear_facts()) {}

  std::string assumption() const override {
    return "FilterBilinear 'Pole and Zero' is taken to be H(z) = -(Ca + Cb(1 - 1/z))/(Cc + Cd(1 - 1/z)) with "
           "capacitors of 1 to 255 units; the vendor does not publish its topology. AnadigmDesigner2 chooses "
           "capacitors itself: type the realised parameters and compare what it reports.";
  }

  DeltaTransfer transfer(const PlacedCam& cam, const CapacitorUnits& c) const override {
    if (cam.option == kLowPass) return low_pass_form(c["Cin"], c["Cint"], c["Cout"]);
    return pole_zero_form(c["Ca"], c["Cb"], c["Cc"], c["Cd"]);  // high pass: no Ca
  }

  /// The low pass is the vendor's; the pole-zero form is made by GainInv's switches with four different values
  /// (the high pass: without Ca). AD2's own layout of the latter two is in no public stream.
  std::optional<StageSwitches> switches(const PlacedCam& cam) const override {
    const auto units = [&](const char* name) { return cam.units_of(name); };
    const PlateNode in = PlateNode::input();
    const PlateNode out = PlateNode::opamp();
    StageSwitches s;
    if (cam.option == kLowPass) {
      s.capacitors = {switched_branch("Cin", units("Cin"), in), switched_branch("Cout", units("Cout"), out),
                      static_branch("Cint", units("Cint"), out)};
      return s;
    }
    s.capacitors = {static_branch("Cb", units("Cb"), in)};
    if (cam.option == kPoleAndZero) s.capacitors.push_back(switched_branch("Ca", units("Ca"), in));
    s.capacitors.push_back(static_branch("Cd", units("Cd"), out));
    s.capacitors.push_back(switched_branch("Cc", units("Cc"), out));
    return s;
  }

  std::optional<ZrnaModule> zrna_module(const PlacedCam& cam) const override {
    if (cam.option == kPoleAndZero) {
      return ZrnaModule{
          "FilterPoleZero",
          "dependent_variable=z.HIGH_FREQUENCY_GAIN",
          {{"pole_hz", "pole_frequency"}, {"zero_hz", "zero_frequency"}, {"dc_gain", "dc_gain"}}};
    }
    return ZrnaModule{cam.option == kLowPass ? "FilterLowpass" : "FilterHighpass",
                      "",
                      {{"corner_hz", "corner_frequency"}, {"gain", "gain"}}};
  }

  std::string picture_text(const PlacedCam& cam) const override {
    if (cam.option == kPoleAndZero) {
      const PoleZeroSpec spec = PoleZeroSpec::from(cam.realised);
      return fmt::format("zero {} · pole {}", engineering_text(spec.zero.value, "Hz", 4),
                         engineering_text(spec.pole.value, "Hz", 4));
    }
    return "corner " + engineering_text(CornerSpec::from(cam.realised).corner.value, "Hz", 4);
  }
};

}  // namespace

Hertz branch_corner(double c0, double c1, Hertz clock) {
  return {clock.value / std::numbers::pi * std::atan(c0 / (c0 + 2.0 * c1))};
}

CamValues PoleZeroSpec::values() const {
  return {{"pole_hz", pole.value},
          {"zero_hz", zero.value},
          {"dc_gain", dc_gain},
          {"high_frequency_gain", high_frequency_gain}};
}

PoleZeroSpec PoleZeroSpec::from(const CamValues& values) {
  return {{values.required_number("pole_hz")},
          {values.required_number("zero_hz")},
          values.number("dc_gain").value_or(1.0),
          values.number("high_frequency_gain").value_or(1.0)};
}

CamValues CornerSpec::values() const {
  return {{"corner_hz", corner.value}, {"gain", gain}};
}

CornerSpec CornerSpec::from(const CamValues& values) {
  return {{values.required_number("corner_hz")}, values.number("gain").value_or(1.0)};
}

ZTransfer PoleZeroCapacitors::transfer() const {
  return pole_zero_form(ca, cb, cc, cd).in_z();
}
Hertz PoleZeroCapacitors::zero(Hertz clock) const {
  return branch_corner(ca, cb, clock);
}
Hertz PoleZeroCapacitors::pole(Hertz clock) const {
  return branch_corner(cc, cd, clock);
}
PoleZeroSpec PoleZeroCapacitors::realised(Hertz clock) const {
  return {pole(clock), zero(clock), dc_gain(), high_frequency_gain()};
}

ZTransfer LowPassCapacitors::transfer() const {
  return low_pass_form(cin, cint, cout).in_z();
}
Hertz LowPassCapacitors::corner(Hertz clock) const {
  return branch_corner(cout, cint, clock);
}

ZTransfer HighPassCapacitors::transfer() const {
  return pole_zero_form(0.0, cb, cc, cd).in_z();
}
Hertz HighPassCapacitors::corner(Hertz clock) const {
  return branch_corner(cc, cd, clock);
}

BODESMITH_ENTRY(Cam, filter_bilinear_cam, FilterBilinear)

}  // namespace bodesmith::fpaa
