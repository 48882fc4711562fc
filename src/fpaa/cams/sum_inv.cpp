#include <fmt/format.h>

#include "base/text.hpp"
#include "fpaa/cams/filter_stage.hpp"

namespace bodesmith::fpaa {
namespace {

/// The whole-period sum of 1 to 6 inputs, one op-amp. aCin_i = Cin_i and aCout = Cout is the plain gain that AnadigmDesigner2 makes;
/// without aCin an input is a fast low pass (corner about fc Cout/aCout), with more of it the input leads.
class SumInv : public FilterCam {
 public:
  SumInv()
      : FilterCam(CamFacts{.name = "SumInv",
                           .parameters = {{"gain_1", "Gain 1"},
                                          {"gain_2", "Gain 2"},
                                          {"gain_3", "Gain 3"},
                                          {"gain_4", "Gain 4"},
                                          {"gain_5", "Gain 5"},
                                          {"gain_6", "Gain 6"}},
                           .resources = Resources{.opamps = 1, .capacitors = 6}}) {}

  std::string assumption() const override {
    return "SumInv is the whole-period sum with a capacitor pair an input; where a plan leaves out a static "
           "one (aCin) or makes it differ from Cin, the capacitors are set by stream: AnadigmDesigner2 itself "
           "makes pairs of equal ones, up to three inputs.";
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
    const CapacitorUnits c(cam.capacitors);
    const std::vector<Named> all = names(cam);
    for (std::size_t i = 0; i < all.size(); i += 2) {
      if (c[all[i].name] != c[all[i + 1].name]) return false;
    }
    return cam.input_count() <= 3;
  }
  bool is_gain() const override { return true; }

 protected:
  std::vector<Named> names(const PlacedCam& cam) const override {
    std::vector<Named> out;
    const auto add = [&](const std::string& name) {
      out.push_back({name, out.size()});
      out.push_back({"a" + name, out.size()});
    };
    for (std::size_t i = 1; i <= cam.input_count(); ++i) add(fmt::format("Cin{}", i));
    add("Cout");
    return out;
  }
  bool makes(const FilterStage& stage) const override { return stage.is_first() && stage.inputs() > 1; }
  std::string option_of(const FilterStage& stage) const override {
    return fmt::format("{} inputs", stage.inputs());
  }
  CamValues shown(const FilterStage& stage, Hertz) const override {
    CamValues out;
    const std::size_t n = stage.inputs();
    for (std::size_t i = 0; i < n; ++i)
      out.set(fmt::format("gain_{}", i + 1), stage.c[2 * i] / stage.c[2 * n]);
    return out;
  }
  FilterStage form(const PlacedCam& cam) const override {
    return {.c = std::vector<double>(2 * cam.input_count() + 2)};
  }
};

}  // namespace

BODESMITH_ENTRY(Cam, sum_inv_cam, SumInv)

}  // namespace bodesmith::fpaa
