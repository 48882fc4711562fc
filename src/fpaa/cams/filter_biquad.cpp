#include <algorithm>

#include "base/text.hpp"
#include "fpaa/cams/filter_stage.hpp"

namespace bodesmith::fpaa {
namespace {

/// The value of "form" among the realised parameters.
constexpr const char* kHighQ = "high Q";

/// The stage of two op-amps with one input: C1 (option Low Pass), Cp (Band Pass) or Cpp (High Pass). CA and CB are each split over two
/// banks (up to 510 units). The low-pass form is derived from vendor code; band and high pass are the standard circuit that has the
/// vendor's gains (assumed).
class FilterBiquad : public FilterCam {
 public:
  FilterBiquad()
      : FilterCam(CamFacts{.name = "FilterBiquad",
                           .parameters = {{"corner_hz", "Corner Frequency", true},
                                          {"quality", "Quality Factor"},
                                          {"gain", "Gain"}},
                           .resources = Resources{.opamps = 2, .capacitors = 8}}) {}

  /// CA and CB are two banks each.
  std::vector<Capacitor> vendor_capacitors(const PlacedCam& cam,
                                           std::span<const std::string>) const override {
    std::vector<Capacitor> out;
    for (const Capacitor& c : cam.capacitors) {
      if (c.name == "CA" || c.name == "CB") {
        const int first = std::min(c.units, kMostUnits);
        out.push_back({c.name + "1", first});
        out.push_back({c.name + "2", c.units - first});
      } else {
        out.push_back(c);
      }
    }
    return out;
  }

  std::optional<ZrnaModule> zrna_module(const PlacedCam& cam) const override {
    const bool band = cam.option == "Band Pass";
    const bool low = cam.option == "Low Pass";
    return ZrnaModule{low    ? "FilterBiquadLowpass"
                      : band ? "FilterBiquadBandpass"
                             : "FilterBiquadHighpass",
                      "",
                      {{"corner_hz", band ? "center_frequency" : "corner_frequency"},
                       {"quality", "quality_factor"},
                       {"gain", "gain"}}};
  }

  std::string picture_text(const PlacedCam& cam) const override {
    return "corner " + engineering_text(cam.realised.required_number("corner_hz"), "Hz", 4);
  }

 protected:
  std::vector<Named> names(const PlacedCam&) const override { return second_order_named(); }
  bool makes(const FilterStage& stage) const override { return !stage.is_first() && stage.is_vendors(); }
  std::string option_of(const FilterStage& stage) const override {
    return stage.c[FilterStage::kC1] > 0.0   ? "Low Pass"
           : stage.c[FilterStage::kCp] > 0.0 ? "Band Pass"
                                             : "High Pass";
  }
  CamValues shown(const FilterStage& stage, Hertz clock) const override {
    return {{"corner_hz", stage.corner(clock).value},
            {"quality", stage.quality()},
            {"gain", stage.gain()},
            {"form", std::string(stage.kind == FilterStage::Kind::second_high ? kHighQ : "low Q")}};
  }
  FilterStage form(const PlacedCam& cam) const override {
    const bool high = cam.realised.text("form") == kHighQ;
    return {high ? FilterStage::Kind::second_high : FilterStage::Kind::second_low, std::vector<double>(8)};
  }
  bool banks() const override { return true; }
};

}  // namespace

BODESMITH_ENTRY(Cam, filter_biquad_cam, FilterBiquad)

}  // namespace bodesmith::fpaa
