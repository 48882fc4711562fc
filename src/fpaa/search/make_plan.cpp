#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/text.hpp"
#include "fpaa/cams/cam.hpp"
#include "fpaa/plan/clock_features.hpp"
#include "fpaa/plan/error_budget.hpp"
#include "fpaa/plan/error_reference.hpp"
#include "fpaa/plan/plan.hpp"
#include "fpaa/plan/plan_limits.hpp"
#include "fpaa/plan/switched_board.hpp"
#include "fpaa/search/search.hpp"

namespace bodesmith::fpaa {
namespace {

/// Frequencies near the multiples of clocks within the band, in widths of the poles that are sampled there.
constexpr double kAroundClocks[] = {-30.0, -10.0, -5.0, -3.0, -2.0, -1.4, -1.0, -0.7, -0.5, -0.3, -0.1,
                                    0.1,   0.3,   0.5,  0.7,  1.0,  1.4,  2.0,  3.0,  5.0,  10.0, 30.0};
constexpr int kStatedMultiples = 100;
/// Where clocks have a long common period a frequency costs milliseconds.
constexpr std::size_t kCostlyPieces = 20000;
constexpr int kCostlyPoints = 101;

PlanError stated_error(const Plan& plan, const SwitchedBoard& board, const Sections& sections, Band band,
                       bool with_delays) {
  const bool costly = board.pieces() > kCostlyPieces;
  std::vector<Hertz> grid = log_grid(band, costly ? kCostlyPoints : kStatedPoints);
  if (with_delays && !costly) {
    for (const auto& near : {near_clocks(clocked_poles(plan), band, kAroundClocks, kStatedMultiples),
                             about_sharp_roots(sections, band)})
      grid.insert(grid.end(), near.begin(), near.end());
    std::ranges::sort(grid, {}, &Hertz::value);
  }
  PlanError out;
  out.band = band;
  for (const Hertz f : grid) {
    const RadPerSecond w = f.rad_s();
    const Complex wanted = sections.response(w);
    const Complex got = with_delays ? board.gain(w) : board.sampled(w);
    const double percent = 100.0 * std::abs(got - wanted) / error_reference(sections, w);
    if (!(percent <= out.max_complex_percent)) {
      out.max_complex_percent = percent;
      out.worst = f;
    }
    // Near a zero on the axis a ratio says nothing.
    if (is_near_zero(sections, w)) continue;
    const Complex ratio = got / wanted;
    out.max_magnitude_db = std::max(out.max_magnitude_db, std::abs(to_decibel(std::abs(ratio))));
    out.max_phase_deg = std::max(out.max_phase_deg, std::abs(to_degrees(std::arg(ratio))));
  }
  return out;
}

void add_new(std::vector<std::string>& lines, std::string line) {
  if (line.empty() || std::ranges::find(lines, line) != lines.end()) return;
  lines.push_back(std::move(line));
}

std::vector<std::string> assumptions_of(const Plan& plan) {
  std::vector<std::string> out;
  for (const PlacedCam* cam : plan.cams()) add_new(out, cam->cam->assumption());
  out.emplace_back(
      "All filter CAMs have their input capacitors at source and virtual ground during the whole of phase 1, as in "
      "public streams: the output follows the input through phase 1 and keeps its value through phase 2.");
  out.emplace_back(
      "The master clock of all chips is the same, and crossing from chip to chip adds no sampling delay (it "
      "adds up to one clock period when the chips' clocks are not aligned).");
  out.emplace_back(
      plan.slow.is_at_once()
          ? "Gain-bandwidth, slew rate, offset, noise and the unit capacitance of the chip are not publicly known and are in "
            "none of these figures."
          : "Slew rate, offset, noise and the unit capacitance of the chip are not publicly known and are in none of these "
            "figures; how late its op-amps and switches follow is an assumption that is.");
  return out;
}

/// Errors below this share of the peak (deep in a stop band) do not count.
constexpr double kHopelessFloor = 1e-2;

bool is_hopeless(const SwitchedBoard& board, const Sections& sections, Band band) {
  const std::vector<Hertz> grid = log_grid(band, 120);
  double peak = 0.0;
  for (const Hertz f : grid) peak = std::max(peak, std::abs(sections.response(f.rad_s())));
  return std::ranges::any_of(grid, [&](Hertz f) {
    const Complex wanted = sections.response(f.rad_s());
    const double size = std::max(error_reference(sections, f.rad_s()), kHopelessFloor * peak);
    return !(std::abs(board.gain(f.rad_s()) - wanted) < kUselessShare * size);
  });
}

/// What a search comes to in words, chips and percent in `form`; empty when that fails too.
std::string tried(const Sections& sections, PlanOptions options, Band band, const Board& board,
                  const std::string& form) {
  options.band = band;
  const auto made = search_design(sections, band, options, board);
  if (refusal_of(made) != nullptr) return "";
  const Plan& plan = std::get<std::vector<FoundPlan>>(made).front().plan;
  const SwitchedBoard switched(plan);
  if (is_hopeless(switched, sections, band)) return "";
  const PlanError error = stated_error(plan, switched, sections, band, true);
  return "; tried: " + fmt::format(fmt::runtime(form), fmt::arg("chips", plan.chips.size()),
                                   fmt::arg("percent", rounded_text(error.max_complex_percent, 3)));
}

/// What would make it fit, each tried: the upper and the lower part of the band without the corners that ask for the most, more
/// chips.
std::string least_change(const Sections& sections, const PlanOptions& options, Band band,
                         const Board& board) {
  const Hertz middle{std::sqrt(band.from.value * band.to.value)};
  const Band parts[] = {{middle, band.to}, {band.from, middle}};
  for (const Band& part : parts) {
    std::string words = tried(sections, options, part, board,
                              fmt::format("from {} to {} Hz it is built, {{percent}} % off",
                                          rounded_text(part.from.value, 4), rounded_text(part.to.value, 4)));
    if (!words.empty()) return words;
  }
  constexpr int kTimes = 4;
  Board more = board;
  more.chips *= kTimes;
  std::string words = tried(sections, options, band, more, "{chips} chips would do, {percent} % off");
  if (!words.empty()) return words;
  return "; tried without success: parts of the band, more chips; expected fewer poles (a lower order) or spice";
}

/// What no capacitors make: a response that a double does not hold, nothing at all, or a gain at which the noise of one capacitor,
/// as large as there are and clocked as fast as can be, by itself fills the output in the band (or hides it).
std::optional<Refusal> not_a_response(const Sections& sections, Band band, const Board& board,
                                      const NoiseModel& noise) {
  double sum = 0.0;  // which keeps what is not a number
  double peak = 0.0;
  for (const Hertz f : log_grid(band, 60)) {
    const double size = std::abs(sections.response(f.rad_s()));
    sum += size;
    peak = std::max(peak, size);
  }
  if (!(sum > 0.0) || !std::isfinite(sum)) {
    return Refusal{fmt::format("the response from {} to {} Hz is {}, expected numbers above 0",
                               rounded_text(band.from.value), rounded_text(band.to.value),
                               sum == 0.0 ? "0" : "not finite")};
  }
  const double least_v =
      noise.unit_noise_v() * std::sqrt(2.0 * band.to.value / board.master_clock.value / kMostUnits);
  const double most = kFullScaleV / least_v;
  if (peak <= most && peak >= 1.0 / most) return std::nullopt;
  return Refusal{fmt::format(
      "the largest gain from {} to {} Hz is {}, beyond what the noise of a capacitor leaves, expected {} to {}",
      rounded_text(band.from.value), rounded_text(band.to.value), rounded_text(peak, 3),
      rounded_text(1.0 / most, 2), rounded_text(most, 2))};
}

/// Every pole is held by an op-amp: what has more poles than the board has op-amps needs no search.
std::optional<Refusal> too_many_poles(const Sections& sections, const Board& board) {
  std::size_t poles = 0;
  for (const Section& section : sections.sections) poles += section.poles.size();
  constexpr std::size_t per_chip = kCabs * kOpAmps;
  const std::size_t opamps = static_cast<std::size_t>(board.chips) * per_chip;
  if (poles <= opamps) return std::nullopt;
  return Refusal{fmt::format(
      "{} poles need at least as many op-amps, which {} chips have, and the board has {} op-amps; expected fewer "
      "poles (a lower order) or spice",
      poles, (poles + per_chip - 1) / per_chip, opamps)};
}

DesignScore score_of(const Plan& plan) {
  const PlanTotal& total = *plan.total;
  DesignScore out;
  out.designed = total.designed_percent / 100.0;
  out.noise = total.noise_percent / 100.0;
  out.p95 = std::sqrt(std::max(0.0, std::pow(total.p95_percent / 100.0, 2) - out.noise * out.noise));
  out.input = total.at_input_v / kFullScaleV;
  out.bound = out.input / std::pow(10.0, total.from_bound_db / 20.0);
  out.image = total.image_percent / 100.0;
  return out;
}

/// Of plans with their figures the one that takes the first place by them, and the curve of TradeOff.
Plan best_of(std::vector<FoundPlan> found) {
  std::vector<TradeOff> curve;
  std::pair<int, double> least{2, std::numeric_limits<double>::infinity()};
  std::size_t best = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const Plan& plan = found[i].plan;
    const DesignScore score = score_of(plan);
    const auto place = score.place(score.missing(), plan.opamps(), found[i].vendor);
    if (place < least) {
      least = place;
      best = i;
    }
    curve.push_back({plan.total->at_input_v, plan.total->designed_percent, plan.total->p95_percent,
                     plan.opamps(), false});
  }
  curve[best].chosen = true;
  std::erase_if(curve, [all = curve](const TradeOff& at) {
    return !at.chosen && std::ranges::any_of(all, [&](const TradeOff& other) {
      return other.at_input_v >= at.at_input_v && other.designed_percent <= at.designed_percent &&
             other.p95_percent < at.p95_percent;
    });
  });
  std::ranges::stable_sort(curve, {}, &TradeOff::at_input_v);
  Plan out = std::move(found[best].plan);
  out.trade_off = std::move(curve);
  return out;
}

/// How far the mismatch of the capacitors that place a complex root puts 95 % of boards off at the least. A root at w of damping z is
/// where 2 sin(w/2fc) = sqrt(C C3/(Cf CA)) (FilterStage; C: C1 of a zero, C2 of a pole, Cf: Cpp or CB), off by 1.96 sigma/z there,
///   sigma = tan(w/2fc)/(w/fc) sqrt(sum of the four capacitors' squares),
/// least with both above alike, both below alike, and one pair full (two banks each, below, where they place a pole).
struct SharpRoot {
  double percent = 0.0;
  bool is_zero = false;
  Hertz at, clock;
};

/// The one that costs most, each at the best of the plan's clocks.
SharpRoot costliest_root(const Plan& plan, const Sections& sections, Band band,
                         const MismatchModel& mismatch) {
  SharpRoot out;
  const auto add = [&](const Complex& root, bool is_zero) {
    const RadPerSecond w{std::abs(root)};
    if (root.imag() <= 0.0 || w.hz() < band.from || w.hz() > band.to) return;
    const double damping = std::max(std::abs(root.real()) / w.value, is_zero ? kLeastZeroDamping : 0.0);
    SharpRoot best{INFINITY, is_zero, w.hz(), {}};
    for (const PlacedCam* cam : plan.cams()) {
      const double angle = w.value / cam->clock_a.value;
      const double ratio = 2.0 * std::sin(0.5 * angle);
      if (!(angle < std::numbers::pi)) continue;
      const double below = std::min((is_zero ? 1.0 : 2.0) * kMostUnits, kMostUnits / ratio);
      const double four = std::numbers::sqrt2 *
                          std::hypot(mismatch.relative_sigma(below), mismatch.relative_sigma(ratio * below));
      const double percent = 100.0 * error_of_95_percent(0.0, std::tan(0.5 * angle) / angle * four / damping);
      if (percent < best.percent) {
        best.percent = percent;
        best.clock = cam->clock_a;
      }
    }
    if (std::isfinite(best.percent) && best.percent > out.percent) out = best;
  };
  for (const Section& section : sections.sections) {
    for (const auto& zero : section.zeros) add(zero, true);
    for (const auto& pole : section.poles) add(pole, false);
  }
  return out;
}

/// What cannot all be had, and which part of it stands in the way; the curve goes where all is.
void state_trade_off(Plan& plan, const SharpRoot& root) {
  const PlanTotal& total = *plan.total;
  const double wanted_v = score_of(plan).wanted_input() * kFullScaleV;
  std::vector<std::string> missed;
  if (total.designed_percent > 100.0 * kWantedDesigned)
    missed.push_back(fmt::format("{} % as designed (wanted {})", rounded_text(total.designed_percent, 2),
                                 100.0 * kWantedDesigned));
  if (total.p95_percent > 100.0 * kWantedP95) {
    const char* most = total.designed_percent > total.mismatch_p95_percent ? "most of it by design"
                       : total.noise_percent > total.mismatch_p95_percent  ? "most of it noise"
                                                                           : "most of it mismatch";
    missed.push_back(fmt::format("{} % for 95 % of boards (wanted {}), {}",
                                 rounded_text(total.p95_percent, 2), 100.0 * kWantedP95, most));
  }
  if (total.at_input_v < wanted_v)
    missed.push_back(fmt::format("an input of {} V (wanted {})", rounded_text(total.at_input_v, 2),
                                 rounded_text(wanted_v, 2)));
  if (missed.empty()) {
    plan.trade_off.clear();
    return;
  }
  plan.notes.push_back(fmt::format(
      "Not all that is wanted was found together: {}. The design is the knee of error against "
      "input, of {} that no other one beats in error by design, error of 95 % of boards and input.",
      join(missed, "; "), plan.trade_off.size()));
  if (root.percent > 100.0 * kWantedP95)
    plan.notes.push_back(fmt::format(
        "The {} at {} alone puts 95 % of boards {} % off: at the least, with the four capacitors that place it as large "
        "as they can be (clock {}). No search takes this back, a trim of the built board does.",
        root.is_zero ? "zero" : "pole", engineering_text(root.at.value, "Hz", 4),
        rounded_text(root.percent, 2), engineering_text(root.clock.value, "Hz", 4)));
}

}  // namespace

void state_figures(Plan& plan, const Sections& sections, Band band, const BoardAssumptions& assumptions) {
  plan.slow = assumptions.slow;
  const SwitchedBoard board(plan);
  plan.error = stated_error(plan, board, sections, band, false);
  plan.error_with_delays = stated_error(plan, board, sections, band, true);
  const Headroom headroom = headroom_of(board, plan, band);
  plan.max_input_v = std::min(headroom.sine_v, headroom.step_v);
  plan.max_step_v = headroom.step_v;
  const ImageLines images = images_of(board, plan, band);
  plan.image = images.largest;
  plan.image_in_band = images.in_band;
  plan.total = plan_total(plan, board, sections, assumptions);
  plan.mismatch = assumptions.mismatch;
  double squares = 0.0;
  for (const ImageLines::Sine& sine : images.sines)
    squares +=
        sine.signal.share * std::pow(sine.rms / error_reference(sections, sine.signal.frequency.rad_s()), 2);
  plan.total->image_percent = 100.0 * std::sqrt(squares);
  plan.assumptions = assumptions_of(plan);
}

Outcome<Plan> make_plan(const Sections& sections, const PlanOptions& options) {
  const Outcome<const Board*> known_board = find_board(options.board);
  if (const Refusal* refusal = refusal_of(known_board)) return *refusal;
  const Board& board = *std::get<const Board*>(known_board);
  if (sections.sections.empty()) {
    return Refusal{"there are no sections, expected at least one to put on the board"};
  }
  const Band band = options.band ? *options.band : judged_band(sections);
  if (!(band.from.value > 0.0) || !(band.to > band.from) || !std::isfinite(band.to.value)) {
    return Refusal{
        fmt::format("the band {} to {} Hz is empty, expected 0 < from < to", band.from.value, band.to.value)};
  }
  if (2.0 * band.from.value >= board.master_clock.value) {
    return Refusal{fmt::format("the band begins at {} Hz, expected one below half the board's clock of {} Hz",
                               rounded_text(band.from.value), rounded_text(board.master_clock.value))};
  }
  if (band.to.value >= board.master_clock.value) {
    return Refusal{fmt::format(
        "the band to judge ends at {} Hz{}, expected one that ends below the board's clock of {} Hz",
        rounded_text(band.to.value), options.band ? "" : " (the sections' highest corner)",
        rounded_text(board.master_clock.value))};
  }
  if (const auto refusal = not_a_response(sections, band, board, options.assumptions.noise)) return *refusal;
  if (const auto refusal = too_many_poles(sections, board)) return *refusal;
  // Who asks for a clock or for the vendor's CAMs alone is told what these come to, whatever it is.
  const bool given = options.clock || options.topology != PlanOptions::Topology::automatic;
  Outcome<std::vector<FoundPlan>> made = search_design(sections, band, options, board);
  if (const Refusal* refusal = refusal_of(made)) {
    if (given) return *refusal;
    return Refusal{refusal->reason + least_change(sections, options, band, board)};
  }
  auto& found = std::get<std::vector<FoundPlan>>(made);
  state_figures(found.front().plan, sections, band, options.assumptions);
  // The others where the first one lacks something that is wanted.
  if (!(score_of(found.front().plan).missing() > 0.0)) found.resize(1);
  for (std::size_t i = 1; i < found.size(); ++i)
    state_figures(found[i].plan, sections, band, options.assumptions);
  Plan plan = best_of(std::move(found));
  const SwitchedBoard switched(plan);
  const std::string unsettled = unsettled_text(plan);
  if (!given && is_hopeless(switched, sections, band)) {
    // No band and no number of chips mends that.
    if (!unsettled.empty()) return Refusal{"the best board does not settle. " + unsettled};
    const PlanError& error = plan.error_with_delays;
    return Refusal{fmt::format("the best board is {} % off at {} Hz as it runs ({}, {} op-amps){}",
                               rounded_text(error.max_complex_percent, 3), rounded_text(error.worst.value, 3),
                               plan.topology, plan.opamps(), least_change(sections, options, band, board))};
  }
  add_new(plan.notes, unsettled);
  state_trade_off(plan, costliest_root(plan, sections, band, options.assumptions.mismatch));
  return plan;
}

}  // namespace bodesmith::fpaa
