#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.hpp"
#include "base/text.hpp"
#include "fpaa/cams/filter_bilinear.hpp"
#include "fpaa/cams/gain_inv.hpp"
#include "fpaa/placement.hpp"
#include "fpaa/plan.hpp"
#include "fpaa/plan_problem.hpp"
#include "fpaa/section_search.hpp"

namespace bodesmith::fpaa {
namespace {

constexpr int kGridPoints = 24;         // of the search
constexpr int kStatedPoints = 801;      // of the errors that the plan states
constexpr int kClocksLookedAt = 80;     // of the legal tree, evenly spread in ratio
constexpr int kClocksWithBiquads = 16;  // each of them is a search of its own
constexpr double kErrorWorthTwoStages = 0.005;
constexpr int kClocksSearched = 2;  // the best of them get the full search

Band choose_band(const Sections& sections, const FilterParts& parts, const PlanOptions& options) {
  if (options.band) return *options.band;
  double low = INFINITY;
  double high = 0.0;
  const auto widen = [&](double f) {
    low = std::min(low, f);
    high = std::max(high, f);
  };
  for (const FilterPart& part : parts.parts) {
    if (part.kind == FilterPart::Kind::biquad) {
      widen(part.biquad.natural.hz().value);
      continue;
    }
    widen(part.pole.hz().value);
    if (part.kind == FilterPart::Kind::pole_zero) widen(part.zero.hz().value);
  }
  low /= 10.0;
  if (sections.error) {
    widen(sections.error->band.from.value);
    widen(sections.error->band.to.value);
  }
  return {{low}, {high}};
}

/// The corner that a part cannot have at this clock, in words; empty when it has them all.
std::string missing_corner(const FilterParts& parts, Hertz clock, int largest) {
  const auto check = [&](const FilterPart& part, const char* what, RadPerSecond corner) -> std::string {
    if (is_reachable({Branch::Kind::corner, corner, true, 0}, clock, largest)) return "";
    return fmt::format("the {} of section {} at {} Hz", what, part.section + 1,
                       rounded_text(corner.hz().value));
  };
  for (const FilterPart& part : parts.parts) {
    if (part.kind == FilterPart::Kind::biquad) continue;
    if (auto text = check(part, "pole", part.pole); !text.empty()) return text;
    if (part.kind != FilterPart::Kind::pole_zero) continue;
    if (auto text = check(part, "zero", part.zero); !text.empty()) return text;
  }
  return "";
}

struct Choice {
  LegalClock clock;
  PlanProblem problem;
  ChainSolution solution;
};

Choice search_at(const FilterParts& parts, const std::vector<CamSlot>& slots, const LegalClock& clock,
                 Band band, const Board& board) {
  PlanProblem problem =
      plan_problem(parts, slots, clock.frequency, band, kGridPoints, board.largest_capacitor);
  ChainSolution solution;
  if (problem.made) solution = search_chain(problem.chain, {});
  return {clock, std::move(problem), std::move(solution)};
}

/// Every `n`-th in ratio, at most `most`.
std::vector<LegalClock> thin_out(const std::vector<LegalClock>& all, int most) {
  if (static_cast<int>(all.size()) <= most) return all;
  std::vector<LegalClock> out;
  const double from = std::log(all.front().frequency.value);
  const double to = std::log(all.back().frequency.value);
  size_t at = 0;
  for (int k = 0; k < most; ++k) {
    const double wanted = from + (to - from) * k / (most - 1);
    while (at + 1 < all.size() && std::log(all[at].frequency.value) < wanted - 1e-12) ++at;
    if (out.empty() || out.back().frequency != all[at].frequency) out.push_back(all[at]);
  }
  return out;
}

Choice choose_clock(const FilterParts& parts, const std::vector<CamSlot>& slots, Band band,
                    const Board& board) {
  const Band reach = reachable_clocks(parts, board.largest_capacitor);
  // Twice the band is the least a sampled system can do; gains are small, so (1 + G) fc bounds the top.
  const Hertz least{std::max(reach.from.value, 2.5 * band.to.value)};
  const Hertz most{std::min(reach.to.value, 0.5 * board.settling_product.value)};
  const std::vector<LegalClock> legal = legal_clocks(board, least, most);
  if (legal.empty()) {
    throw DesignError(fmt::format(
        "no clock serves all corners: the lowest needs at most {} Hz, the highest (and twice the band) at "
        "least {} "
        "Hz; expected corners within a ratio of about 400, or the extreme sections made with spice",
        rounded_text(most.value), rounded_text(least.value)));
  }
  SearchEffort quick;
  quick.candidates = 60;
  quick.beam = 20;
  quick.polished = 0;
  struct Scored {
    double error;
    LegalClock clock;
  };
  std::vector<Scored> scored;
  const bool biquads = std::any_of(parts.parts.begin(), parts.parts.end(), [](const FilterPart& part) {
    return part.kind == FilterPart::Kind::biquad;
  });
  for (const LegalClock& clock : thin_out(legal, biquads ? kClocksWithBiquads : kClocksLookedAt)) {
    const PlanProblem problem =
        plan_problem(parts, slots, clock.frequency, band, kGridPoints / 2, board.largest_capacitor);
    if (!problem.made) continue;
    const ChainSolution rough = search_chain(problem.chain, quick);
    if (rough.made) scored.push_back({rough.shape_error, clock});
  }
  std::stable_sort(scored.begin(), scored.end(),
                   [](const Scored& a, const Scored& b) { return a.error < b.error; });
  Choice best;
  for (size_t k = 0; k < scored.size() && k < kClocksSearched; ++k) {
    Choice choice = search_at(parts, slots, scored[k].clock, band, board);
    if (!best.solution.made || choice.solution.max_complex_error < best.solution.max_complex_error) {
      best = std::move(choice);
    }
  }
  return best;
}

LegalClock given_clock(const FilterParts& parts, Hertz wanted, Band band, const Board& board) {
  if (!(wanted.value > 0.0) || !std::isfinite(wanted.value)) {
    throw DesignError(fmt::format("the clock is {} Hz, expected a frequency above 0", wanted.value));
  }
  const auto clock = find_clock(board, wanted);
  if (!clock) {
    throw DesignError(
        fmt::format("a clock of {} Hz is not in the tree of {} ({} Hz divided twice by 1, 2, 4 ... 510), the "
                    "nearest is {} Hz",
                    number_text(wanted.value), board.name, number_text(board.master_clock.value),
                    number_text(nearest_clock(board, wanted).frequency.value)));
  }
  const Band reach = reachable_clocks(parts, board.largest_capacitor);
  if (const std::string corner = missing_corner(parts, clock->frequency, board.largest_capacitor);
      !corner.empty()) {
    throw DesignError(
        fmt::format("{} cannot be reached at a clock of {} Hz with capacitors of 1 to {} units, "
                    "expected a clock between {} and {} Hz",
                    corner, number_text(wanted.value), board.largest_capacitor,
                    rounded_text(reach.from.value), rounded_text(reach.to.value)));
  }
  if (band.to.value >= 0.5 * clock->frequency.value) {
    throw DesignError(fmt::format(
        "a clock of {} Hz cannot serve a band up to {} Hz, expected more than {} Hz",
        number_text(wanted.value), rounded_text(band.to.value), rounded_text(2.0 * band.to.value)));
  }
  return *clock;
}

struct Attempt {
  std::vector<CamSlot> slots;
  std::vector<Place> places;
  Choice choice;
};

Attempt try_slots(const FilterParts& parts, std::vector<CamSlot> slots, const PlanOptions& options, Band band,
                  const Board& board) {
  Attempt out;
  std::vector<Resources> needs;
  for (const CamSlot& slot : slots) {
    const auto kind = slot.is_gain() ? FilterPart::Kind::pole_zero  // GainInv: four capacitors as well
                                     : parts.parts[static_cast<size_t>(slot.part)].kind;
    const bool biquad = kind == FilterPart::Kind::biquad;
    needs.push_back({.opamps = biquad ? 2 : 1,
                     .capacitors = biquad                                ? 8
                                   : kind == FilterPart::Kind::pole_zero ? 4
                                                                         : 3});
  }
  out.places = place_in_order(needs, board);
  out.choice = options.clock
                   ? search_at(parts, slots, given_clock(parts, *options.clock, band, board), band, board)
                   : choose_clock(parts, slots, band, board);
  if (!out.choice.solution.made) throw DesignError("no capacitors reach every corner at this clock");
  out.slots = std::move(slots);
  return out;
}

const char* biquad_option(BiquadCapacitors::Kind kind) {
  switch (kind) {
    case BiquadCapacitors::Kind::low_pass:
      return "Low Pass";
    case BiquadCapacitors::Kind::band_pass:
      return "Band Pass";
    case BiquadCapacitors::Kind::high_pass:
      break;
  }
  return "High Pass";
}

PlacedCam make_biquad(const FilterPart& part, const BiquadCapacitors& c, double wanted_gain, Hertz clock) {
  PlacedCam cam;
  cam.clock_a = clock;
  cam.name = part.name;
  cam.cam = "FilterBiquad";
  cam.option = biquad_option(c.kind);
  cam.section = part.section;
  cam.requested = {
      {"corner_hz", part.biquad.natural.hz().value}, {"quality", part.biquad.quality}, {"gain", wanted_gain}};
  cam.realised = {{"corner_hz", c.corner(clock).value},
                  {"quality", c.quality(clock)},
                  {"gain", c.gain()},
                  {"form", c.high_q ? "high Q" : "low Q"}};
  const char* input = c.kind == BiquadCapacitors::Kind::low_pass    ? "C1"
                      : c.kind == BiquadCapacitors::Kind::band_pass ? "Cp"
                                                                    : "Cpp";
  cam.capacitors = {{input, c.input}, {"C2", c.c2}, {"C3", c.c3}, {"C4", c.c4}, {"CA", c.ca}, {"CB", c.cb}};
  cam.z = c.transfer();
  cam.resources = {.opamps = 2, .capacitors = 8};
  return cam;
}

PlacedCam make_cam(const FilterParts& parts, const CamSlot& slot, size_t number, const Choice& choice) {
  PlacedCam cam;
  const PlanProblem& problem = choice.problem;
  cam.clock_a = problem.chain.clock;
  const double wanted_gain = problem.wanted_gain[number];
  if (problem.biquads[number]) {
    return make_biquad(parts.parts[static_cast<size_t>(slot.part)], problem.biquads[number]->capacitors,
                       wanted_gain, cam.clock_a);
  }
  const auto branch = static_cast<size_t>(problem.first_branch[number]);
  const BranchValue& above = choice.solution.values[branch];
  const BranchValue& below = choice.solution.values[branch + 1];
  if (slot.is_gain()) {
    const GainInvCapacitors c{above.c0, below.c0};
    cam.name = fmt::format("Gain{}", number + 1);
    cam.cam = "GainInv";
    cam.option = "";
    cam.requested = {{"gain", wanted_gain}};
    cam.realised = {{"gain", c.gain()}};
    cam.capacitors = {{"Cin", c.cin}, {"Cout", c.cout}};
    cam.z = c.transfer();
    cam.resources = {.opamps = 1, .capacitors = 4};
    return cam;
  }
  const FilterPart& part = parts.parts[static_cast<size_t>(slot.part)];
  cam.name = part.name;
  cam.cam = "FilterBilinear";
  cam.section = part.section;
  const double pole_hz = part.pole.hz().value;
  if (part.kind == FilterPart::Kind::pole_zero) {
    const PoleZeroCapacitors c{above.c0, above.c1, below.c0, below.c1};
    const double zero_hz = part.zero.hz().value;
    cam.option = "Pole and Zero";
    cam.requested = {{"pole_hz", pole_hz},
                     {"zero_hz", zero_hz},
                     {"dc_gain", wanted_gain},
                     {"high_frequency_gain", wanted_gain * pole_hz / zero_hz}};
    cam.realised = {{"pole_hz", c.pole(cam.clock_a).value},
                    {"zero_hz", c.zero(cam.clock_a).value},
                    {"dc_gain", c.dc_gain()},
                    {"high_frequency_gain", c.high_frequency_gain()}};
    cam.capacitors = {{"Ca", c.ca}, {"Cb", c.cb}, {"Cc", c.cc}, {"Cd", c.cd}};
    const std::vector<RadPerSecond>& grid = problem.chain.grid;
    std::vector<std::complex<double>> q;
    for (const RadPerSecond w : grid) {
      q.push_back(-c.transfer().response(w, cam.clock_a) / c.dc_gain() / part.response(w));
    }
    double gain = 1.0;
    cam.own_error_percent = 100.0 * best_free_gain_error(q, gain);
    cam.least_own_error_percent =
        100.0 *
        best_pole_zero(part.zero, part.pole, cam.clock_a, grid, problem.chain.largest).max_complex_error;
    cam.z = c.transfer();
    cam.resources = {.opamps = 1, .capacitors = 4};
  } else if (part.kind == FilterPart::Kind::low_pass) {
    const LowPassCapacitors c{above.c0, below.c1, below.c0};
    cam.option = "Low Pass";
    cam.requested = {{"corner_hz", pole_hz}, {"gain", wanted_gain}};
    cam.realised = {{"corner_hz", c.corner(cam.clock_a).value}, {"gain", c.gain()}};
    cam.capacitors = {{"Cin", c.cin}, {"Cint", c.cint}, {"Cout", c.cout}};
    cam.z = c.transfer();
    cam.resources = {.opamps = 1, .capacitors = 3};
  } else {
    const HighPassCapacitors c{above.c1, below.c0, below.c1};
    cam.option = "High Pass";
    cam.requested = {{"corner_hz", pole_hz}, {"gain", wanted_gain * part.pole.value}};
    cam.realised = {{"corner_hz", c.corner(cam.clock_a).value}, {"gain", c.gain()}};
    cam.capacitors = {{"Cb", c.cb}, {"Cc", c.cc}, {"Cd", c.cd}};
    cam.z = c.transfer();
    cam.resources = {.opamps = 1, .capacitors = 3};
  }
  return cam;
}

PlanError state_error(const Plan& plan, const Sections& sections, Band band, bool with_delays) {
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
double largest_input(const Plan& plan, Band band, const Board& board) {
  const auto cams = plan.cams();
  const Band all{{std::min(band.from.value, 1e-4 * cams[0]->clock_a.value)}, {0.5 * cams[0]->clock_a.value}};
  double peak = 1.0;
  for (const Hertz f : log_grid(all, 400)) {
    std::complex<double> h = 1.0;
    for (const PlacedCam* cam : cams) {
      h *= cam->z.response(f.rad_s(), cam->clock_a);
      peak = std::max(peak, std::abs(h));
    }
  }
  return board.full_scale_v / peak;
}

void state_assumptions(Plan& plan) {
  plan.assumptions = {
      "FilterBilinear 'Pole and Zero' is taken to be H(z) = -(Ca + Cb(1 - 1/z))/(Cc + Cd(1 - 1/z)) with "
      "capacitors "
      "of 1 to 255 units; the vendor does not publish its topology. AnadigmDesigner2 chooses capacitors "
      "itself: "
      "type the realised parameters and compare what it reports.",
      "All filter CAMs sample and settle in the same phase, so that samples pass from CAM to CAM without "
      "delay; the "
      "output of the last one is held for a clock period (a delay of half a period, and sinc droop).",
      "The master clock of all chips is the same, and crossing from chip to chip adds no sampling delay (it "
      "adds up "
      "to one clock period when the chips' clocks are not aligned).",
      "Gain-bandwidth, slew rate, offset, noise and the unit capacitance of the chip are not publicly known "
      "and are "
      "in none of these figures."};
}

}  // namespace

Plan make_plan(const Sections& sections, const PlanOptions& options) {
  const Board& board = board_by_name(options.board);
  const FilterParts parts = split_into_parts(sections);
  if (parts.parts.empty())
    throw DesignError("there are no sections, expected at least one to put on the board");
  const Band band = choose_band(sections, parts, options);
  if (!(band.from.value > 0.0) || !(band.to > band.from)) {
    throw DesignError(
        fmt::format("the band {} to {} Hz is empty, expected 0 < from < to", band.from.value, band.to.value));
  }
  Attempt attempt = try_slots(parts, slots_for(parts, band), options, band, board);
  const ChainSolution& first = attempt.choice.solution;
  if (first.max_complex_error > std::max(kErrorWorthTwoStages, 1.5 * first.shape_error)) {
    // Coarse branches may leave no freedom for the gain: two inverting stages keep the sign and give it.
    try {
      Attempt more = try_slots(parts, slots_for(parts, band, 2), options, band, board);
      if (more.choice.solution.max_complex_error < 0.5 * attempt.choice.solution.max_complex_error) {
        attempt = std::move(more);
      }
    } catch (const DesignError&) {
      // They do not fit on the board; the first attempt does.
    }
  }
  const std::vector<CamSlot>& slots = attempt.slots;
  const std::vector<Place>& places = attempt.places;
  const Choice& choice = attempt.choice;
  Plan plan;
  plan.board = board.name;
  for (size_t c = 0; c < slots.size(); ++c) {
    const Place& place = places[c];
    if (plan.chips.empty() || plan.chips.back().chip != place.chip) {
      ChipPlan chip;
      chip.chip = place.chip;
      chip.master_clock = board.master_clock;
      chip.clocks.sys1_divisor = choice.clock.system_divisor;
      chip.clocks.sys2_divisor = choice.clock.system_divisor;
      chip.clocks.clocks = {{1, choice.clock.divisor}};
      if (!plan.chips.empty()) plan.signal_path.push_back(fmt::format("chip{}.out1", plan.chips.back().chip));
      plan.signal_path.push_back(fmt::format("chip{}.in1", place.chip));
      plan.chips.push_back(std::move(chip));
    }
    PlacedCam cam = make_cam(parts, slots[c], c, choice);
    cam.cab = place.cab;
    cam.output_hold = c + 1 == slots.size();
    plan.signal_path.push_back(fmt::format("chip{}.{}", place.chip, cam.name));
    plan.chips.back().cams.push_back(std::move(cam));
  }
  plan.signal_path.push_back(fmt::format("chip{}.out1", plan.chips.back().chip));

  plan.error = state_error(plan, sections, band, false);
  plan.error_with_delays = state_error(plan, sections, band, true);
  plan.largest_input_v = largest_input(plan, band, board);
  state_assumptions(plan);
  const double half = 1.0 / (2.0 * choice.clock.frequency.value);
  plan.notes.push_back(
      fmt::format("The output hold delays everything by half a clock period, {} s: {} % of complex error at "
                  "{} Hz by itself. A "
                  "higher clock shortens it, coarser capacitors are the price.",
                  rounded_text(half), rounded_text(100.0 * 2.0 * std::numbers::pi * band.to.value * half, 3),
                  rounded_text(band.to.value)));
  if (std::any_of(parts.parts.begin(), parts.parts.end(),
                  [](const FilterPart& part) { return part.kind == FilterPart::Kind::low_pass; })) {
    plan.notes.push_back(
        "A FilterBilinear low pass has its zero at z = 0: it leads by up to half a clock period at "
        "frequencies near "
        "the clock, which is most of the error here and makes up for part of the output hold.");
  }
  for (const CamSlot& slot : slots) {
    if (!slot.is_gain()) continue;
    plan.notes.push_back(
        "GainInv is there to keep the total sign (every FilterBilinear inverts) or to carry gain.");
    break;
  }
  return plan;
}

}  // namespace bodesmith::fpaa
