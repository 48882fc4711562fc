#include "fpaa/cams/filter_stage.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/whole_number.hpp"

namespace bodesmith::fpaa {
bool FilterStage::is_vendors() const {
  if (is_first()) return inputs() == 1;
  return (c[kC1] > 0.0) + (c[kCp] > 0.0) + (c[kCpp] > 0.0) == 1 && c1_inverting;
}

int FilterStage::capacitor_count() const {
  return static_cast<int>(std::ranges::count_if(c, [](double v) { return v > 0.0; }));
}

Resources FilterStage::resources() const {
  int capacitors = capacitor_count();
  if (!is_first()) capacitors += (std::round(c[kCA]) > kMostUnits) + (std::round(c[kCB]) > kMostUnits);
  return {.opamps = opamps(), .capacitors = capacitors};
}

int FilterStage::input_of(std::size_t capacitor) const {
  if (!is_first()) return capacitor <= kCpp ? 0 : -1;
  return capacitor < 2 * inputs() ? static_cast<int>(capacitor / 2) : -1;
}

bool FilterStage::may_be_left_out(std::size_t capacitor) const {
  const int input = input_of(capacitor);
  if (input < 0) return false;
  for (std::size_t i = 0; i < c.size(); ++i) {
    if (input_of(i) == input && c[i] > c[capacitor]) return true;
  }
  return false;
}

bool FilterStage::is_stable() const {
  if (is_first()) return c[2 * inputs()] > 0.0;
  // q0 + q1 D + q2 D^2 in powers of 1/z.
  const double loop = c[kC2] * c[kC3];
  const double damp = c[kC4] * (kind == Kind::second_low ? c[kCA] : c[kC3]);
  const double q1 = damp - loop;
  const double q2 = c[kCA] * c[kCB] - (kind == Kind::second_low ? 0.0 : damp);
  const double first = loop + q1 + q2;
  return std::abs(q2) < first && std::abs(q1 + 2.0 * q2) < first + q2;
}

double FilterStage::largest_units(std::size_t capacitor) const {
  const bool two = !is_first() && (capacitor == kCA || capacitor == kCB) && capacitor_count() <= 6;
  return two ? 2.0 * kMostUnits : kMostUnits;
}

double FilterStage::switched_units(int opamp) const {
  if (is_first()) {
    double out = 0.0;
    for (std::size_t i = 0; i < c.size(); i += 2) out += c[i];
    return out;
  }
  if (opamp == 1) return c[kC1] + c[kC2];
  return c[kC3] + (kind == Kind::second_low ? c[kC4] + c[kCp] : 0.0);
}

ZTransfer FilterStage::transfer() const {
  ZTransfer out{{}, {}};  // in powers of D = 1 - 1/z
  if (is_first()) {
    const std::size_t n = 2 * inputs();
    for (std::size_t i = 0; i < n; i += 2) out.numerators.push_back({-c[i], -c[i + 1]});
    out.denominator = {c[n], c[n + 1]};
  } else {
    const double loop = c[kC2] * c[kC3];
    const double first = (c1_inverting ? 1.0 : -1.0) * c[kC1] * c[kC3];
    if (kind == Kind::second_high) {
      out.numerators = {{-first, first - c[kCp] * c[kC3], c[kCp] * c[kC3] - c[kCpp] * c[kCA]}};
      out.denominator = {loop, c[kC3] * c[kC4] - loop, c[kCA] * c[kCB] - c[kC3] * c[kC4]};
    } else {
      out.numerators = {{-first, first - c[kCp] * c[kCA], -c[kCpp] * c[kCA]}};
      out.denominator = {loop, c[kCA] * c[kC4] - loop, c[kCA] * c[kCB]};
    }
  }
  // Without the powers of D of inputs that are not there.
  std::vector<double>& above = out.numerators.front();
  while (is_vendors() && above.size() > 1 && above.back() == 0.0) above.pop_back();
  for (std::vector<double>& numerator : out.numerators) numerator = in_one_minus(numerator);
  out.denominator = in_one_minus(out.denominator);
  return out;
}

Hertz FilterStage::corner(Hertz clock) const {
  if (is_first()) return branch_corner(c[2 * inputs()], c[2 * inputs() + 1], clock);
  const double root = std::sqrt(c[kC2] * c[kC3] / (c[kCA] * c[kCB]));
  return {clock.value / std::numbers::pi * std::asin(std::min(1.0, 0.5 * root))};
}

double FilterStage::quality() const {
  return kind == Kind::second_high ? std::sqrt(c[kCA] * c[kCB] * c[kC2] / c[kC3]) / c[kC4]
                                   : c[kCB] * std::sqrt(c[kC2] * c[kC3] / (c[kCA] * c[kCB])) / c[kC4];
}

double FilterStage::gain() const {
  if (is_first()) return c[0] > 0.0 ? c[0] / c[2] : 2.0 * c[1] / (c[2] + 2.0 * c[3]);
  if (c[kC1] > 0.0) return c[kC1] / c[kC2];
  return c[kCp] > 0.0 ? c[kCp] / c[kC4] : c[kCpp] / c[kCB];
}

StageSwitches FilterStage::switches(const std::vector<std::string>& names, bool banks) const {
  const PlateNode in = PlateNode::input();
  const PlateNode out = PlateNode::opamp(opamps());
  StageSwitches s;
  s.opamps.resize(static_cast<std::size_t>(opamps()));
  s.output = opamps();
  const auto add = [&](StageCapacitor one) {
    if (!one.name.empty()) s.capacitors.push_back(std::move(one));
  };
  if (is_first()) {
    const auto add_pair = [&](std::size_t at, PlateNode from) {
      add(static_branch(names[at + 1], c[at + 1], from));
      add(switched_branch(names[at], c[at], from));
    };
    const std::size_t n = 2 * inputs();
    for (std::size_t i = 0; i < n; i += 2) add_pair(i, PlateNode::input(static_cast<int>(i / 2) + 1));
    add_pair(n, out);
    if (inputs() == 1 && names[1].empty() && s.capacitors.size() == 3)
      std::swap(s.capacitors[1], s.capacitors[2]);  // the vendor's low pass
    return s;
  }
  const PlateNode first = PlateNode::opamp(1);
  const bool high = kind == Kind::second_high;
  const auto add_feedback = [&](std::size_t at, PlateNode from, int opamp) {
    const double one = banks ? std::min<double>(c[at], kMostUnits) : c[at];
    add(static_branch(banks ? names[at] + "1" : names[at], one, from, opamp));
    if (c[at] > one) add(static_branch(names[at] + "2", c[at] - one, from, opamp));
  };
  StageCapacitor from_c1 = switched_branch(names[kC1], c[kC1], in, 1);
  if (!c1_inverting) from_c1.far = from_c1.far.mirrored();
  add(switched_branch(names[kC2], c[kC2], out, 1));
  add_feedback(kCA, first, 1);
  add(from_c1);
  add(high ? static_branch(names[kCp], c[kCp], in, 1) : switched_branch(names[kCp], c[kCp], in, 2));
  add(static_branch(names[kCpp], c[kCpp], in, 2));
  add(delayed_branch(names[kC3], c[kC3], first, 2));
  add(high ? static_branch(names[kC4], c[kC4], out, 1) : switched_branch(names[kC4], c[kC4], out, 2));
  add_feedback(kCB, out, 2);
  return s;
}

Hertz branch_corner(double c0, double c1, Hertz clock) {
  return {clock.value / std::numbers::pi * std::atan(c0 / (c0 + 2.0 * c1))};
}

bool FilterCam::place(const FilterStage& stage, PlacedCam& out) const {
  if (!makes(stage)) return false;
  out.cam = this;
  out.option = option_of(stage);
  out.requested = out.realised = shown(stage, out.clock_a);
  out.resources = stage.resources();
  out.z.numerators.resize(stage.inputs());
  out.capacitors.clear();
  for (const Named& one : names(out)) {
    if (stage.c[one.at] > 0.0) out.capacitors.push_back({one.name, nearest_whole<int>(stage.c[one.at])});
  }
  out.find_z();
  return true;
}

FilterStage FilterCam::stage_of(const PlacedCam& cam, const CapacitorUnits& units) const {
  FilterStage out = form(cam);
  for (const Named& one : names(cam)) out.c[one.at] = units[one.name];
  return out;
}

ZTransfer FilterCam::transfer(const PlacedCam& cam, const CapacitorUnits& units) const {
  return stage_of(cam, units).transfer();
}

std::optional<StageSwitches> FilterCam::switches(const PlacedCam& cam, const CapacitorUnits& units) const {
  const FilterStage stage = stage_of(cam, units);
  std::vector<std::string> named(stage.c.size());
  for (Named& one : names(cam)) {
    const bool is_there =
        std::ranges::any_of(cam.capacitors, [&](const Capacitor& c) { return c.name == one.name; });
    if (is_there) named[one.at] = std::move(one.name);
  }
  return stage.switches(named, banks());
}

std::vector<FilterCam::Named> FilterCam::second_order_named() {
  return {{"C1", 0}, {"Cp", 1}, {"Cpp", 2}, {"C2", 3}, {"C3", 4}, {"C4", 5}, {"CA", 6}, {"CB", 7}};
}

}  // namespace bodesmith::fpaa
