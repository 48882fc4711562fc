#include "fpaa/chain_plan.hpp"

#include <fmt/format.h>

#include <numbers>

#include "base/text.hpp"
#include "fpaa/clock_choice.hpp"
#include "fpaa/placement.hpp"
#include "fpaa/split_sections.hpp"

namespace bodesmith::fpaa {
namespace {

/// An error that two more gain stages may halve: above this, and this much worse than with a free gain.
constexpr double kErrorWorthTwoStages = 0.005;
constexpr double kGainCostWorthTwoStages = 1.5;
/// They are taken when they bring the error below this share.
constexpr double kTwoStagesKept = 0.5;

/// Tasks with places and capacitors.
struct PlanAttempt {
  TaskChain chain;
  std::vector<Place> places;
  ClockChoice choice;
};

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

}  // namespace

Outcome<Plan> chain_plan(const Sections& sections, const PlanOptions& options, Band band,
                         const Board& board) {
  const Outcome<TaskChain> split = split_into_tasks(sections);
  if (const Refusal* refusal = refusal_of(split)) return *refusal;
  const Outcome<PlanAttempt> made = best_attempt(std::get<TaskChain>(split), options, band, board);
  if (const Refusal* refusal = refusal_of(made)) return *refusal;
  const PlanAttempt& attempt = std::get<PlanAttempt>(made);
  Plan plan;
  plan.board = board.name;
  plan.topology = "chain";
  place_and_wire(attempt, board, plan);
  const double half_period = 1.0 / (2.0 * attempt.choice.clock.frequency.value);
  const double hold_percent = 100.0 * 2.0 * std::numbers::pi * band.to.value * half_period;
  plan.notes.push_back(
      fmt::format("The output hold delays everything by half a clock period, {} s: {} % of complex error at "
                  "{} Hz by itself. A higher clock shortens it, coarser capacitors are the price; without "
                  "--clock-hz the holds are inside the design.",
                  rounded_text(half_period), rounded_text(hold_percent, 3), rounded_text(band.to.value)));
  return plan;
}

}  // namespace bodesmith::fpaa
