#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/text.hpp"
#include "fpaa/clock_choice.hpp"
#include "fpaa/placement.hpp"
#include "fpaa/plan.hpp"
#include "fpaa/split_sections.hpp"

namespace bodesmith::fpaa {
namespace {

constexpr int kStatedPoints = 801;      ///< of the errors that the plan states
constexpr int kInputLimitPoints = 400;  ///< at which the nodes' peaks are looked for
/// Lowest frequency of that search, of the clock.
constexpr double kInputLimitFrom = 1e-4;

/// An error that two more gain stages may halve: above this, and this much worse than with a free gain.
constexpr double kErrorWorthTwoStages = 0.005;
constexpr double kGainCostWorthTwoStages = 1.5;
/// They are taken when they bring the error below this share.
constexpr double kTwoStagesKept = 0.5;

/// Corners lie at least this factor above the lower end of the band.
constexpr double kBandBelowCorners = 10.0;

/// Tasks with places and capacitors.
struct PlanAttempt {
  TaskChain chain;
  std::vector<Place> places;
  ClockChoice choice;
};

Band stated_band(const Sections& sections, const TaskChain& chain, const PlanOptions& options) {
  if (options.band) return *options.band;
  double low = std::numeric_limits<double>::infinity();
  double high = 0.0;
  const auto widen = [&](Hertz f) {
    low = std::min(low, f.value);
    high = std::max(high, f.value);
  };
  for (const CamTaskPtr& task : chain.tasks) {
    for (const RadPerSecond corner : task->corners()) widen(corner.hz());
  }
  low /= kBandBelowCorners;
  if (sections.error) {
    widen(sections.error->band.from);
    widen(sections.error->band.to);
  }
  return {{low}, {high}};
}

Outcome<PlanAttempt> try_chain(TaskChain chain, const PlanOptions& options, Band band, const Board& board) {
  std::vector<Resources> needs;
  for (const CamTaskPtr& task : chain.tasks) needs.push_back(task->resources());
  Outcome<std::vector<Place>> places = place_in_order(needs, board);
  if (const Refusal* refusal = refusal_of(places)) return *refusal;
  Outcome<ClockChoice> choice =
      options.clock ? at_given_clock(chain, *options.clock, band, board) : at_best_clock(chain, band, board);
  if (const Refusal* refusal = refusal_of(choice)) return *refusal;
  return PlanAttempt{std::move(chain), std::get<std::vector<Place>>(std::move(places)),
                     std::get<ClockChoice>(std::move(choice))};
}

/// Coarse branches may leave no freedom for the gain: two more inverting stages keep the sign and give it.
Outcome<PlanAttempt> best_attempt(const TaskChain& filters, const PlanOptions& options, Band band,
                                  const Board& board) {
  Outcome<PlanAttempt> first = try_chain(with_gain_stages(filters, band), options, band, board);
  if (refusal_of(first)) return first;
  const ChainSolution& solution = std::get<PlanAttempt>(first).choice.solution;
  const double error = solution.max_complex_error;
  if (error <= std::max(kErrorWorthTwoStages, kGainCostWorthTwoStages * solution.shape_error)) return first;
  Outcome<PlanAttempt> more = try_chain(with_gain_stages(filters, band, 2), options, band, board);
  if (refusal_of(more)) return first;  // they do not fit on the board
  const bool better = std::get<PlanAttempt>(more).choice.solution.max_complex_error < kTwoStagesKept * error;
  return better ? more : first;
}

ChipPlan start_chip(int number, const LegalClock& clock, const Board& board) {
  ChipPlan out;
  out.chip = number;
  out.master_clock = board.master_clock;
  out.clocks.sys1_divisor = clock.system_divisor;
  out.clocks.sys2_divisor = clock.system_divisor;
  out.clocks.clocks = {{1, clock.divisor}};
  return out;
}

/// The CAMs on their chips, and the wires of one path through all of them.
void place_and_wire(const PlanAttempt& attempt, const Board& board, Plan& plan) {
  std::vector<PlacedCam> cams = realised_cams(attempt.chain, attempt.choice.problem, attempt.choice.solution);
  cams.back().output_hold = true;
  std::string last;
  const auto wire_to = [&](std::string node) {
    if (!last.empty()) plan.wires.push_back({.from = last, .to = node});
    last = std::move(node);
  };
  for (std::size_t c = 0; c < cams.size(); ++c) {
    const Place& place = attempt.places[c];
    if (plan.chips.empty() || plan.chips.back().chip != place.chip) {
      if (!plan.chips.empty()) wire_to(fmt::format("chip{}.out1", plan.chips.back().chip));
      wire_to(fmt::format("chip{}.in1", place.chip));
      plan.chips.push_back(start_chip(place.chip, attempt.choice.clock, board));
    }
    cams[c].cab = place.cab;
    wire_to(fmt::format("chip{}.{}", place.chip, cams[c].name));
    plan.chips.back().cams.push_back(std::move(cams[c]));
  }
  wire_to(fmt::format("chip{}.out1", plan.chips.back().chip));
}

PlanError stated_error(const Plan& plan, const Sections& sections, Band band, bool with_delays) {
  const std::vector<Hertz> grid = log_grid(band, kStatedPoints);
  std::vector<std::complex<double>> got;
  std::vector<std::complex<double>> wanted;
  for (const Hertz f : grid) {
    got.push_back(plan_response(plan, f.rad_s(), with_delays));
    wanted.push_back(sections.response(f.rad_s()));
  }
  const ResponseDifference d = compare_responses(grid, got, wanted);
  return {band, d.max_magnitude_db, d.max_phase_deg, d.max_complex_percent, d.worst};
}

/// A sine of this amplitude drives no node beyond full scale, whatever its frequency below half the clock.
double max_input_v(const Plan& plan, Band band, const Board& board) {
  const auto cams = plan.cams();
  const double clock = cams[0]->clock_a.value;
  const Band all{{std::min(band.from.value, kInputLimitFrom * clock)}, {0.5 * clock}};
  double peak = 1.0;
  for (const Hertz f : log_grid(all, kInputLimitPoints)) {
    std::complex<double> h = 1.0;
    for (const PlacedCam* cam : cams) {
      h *= cam->z.response(f.rad_s(), cam->clock_a);
      peak = std::max(peak, std::abs(h));
    }
  }
  return board.full_scale_v / peak;
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

std::vector<std::string> notes_of(const Plan& plan, Band band, Hertz clock) {
  const double half_period = 1.0 / (2.0 * clock.value);
  const double hold_percent = 100.0 * 2.0 * std::numbers::pi * band.to.value * half_period;
  std::vector<std::string> out{
      fmt::format("The output hold delays everything by half a clock period, {} s: {} % of complex error at "
                  "{} Hz by itself. A higher clock shortens it, coarser capacitors are the price.",
                  rounded_text(half_period), rounded_text(hold_percent, 3), rounded_text(band.to.value))};
  for (const PlacedCam* cam : plan.cams()) add_new(out, cam->cam->note(*cam));
  return out;
}

}  // namespace

Outcome<Plan> make_plan(const Sections& sections, const PlanOptions& options) {
  const Outcome<const Board*> known_board = find_board(options.board);
  if (const Refusal* refusal = refusal_of(known_board)) return *refusal;
  const Board& board = *std::get<const Board*>(known_board);
  const Outcome<TaskChain> split = split_into_tasks(sections);
  if (const Refusal* refusal = refusal_of(split)) return *refusal;
  const TaskChain& filters = std::get<TaskChain>(split);
  if (filters.tasks.empty()) {
    return Refusal{"there are no sections, expected at least one to put on the board"};
  }
  const Band band = stated_band(sections, filters, options);
  if (!(band.from.value > 0.0) || !(band.to > band.from)) {
    return Refusal{
        fmt::format("the band {} to {} Hz is empty, expected 0 < from < to", band.from.value, band.to.value)};
  }
  const Outcome<PlanAttempt> made = best_attempt(filters, options, band, board);
  if (const Refusal* refusal = refusal_of(made)) return *refusal;
  const PlanAttempt& attempt = std::get<PlanAttempt>(made);

  Plan plan;
  plan.board = board.name;
  place_and_wire(attempt, board, plan);
  plan.error = stated_error(plan, sections, band, false);
  plan.error_with_delays = stated_error(plan, sections, band, true);
  plan.max_input_v = max_input_v(plan, band, board);
  plan.assumptions = assumptions_of(plan);
  plan.notes = notes_of(plan, band, attempt.choice.clock.frequency);
  return plan;
}

}  // namespace bodesmith::fpaa
