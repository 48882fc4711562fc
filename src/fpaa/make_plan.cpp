#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/text.hpp"
#include "fpaa/cams/cam.hpp"
#include "fpaa/chain_plan.hpp"
#include "fpaa/multirate_response.hpp"
#include "fpaa/plan.hpp"
#include "fpaa/plan_limits.hpp"
#include "fpaa/topology_search.hpp"

namespace bodesmith::fpaa {
namespace {

constexpr int kStatedPoints = 801;  ///< of the errors that the plan states
/// Of the peak: what counts as a zero of the response.
constexpr double kZeroOfPeak = 1e-6;
/// A corner up here is no concern of a board's whose band was stated lower (RIAA's zero at 20 MHz).
constexpr double kHighestCornerHz = 1e5;

/// The corners, and the band that the sections state.
Band stated_band(const Sections& sections, const PlanOptions& options) {
  if (options.band) return *options.band;
  const Band corners = sections.corner_band();
  double low = corners.from.value;
  double high = corners.to.value;
  if (sections.error && sections.error->band.from.value > 0.0) {
    low = low > 0.0 ? std::min(low, sections.error->band.from.value) : sections.error->band.from.value;
    if (high > kHighestCornerHz) high = std::max(sections.error->band.to.value, kHighestCornerHz);
    high = std::max(high, sections.error->band.to.value);
  }
  // One corner is no band.
  if (high < 2.0 * low) return {{low / 10.0}, {high * 2.0}};
  return {{low}, {high}};
}

PlanError stated_error(const Plan& plan, const Sections& sections, Band band, bool with_delays) {
  const std::vector<Hertz> grid = log_grid(band, kStatedPoints);
  std::vector<std::complex<double>> got;
  std::vector<std::complex<double>> wanted;
  const MultirateResponse response(plan);
  double peak = 0.0;
  for (const Hertz f : grid) peak = std::max(peak, std::abs(sections.response(f.rad_s())));
  std::vector<Hertz> stated;
  for (const Hertz f : grid) {
    const RadPerSecond w = f.rad_s();
    // Just at a zero there is nothing that an error could be relative to.
    if (std::abs(sections.response(w)) < kZeroOfPeak * peak) continue;
    stated.push_back(f);
    got.push_back(with_delays ? response.as_it_runs(w) : response.without_delays(w));
    wanted.push_back(sections.response(f.rad_s()));
  }
  const ResponseDifference d = compare_responses(stated, got, wanted);
  return {band, d.max_magnitude_db, d.max_phase_deg, d.max_complex_percent, d.worst};
}

void add_new(std::vector<std::string>& lines, std::string line) {
  if (line.empty() || std::find(lines.begin(), lines.end(), line) != lines.end()) return;
  lines.push_back(std::move(line));
}

std::vector<std::string> assumptions_of(const Plan& plan) {
  std::vector<std::string> out;
  for (const PlacedCam* cam : plan.cams()) add_new(out, cam->cam->assumption());
  out.emplace_back(
      "All filter CAMs sample and settle in the same phase, so that samples pass from CAM to CAM without "
      "delay; the output of the last one is held for a clock period (a delay of half a period, and sinc "
      "droop).");
  out.emplace_back(
      "The master clock of all chips is the same, and crossing from chip to chip adds no sampling delay (it "
      "adds up to one clock period when the chips' clocks are not aligned).");
  out.emplace_back(
      "Gain-bandwidth, slew rate, offset, noise and the unit capacitance of the chip are not publicly known "
      "and are in none of these figures.");
  return out;
}

/// What a board does to a response that hardly deserves the name; errors below this share of the peak (deep in
/// a notch) do not count.
constexpr double kHopeless = 0.6;
constexpr double kHopelessFloor = 1e-2;

bool is_hopeless(const Plan& plan, const Sections& sections, Band band) {
  const MultirateResponse response(plan);
  const std::vector<Hertz> grid = log_grid(band, 120);
  double peak = 0.0;
  for (const Hertz f : grid) peak = std::max(peak, std::abs(sections.response(f.rad_s())));
  return std::any_of(grid.begin(), grid.end(), [&](Hertz f) {
    const std::complex<double> wanted = sections.response(f.rad_s());
    const double size = std::max(std::abs(wanted), kHopelessFloor * peak);
    return !(std::abs(response.as_it_runs(f.rad_s()) - wanted) < kHopeless * size);
  });
}

/// The part of the band that comes out within 5 %, in words; empty: none.
std::string usable_band(const Plan& plan, const Sections& sections, Band band) {
  constexpr double kUsable = 0.05;
  const MultirateResponse response(plan);
  double from = 0.0, best_from = 0.0, best_to = 0.0;
  bool open = false;
  for (const Hertz f : log_grid(band, 200)) {
    const RadPerSecond w = f.rad_s();
    const bool good = std::abs(response.as_it_runs(w) / sections.response(w) - 1.0) < kUsable;
    if (good && !open) from = f.value;
    if (good && (best_from == 0.0 || f.value / from > best_to / best_from))
      best_from = from, best_to = f.value;
    open = good;
  }
  if (!(best_to > best_from)) return "";
  return fmt::format("--from-hz {} --to-hz {}", rounded_text(best_from, 3), rounded_text(best_to, 3));
}

Outcome<Plan> searched_plan(const Sections& sections, const PlanOptions& options, Band band,
                            const Board& board) {
  Outcome<SearchedNetwork> searched = search_topology(sections, band, options, board);
  if (const Refusal* refusal = refusal_of(searched)) return *refusal;
  SearchedNetwork& found = std::get<SearchedNetwork>(searched);
  found.plan.topology = found.topology;
  return std::move(found.plan);
}

}  // namespace

Outcome<Plan> make_plan(const Sections& sections, const PlanOptions& options) {
  const Outcome<const Board*> known_board = find_board(options.board);
  if (const Refusal* refusal = refusal_of(known_board)) return *refusal;
  const Board& board = *std::get<const Board*>(known_board);
  if (sections.sections.empty()) {
    return Refusal{"there are no sections, expected at least one to put on the board"};
  }
  const Band band = stated_band(sections, options);
  if (!(band.from.value > 0.0) || !(band.to > band.from) || !std::isfinite(band.to.value)) {
    return Refusal{
        fmt::format("the band {} to {} Hz is empty, expected 0 < from < to", band.from.value, band.to.value)};
  }
  const bool chain = options.clock || options.topology == PlanOptions::Topology::chain;
  Outcome<Plan> made =
      chain ? chain_plan(sections, options, band, board) : searched_plan(sections, options, band, board);
  if (refusal_of(made) != nullptr) return made;
  Plan& plan = std::get<Plan>(made);
  plan.error = stated_error(plan, sections, band, false);
  plan.error_with_delays = stated_error(plan, sections, band, true);
  if (!chain && is_hopeless(plan, sections, band)) {
    const std::string usable = usable_band(plan, sections, band);
    return Refusal{
        fmt::format("the best board is {} % off at {} Hz as it runs; expected a band that it can do{}",
                    rounded_text(plan.error_with_delays.max_complex_percent, 3),
                    rounded_text(plan.error_with_delays.worst.value, 3),
                    usable.empty() ? ", or fewer poles (a lower --order)" : " (" + usable + ")")};
  }
  const Headroom headroom = headroom_of(plan, band, board);
  plan.max_input_v = std::min(headroom.sine_v, headroom.step_v);
  plan.max_step_v = headroom.step_v;
  plan.image = largest_image(plan, band);
  plan.assumptions = assumptions_of(plan);
  for (const PlacedCam* cam : plan.cams()) add_new(plan.notes, cam->cam->note(*cam));
  return made;
}

}  // namespace bodesmith::fpaa
