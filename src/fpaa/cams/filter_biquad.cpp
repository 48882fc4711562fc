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

using BiquadKind = BiquadCapacitors::Kind;

/// The value of "form" among the realised parameters.
constexpr const char* kHighQ = "high Q";
constexpr const char* kLowQ = "low Q";

/// H of one input capacitor alone: the stage with all three without the others' powers of D.
DeltaTransfer transfer_of_one_input(const BiquadStageCapacitors& c) {
  DeltaTransfer h = c.transfer();
  while (h.numerator.size() > 1 && h.numerator.back() == 0.0) h.numerator.pop_back();
  return h;
}

const char* to_string(BiquadKind kind) {
  switch (kind) {
    case BiquadKind::low_pass:
      return "Low Pass";
    case BiquadKind::band_pass:
      return "Band Pass";
    case BiquadKind::high_pass:
      break;
  }
  return "High Pass";
}

CamFacts filter_biquad_facts() {
  CamFacts f;
  f.name = "FilterBiquad";
  f.options = {"Low Pass", "Band Pass", "High Pass", "Pole and Zero"};
  f.parameters = {{"corner_hz", "Corner Frequency", true}, {"quality", "Quality Factor"}, {"gain", "Gain"}};
  f.resources = Resources{.opamps = 2, .capacitors = 8};
  f.transfer = "see filter_biquad.hpp; Pole and Zero: not publicly known, not made";
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

  /// Op-amp 1 integrates input and output, op-amp 2 what op-amp 1 was a period before (C3). The vendor's band
  /// pass of low quality is in public streams; the other options move the input and C4 as their equations say.
  std::optional<StageSwitches> switches(const PlacedCam& cam) const override {
    const PlateNode in = PlateNode::input();
    const PlateNode first = PlateNode::opamp(1);
    const PlateNode second = PlateNode::opamp(2);
    const auto units = [&](const char* name) { return cam.units_of(name); };
    const bool high_q = is_high_q(cam);
    StageSwitches s;
    s.opamps = {{}, {}};
    s.output = 2;
    const auto add_banks = [&](const char* name, PlateNode from, int opamp) {
      const int one = std::min(units(name), kUnitsOfBank);
      s.capacitors.push_back(static_branch(std::string(name) + "1", one, from, opamp));
      if (units(name) == one) return;
      s.capacitors.push_back(static_branch(std::string(name) + "2", units(name) - one, from, opamp));
    };
    s.capacitors = {switched_branch("C2", units("C2"), second, 1)};
    add_banks("CA", first, 1);
    if (cam.option == to_string(BiquadKind::low_pass)) {
      s.capacitors.push_back(switched_branch("C1", units("C1"), in, 1));
    } else if (cam.option == to_string(BiquadKind::band_pass)) {
      s.capacitors.push_back(high_q ? static_branch("Cp", units("Cp"), in, 1)
                                    : switched_branch("Cp", units("Cp"), in, 2));
    } else {
      s.capacitors.push_back(static_branch("Cpp", units("Cpp"), in, 2));
    }
    s.capacitors.push_back(delayed_branch("C3", units("C3"), first, 2));
    s.capacitors.push_back(high_q ? static_branch("C4", units("C4"), second, 1)
                                  : switched_branch("C4", units("C4"), second, 2));
    add_banks("CB", second, 2);
    return s;
  }

  std::optional<ZrnaModule> zrna_module(const PlacedCam& cam) const override {
    const bool band = cam.option == to_string(BiquadKind::band_pass);
    const bool low = cam.option == to_string(BiquadKind::low_pass);
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

  static bool is_high_q(const PlacedCam& cam) { return cam.realised.text("form") == kHighQ; }
  static BiquadStageCapacitors form_of(const PlacedCam& cam, const CapacitorUnits& c) {
    return BiquadStageCapacitors::from(c, is_high_q(cam), true);
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

ZTransfer BiquadCapacitors::transfer() const {
  BiquadStageCapacitors form{.high_q = high_q,
                             .c2 = static_cast<double>(c2),
                             .c3 = static_cast<double>(c3),
                             .c4 = static_cast<double>(c4),
                             .ca = static_cast<double>(ca),
                             .cb = static_cast<double>(cb)};
  (kind == Kind::low_pass ? form.c1 : kind == Kind::band_pass ? form.cp : form.cpp) = input;
  return transfer_of_one_input(form).in_z();
}

Hertz BiquadCapacitors::corner(Hertz clock) const {
  const double root = std::sqrt(static_cast<double>(c2) * c3 / (static_cast<double>(ca) * cb));
  return {clock.value / std::numbers::pi * std::asin(std::min(1.0, 0.5 * root))};
}

double BiquadCapacitors::quality() const {
  const double root = std::sqrt(static_cast<double>(c2) * c3 / (static_cast<double>(ca) * cb));
  if (high_q) return std::sqrt(static_cast<double>(ca) * cb * c2 / c3) / c4;
  return cb * root / c4;
}

double BiquadCapacitors::gain() const {
  switch (kind) {
    case Kind::low_pass:
      return static_cast<double>(input) / c2;
    case Kind::band_pass:
      return static_cast<double>(input) / c4;
    case Kind::high_pass:
      break;
  }
  return static_cast<double>(input) / cb;
}

BODESMITH_ENTRY(Cam, filter_biquad_cam, FilterBiquad)

}  // namespace bodesmith::fpaa
