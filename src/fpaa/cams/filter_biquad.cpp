#include "fpaa/cams/filter_biquad.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/text.hpp"
#include "fpaa/cams/biquad_stage.hpp"
#include "fpaa/cams/cam.hpp"

namespace bodesmith::fpaa {
namespace {

/// The value of "form" among the realised parameters.
constexpr const char* kHighQ = "high Q";

/// H of one input capacitor alone: the stage with all three without the others' powers of D.
DeltaTransfer transfer_of_one_input(const BiquadStageCapacitors& c) {
  DeltaTransfer h = c.transfer();
  while (h.numerator.size() > 1 && h.numerator.back() == 0.0) h.numerator.pop_back();
  return h;
}

CamFacts filter_biquad_facts() {
  CamFacts f;
  f.name = "FilterBiquad";
  f.options = {"Low Pass", "Band Pass", "High Pass", "Pole and Zero"};
  f.parameters = {{"corner_hz", "Corner Frequency", true}, {"quality", "Quality Factor"}, {"gain", "Gain"}};
  f.resources = Resources{.opamps = 2, .capacitors = 8};
  f.transfer = "see biquad_stage.hpp; Pole and Zero: not publicly known, not made";
  f.transfer_ground = Ground::assumed;
  f.limits = "CA and CB to 510 units, the others to 255";
  return f;
}

class FilterBiquad : public Cam {
 public:
  FilterBiquad() : Cam(filter_biquad_facts()) {}

  DeltaTransfer transfer(const PlacedCam& cam, const CapacitorUnits& c) const override {
    return transfer_of_one_input(form_of(cam, c));
  }

  /// CA and CB are two banks each.
  std::vector<Capacitor> vendor_capacitors(const PlacedCam& cam,
                                           std::span<const std::string>) const override {
    std::vector<Capacitor> out;
    for (const Capacitor& c : cam.capacitors) {
      if (c.name == "CA" || c.name == "CB") {
        const int first = std::min(c.units, kUnitsOfBank);
        out.push_back({c.name + "1", first});
        out.push_back({c.name + "2", c.units - first});
      } else {
        out.push_back(c);
      }
    }
    return out;
  }

  std::optional<StageSwitches> switches(const PlacedCam& cam) const override {
    return form_of(cam, CapacitorUnits(cam.capacitors)).switches(true);
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
    return "corner " + engineering_text(BiquadSpec::from(cam.realised).corner.value, "Hz", 4);
  }

 private:
  static constexpr int kUnitsOfBank = 255;

  static BiquadStageCapacitors form_of(const PlacedCam& cam, const CapacitorUnits& c) {
    return BiquadStageCapacitors::from(c, cam.realised.text("form") == kHighQ, true);
  }
};

}  // namespace

CamValues BiquadSpec::values() const {
  return {{"corner_hz", corner.value}, {"quality", quality}, {"gain", gain}};
}

BiquadSpec BiquadSpec::from(const CamValues& values) {
  return {{values.required_number("corner_hz")},
          values.number("quality").value_or(1.0),
          values.number("gain").value_or(1.0)};
}

BODESMITH_ENTRY(Cam, filter_biquad_cam, FilterBiquad)

}  // namespace bodesmith::fpaa
