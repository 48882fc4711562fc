#include <fmt/format.h>

#include "base/text.hpp"
#include "fpaa/cams/filter_stage.hpp"

namespace bodesmith::fpaa {
namespace {

constexpr const char* kPoleAndZero = "Pole and Zero";
constexpr const char* kLowPass = "Low Pass";
constexpr const char* kHighPass = "High Pass";

/// One op-amp, one input: three capacitors, or four.
class FilterBilinear : public FilterCam {
 public:
  FilterBilinear()
      : FilterCam(CamFacts{.name = "FilterBilinear",
                           .parameters = {{"corner_hz", "Corner Frequency", true},
                                          {"gain", "Gain"},
                                          {"pole_hz", "Pole Frequency", true},
                                          {"zero_hz", "Zero Frequency", true},
                                          {"dc_gain", "DC Gain"},
                                          {"high_frequency_gain", "High Frequency Gain"}},
                           .resources = Resources{.opamps = 1, .capacitors = 4}}) {}

  std::string assumption() const override {
    return "FilterBilinear 'Pole and Zero' is taken to be H(z) = -(Ca + Cb(1 - 1/z))/(Cc + Cd(1 - 1/z)) with "
           "capacitors of 1 to 255 units; the vendor does not publish its topology. AnadigmDesigner2 chooses "
           "capacitors itself: type the realised parameters and compare what it reports.";
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
    const auto hz = [&](const char* key) {
      return engineering_text(cam.realised.required_number(key), "Hz", 4);
    };
    if (cam.option == kPoleAndZero) return fmt::format("zero {} · pole {}", hz("zero_hz"), hz("pole_hz"));
    return "corner " + hz("corner_hz");
  }

 protected:
  std::vector<Named> names(const PlacedCam& cam) const override {
    if (cam.option == kLowPass) return {{"Cin", 0}, {"Cint", 3}, {"Cout", 2}};
    return {{"Ca", 0}, {"Cb", 1}, {"Cc", 2}, {"Cd", 3}};  // high pass: no Ca
  }
  bool makes(const FilterStage& stage) const override { return stage.is_first() && stage.inputs() == 1; }
  std::string option_of(const FilterStage& stage) const override {
    return !(stage.c[1] > 0.0) ? kLowPass : stage.c[0] > 0.0 ? kPoleAndZero : kHighPass;
  }
  CamValues shown(const FilterStage& stage, Hertz clock) const override {
    const auto& c = stage.c;
    const double pole = stage.corner(clock).value;
    if (!(c[0] > 0.0 && c[1] > 0.0)) return {{"corner_hz", pole}, {"gain", stage.gain()}};
    return {{"pole_hz", pole},
            {"zero_hz", branch_corner(c[0], c[1], clock).value},
            {"dc_gain", stage.gain()},
            {"high_frequency_gain", (c[0] + 2.0 * c[1]) / (c[2] + 2.0 * c[3])}};
  }
  FilterStage form(const PlacedCam&) const override { return {.c = std::vector<double>(4)}; }
};

}  // namespace

BODESMITH_ENTRY(Cam, filter_bilinear_cam, FilterBilinear)

}  // namespace bodesmith::fpaa
