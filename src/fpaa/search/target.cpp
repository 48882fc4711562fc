#include "fpaa/search/target.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/whole_number.hpp"
#include "fpaa/plan/clock_features.hpp"
#include "fpaa/plan/error_reference.hpp"
#include "fpaa/plan/plan_limits.hpp"

namespace bodesmith::fpaa {
namespace {

constexpr double kBeyondBand = 4.0;
constexpr double kBeyondWeight = 0.1;
constexpr int kBeyondPoints = 8;
/// A zero of the wanted response on the axis: errors near it count against this share of the peak.
constexpr double kSoftZero = 1e-5;

void add_point(DesignTarget& target, const Sections& sections, Hertz f, double weight, double soft) {
  target.grid.push_back(f.rad_s());
  target.wanted.push_back(sections.response(f.rad_s()));
  target.weight.push_back(weight);
  target.reciprocal.push_back(1.0 / std::max(error_reference(sections, f.rad_s()), soft));
}

}  // namespace

DesignTarget design_target(const Sections& sections, Band band, double points, const Board& board) {
  DesignTarget out;
  out.sections = sections;
  out.band = band;
  out.master_hz = board.master_clock.value;
  const double decades = std::log10(band.to.value / band.from.value);
  const auto inside = log_grid(band, whole_number<int>(points * decades, 30, 400));
  double peak = 0.0;
  for (const Hertz f : inside) peak = std::max(peak, std::abs(sections.response(f.rad_s())));
  for (const Hertz f : inside) add_point(out, sections, f, 1.0, kSoftZero * peak);
  for (const Hertz f : about_sharp_roots(sections, band)) add_point(out, sections, f, 1.0, kSoftZero * peak);
  const Band beyond{{1.15 * band.to.value}, {kBeyondBand * band.to.value}};
  for (const Hertz f : log_grid(beyond, kBeyondPoints))
    add_point(out, sections, f, kBeyondWeight, kSoftZero * peak);
  return out;
}

double corner_of(const DesignStage& stage, double master_hz) {
  const double clock = master_hz / static_cast<double>(stage.divisor);
  const auto& c = stage.c;
  if (stage.is_first()) {
    const std::size_t n = 2 * stage.from.size();
    return clock * c[n] / std::max(c[n + 1], 1e-3 * c[n]);
  }
  return clock *
         std::sqrt(c[DesignStage::kC2] * c[DesignStage::kC3] / (c[DesignStage::kCA] * c[DesignStage::kCB]));
}

DesignTarget with_clocks_seen(DesignTarget target, const Design& design, const Sections& sections) {
  constexpr double kWidths[] = {-10.0, -3.0, -1.0, -0.4, 0.4, 1.0, 3.0, 10.0};
  constexpr int kMultiples = 4;
  const double soft = 1.0 / *std::ranges::max_element(target.reciprocal);
  for (const DesignStage& stage : design.stages) {
    const double clock = target.master_hz / static_cast<double>(stage.divisor);
    const double width = corner_of(stage, target.master_hz) / (2.0 * std::numbers::pi);
    if (width > kNarrow * clock) continue;
    for (const Hertz f : near_clocks({{{clock}, -width}}, target.band, kWidths, kMultiples))
      add_point(target, sections, f, 1.0, soft);
  }
  return target;
}

}  // namespace bodesmith::fpaa
