#include "fpaa/search/cam_of_stage.hpp"

#include <fmt/format.h>

#include <cmath>

#include "base/whole_number.hpp"
#include "fpaa/cams/biquad_stage.hpp"
#include "fpaa/cams/cam.hpp"
#include "fpaa/cams/filter_bilinear.hpp"
#include "fpaa/cams/filter_biquad.hpp"
#include "fpaa/cams/sum_inv.hpp"

namespace bodesmith::fpaa {
namespace {

using Stage = DesignStage;

int whole(double units) {
  return nearest_whole<int>(units);
}

void fill_sum(const Stage& stage, PlacedCam& out) {
  const std::size_t n = stage.from.size();
  SumInvCapacitors c;
  c.cout = whole(stage.c[2 * n]);
  c.acout = whole(stage.c[2 * n + 1]);
  for (std::size_t i = 0; i < n; ++i) {
    c.inputs.push_back({whole(stage.c[2 * i]), whole(stage.c[2 * i + 1])});
    out.realised.set(fmt::format("gain_{}", i + 1), stage.c[2 * i] / stage.c[2 * n]);
  }
  out.cam = &cam_registry().get("SumInv");
  out.option = fmt::format("{} inputs", n);
  out.capacitors = c.named();
}

/// One input: what the FilterBilinear calls it depends on which capacitors are there.
void fill_first(const Stage& stage, Hertz clock, PlacedCam& out) {
  const int cin = whole(stage.c[0]);
  const int acin = whole(stage.c[1]);
  const int cout = whole(stage.c[2]);
  const int acout = whole(stage.c[3]);
  out.cam = &cam_registry().get("FilterBilinear");
  if (acin == 0) {
    const LowPassCapacitors c{cin, acout, cout};
    out.option = "Low Pass";
    out.realised = CornerSpec{c.corner(clock), c.gain()}.values();
    out.capacitors = {{"Cin", cin}, {"Cint", acout}, {"Cout", cout}};
  } else if (cin == 0) {
    const HighPassCapacitors c{acin, cout, acout};
    out.option = "High Pass";
    out.realised = CornerSpec{c.corner(clock), c.gain()}.values();
    out.capacitors = {{"Cb", acin}, {"Cc", cout}, {"Cd", acout}};
  } else {
    const PoleZeroCapacitors c{cin, acin, cout, acout};
    out.option = "Pole and Zero";
    out.realised = c.realised(clock).values();
    out.capacitors = {{"Ca", cin}, {"Cb", acin}, {"Cc", cout}, {"Cd", acout}};
  }
}

void fill_second(const Stage& stage, Hertz clock, PlacedCam& out) {
  const bool high_q = stage.kind == Stage::Kind::second_high;
  const auto& c = stage.c;
  static constexpr const char* kNames[] = {"C1", "Cp", "Cpp", "C2", "C3", "C4", "CA", "CB"};
  for (std::size_t i = 0; i < c.size(); ++i) {
    if (c[i] > 0.0) out.capacitors.push_back({kNames[i], whole(c[i])});
  }
  const auto form = BiquadStageCapacitors::from(CapacitorUnits(out.capacitors), high_q, stage.c1_inverting);
  if (stage.is_vendors()) {
    out.cam = &cam_registry().get("FilterBiquad");
    out.option = c[Stage::kC1] > 0.0 ? "Low Pass" : c[Stage::kCp] > 0.0 ? "Band Pass" : "High Pass";
    out.realised = BiquadSpec{form.corner(clock), form.quality(), form.gain()}.values();
    out.realised.set("form", std::string(high_q ? "high Q" : "low Q"));
    return;
  }
  out.cam = &biquad_stage_cam();
  out.option = biquad_stage_option(high_q, stage.c1_inverting);
  out.realised = {{"natural_hz", form.corner(clock).value}, {"quality", form.quality()}};
}

}  // namespace

PlacedCam cam_of_stage(const DesignStage& stage, const Board& board) {
  PlacedCam out;
  out.name = stage.name;
  out.clock_a = {board.master_clock.value / static_cast<double>(stage.divisor)};
  if (!stage.is_first()) {
    fill_second(stage, out.clock_a, out);
  } else if (stage.from.size() == 1) {
    fill_first(stage, out.clock_a, out);
  } else {
    fill_sum(stage, out);
  }
  out.more_numerators.resize(stage.from.size() - 1);
  out.requested = out.realised;
  out.resources = resources_of_stage(stage);
  const std::vector<DeltaTransfer> transfers = out.cam->transfers(out, CapacitorUnits(out.capacitors));
  out.z = transfers[0].in_z();
  for (std::size_t i = 1; i < transfers.size(); ++i)
    out.more_numerators[i - 1] = transfers[i].in_z().numerator;
  return out;
}

Resources resources_of_stage(const DesignStage& stage) {
  int capacitors = stage.capacitor_count();
  // CA or CB beyond one bank takes the second.
  if (!stage.is_first()) {
    for (const int i : {Stage::kCA, Stage::kCB}) {
      if (whole(stage.c[static_cast<std::size_t>(i)]) > 255) ++capacitors;
    }
  }
  return {.opamps = stage.opamps(), .capacitors = capacitors};
}

}  // namespace bodesmith::fpaa
