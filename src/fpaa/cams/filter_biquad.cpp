#include "fpaa/cams/filter_biquad.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/text.hpp"
#include "base/whole_number.hpp"
#include "fpaa/cams/biquad_stage.hpp"
#include "fpaa/cams/cam.hpp"

namespace bodesmith::fpaa {
namespace {

using BiquadKind = BiquadCapacitors::Kind;

/// The value of "form" among the realised parameters.
constexpr const char* kHighQ = "high Q";
constexpr const char* kLowQ = "low Q";

/// Clock over corner: below, LDI warping and the delay in the loop spoil it; above, its loop capacitors get
/// coarse.
constexpr double kMinClockOverCorner = 8.0;
constexpr double kMaxClockOverCorner = 500.0;

/// How many of the sets nearest in corner and quality are judged by their complex error.
constexpr std::size_t kJudgedSets = 400;
/// No capacitor comes near this; beyond it a wanted value need not be rounded.
constexpr double kFarBeyondUnits = 1e6;

/// H of one input capacitor alone: the stage with all three without the others' powers of D.
DeltaTransfer transfer_of_one_input(const BiquadStageCapacitors& c) {
  DeltaTransfer h = c.transfer();
  while (h.numerator.size() > 1 && h.numerator.back() == 0.0) h.numerator.pop_back();
  return h;
}

/// A set of capacitors and how far its corner, quality and gain are off, in nepers.
struct NearBiquad {
  double off;
  BiquadCapacitors capacitors;
};

/// Keeps the best kJudgedSets, cheaply.
class BiquadShortlist {
 public:
  void add(double off, const BiquadCapacitors& c) {
    if (list_.size() >= 2 * kJudgedSets) cut();
    if (off < limit_) list_.push_back({off, c});
  }
  std::vector<NearBiquad> take() {
    cut();
    return std::move(list_);
  }

 private:
  void cut() {
    std::stable_sort(list_.begin(), list_.end(),
                     [](const NearBiquad& a, const NearBiquad& b) { return a.off < b.off; });
    if (list_.size() > kJudgedSets) {
      list_.resize(kJudgedSets);
      limit_ = list_.back().off;
    }
  }
  std::vector<NearBiquad> list_;
  double limit_ = std::numeric_limits<double>::infinity();
};

/// The input capacitor that gives the wanted gain exactly.
double exact_input(const BiquadTarget& target, const BiquadCapacitors& c) {
  switch (target.kind) {
    case BiquadKind::low_pass:
      return target.gain * c.c2;
    case BiquadKind::band_pass:
      return target.gain * c.c4;
    case BiquadKind::high_pass:
      break;
  }
  return target.gain * c.cb;
}

/// All CA, CB with the C2, C3, C4 and input that come nearest to the target.
void collect_near(const BiquadTarget& target, Hertz clock, int max_capacitor, bool high_q,
                  BiquadShortlist& list) {
  const auto fits = [&](int units) { return units >= 1 && units <= max_capacitor; };
  const double root = 2.0 * std::sin(0.5 * target.natural.value / clock.value);  // w0/fc by LDI
  const int bank = 2 * max_capacitor;
  BiquadCapacitors c;
  c.kind = target.kind;
  c.high_q = high_q;
  for (c.cb = 1; c.cb <= bank; ++c.cb) {
    const int middle = nearest_whole<int>(root * c.cb);
    for (c.c3 = std::max(1, middle - 2); c.c3 <= std::min(max_capacitor, middle + 2); ++c.c3) {
      const double c2_per_ca = root * root * c.cb / c.c3;
      for (c.ca = 1; c.ca <= bank; ++c.ca) {
        c.c2 = nearest_whole<int>(c2_per_ca * c.ca);
        if (!fits(c.c2)) continue;
        const double corner_off = 0.5 * std::abs(std::log(c.c2 / (c2_per_ca * c.ca)));
        const double c4_wanted =
            high_q ? std::sqrt(static_cast<double>(c.ca) * c.cb * c.c2 / c.c3) / target.quality
                   : c.cb * root / target.quality;
        c.c4 = nearest_whole<int>(c4_wanted);
        if (!fits(c.c4)) continue;
        const double input = exact_input(target, c);
        c.input = nearest_whole<int>(std::min(input, kFarBeyondUnits));
        if (!fits(c.input)) continue;
        list.add(corner_off + std::abs(std::log(c.c4 / c4_wanted)) + std::abs(std::log(c.input / input)), c);
      }
    }
  }
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

class BiquadTask : public CamTask {
 public:
  BiquadTask(const Cam& cam, const SecondOrderPiece& piece, const BiquadTarget& target)
      : CamTask(cam, piece.name, piece.section), target_(target) {}

  Resources resources() const override { return {.opamps = 2, .capacitors = 8}; }
  std::complex<double> response(RadPerSecond w) const override { return target_.response(w); }
  std::vector<RadPerSecond> corners() const override { return {target_.natural}; }
  Band possible_clocks(int) const override {
    const double f = target_.natural.hz().value;
    return {{kMinClockOverCorner * f}, {kMaxClockOverCorner * f}};
  }

  std::optional<PlacedCam> settle(const TaskSetting& setting) const override {
    BiquadTarget target = target_;
    target.gain = setting.gain;
    const auto solution = search_biquad(target, setting.clock, setting.grid, setting.max_capacitor);
    if (!solution) return std::nullopt;
    const BiquadCapacitors& c = solution->capacitors;
    PlacedCam out = start(setting, to_string(c.kind));
    out.requested = BiquadSpec{target.natural.hz(), target.quality, target.gain}.values();
    out.realised = BiquadSpec{c.corner(setting.clock), c.quality(), c.gain()}.values();
    out.realised.set("form", std::string(c.high_q ? kHighQ : kLowQ));
    out.capacitors = c.named();
    out.z = c.transfer();
    return out;
  }

 private:
  BiquadTarget target_;
};

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

  /// Complex poles without finite zeros, or with zeros at s = 0 only.
  CamOffer offer_second_order(const SecondOrderPiece& piece) const override {
    if (piece.poles[0].imag() == 0.0) return {};
    for (const auto& zero : piece.zeros) {
      if (zero == 0.0) continue;
      return {.refusal = Refusal{fmt::format(
                  "section {} has complex poles and a zero that is not at s = 0; the FilterBiquad's "
                  "pole-and-zero form is not publicly known, expected real poles (fit with --real), no "
                  "zeros, zeros at 0, or this section made with spice",
                  piece.section + 1)}};
    }
    const double natural = std::abs(piece.poles[0]);
    BiquadTarget target;
    target.natural = {natural};
    target.quality = natural / (-2.0 * piece.poles[0].real());
    target.kind = piece.zeros.empty()       ? BiquadKind::low_pass
                  : piece.zeros.size() == 1 ? BiquadKind::band_pass
                                            : BiquadKind::high_pass;
    double log_gain = 0.0;
    if (target.kind == BiquadKind::low_pass) log_gain = -2.0 * std::log(natural);
    if (target.kind == BiquadKind::band_pass) log_gain = std::log(target.quality / natural);
    return {.task = std::make_shared<BiquadTask>(*this, piece, target), .log_gain = log_gain};
  }

  DeltaTransfer transfer(const PlacedCam& cam, const CapacitorUnits& c) const override {
    return transfer_of_one_input(form_of(cam, c));
  }

  std::vector<NoiseCharge> noise_charges(const PlacedCam& cam) const override {
    return form_of(cam, CapacitorUnits(cam.capacitors)).noise_charges(cam.z.denominator);
  }

  std::vector<DeltaTransfer> inner_nodes(const PlacedCam& cam) const override {
    return {form_of(cam, CapacitorUnits(cam.capacitors)).first_opamp()};
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

std::vector<Capacitor> BiquadCapacitors::named() const {
  const char* const input_name = kind == Kind::low_pass ? "C1" : kind == Kind::band_pass ? "Cp" : "Cpp";
  return {{input_name, input}, {"C2", c2}, {"C3", c3}, {"C4", c4}, {"CA", ca}, {"CB", cb}};
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

std::complex<double> BiquadTarget::response(RadPerSecond w) const {
  const std::complex<double> s(0.0, w.value / natural.value);
  const std::complex<double> below = 1.0 + s / quality + s * s;
  switch (kind) {
    case BiquadCapacitors::Kind::low_pass:
      return gain / below;
    case BiquadCapacitors::Kind::band_pass:
      return gain * s / quality / below;
    case BiquadCapacitors::Kind::high_pass:
      break;
  }
  return gain * s * s / below;
}

std::optional<BiquadSolution> search_biquad(const BiquadTarget& target, Hertz clock,
                                            const std::vector<RadPerSecond>& grid, int max_capacitor) {
  BiquadShortlist list;
  for (const bool high_q : {false, true}) collect_near(target, clock, max_capacitor, high_q, list);
  std::optional<BiquadSolution> best;
  double min_error = std::numeric_limits<double>::infinity();
  for (const NearBiquad& near : list.take()) {
    const ZTransfer h = near.capacitors.transfer();
    if (!h.is_stable()) continue;
    double worst = 0.0;
    for (const RadPerSecond w : grid) {
      worst = std::max(worst, std::abs(-h.response(w, clock) / target.response(w) - 1.0));
      if (worst >= min_error) break;
    }
    if (worst < min_error) {
      min_error = worst;
      best = {near.capacitors, worst};
    }
  }
  return best;
}

const Cam& filter_biquad_cam() {
  static const FilterBiquad cam;
  return cam;
}

}  // namespace bodesmith::fpaa
