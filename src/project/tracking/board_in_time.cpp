#include "project/tracking/board_in_time.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <set>

#include "base/error.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "base/whole_number.hpp"
#include "fpaa/controller/netlist.hpp"
#include "fpaa/plan/board_run.hpp"
#include "fpaa/plan/plan_graph.hpp"
#include "fpaa/sheets/board_netlist.hpp"
#include "numeric/parallel_for.hpp"
#include "project/tracking/board_controller.hpp"
#include "project/tracking/tracked_plant.hpp"
#include "schematic/ngspice/ngspice.hpp"
#include "signal/statistics.hpp"
#include "synthesis/controller/as_built.hpp"

namespace bodesmith::project {
namespace {

/// What ngspice may take, over all frequencies, and what a period of a clock takes it for each op-amp of the board.
constexpr double kMostSeconds = 8.0, kSecondsAPeriod = 4e-4;
constexpr double kTimeConstants = 8.0;  ///< of the slowest pole before the window: 3e-4 of its start is left
/// The clock and the reference meet nowhere: so many periods of the slowest clock are most of what they can do together.
constexpr double kLeastClocks = 25.0;
constexpr double kSamplesAClock = 8.0;
constexpr double kSamplesAPeriod = 8192.0;  ///< of the reference, as the closed form has them
/// Whatever the steps inside an edge of a clock are, charge is kept: by Euler's backward rule, and as long as the sources' corners let
/// them be (trtol), drives are within 2e-6 of the stroke of those by a tenth of the steps and Gear's second order.
constexpr const char* kSteps = ".options maxord=1 trtol=10000 bypass=1\n";
constexpr double kOfLargestInput = 0.5;  ///< of the board: a drive may go beyond the stroke

/// Op-amps and switches as such chips may have them: as late as a drive can be told of, and no quicker for ngspice.
fpaa::NetlistParts parts_in_time() {
  const fpaa::SlowParts typical = fpaa::SlowParts::typical();
  fpaa::NetlistParts out;
  out.opamp = typical.opamp;
  out.switch_on_ohm = typical.switch_s / out.unit_capacitance_f;
  return out;
}

/// The netlist with its contacts as ngspice's own elements, which take half the time of the form that other simulators read
/// as well; the drive stays within 1e-6 of the stroke (rms).
std::string with_own_contacts(std::string netlist) {
  const fpaa::NetlistParts parts = parts_in_time();
  const std::size_t from = netlist.find("Gs a o VALUE=");
  if (from == std::string::npos) return netlist;  // no CAMs
  return netlist.replace(from, netlist.find('\n', from) - from,
                         fmt::format(".model contact sw(ron={:.15g} roff={:.15g} vt=0.5)\nSs a o e 0 contact",
                                     parts.switch_on_ohm, parts.switch_off_ohm));
}

/// A fast clock's phases as expressions of time, which turn in the first step behind an edge, all at once: behind every corner of
/// a source steps grow anew from a share of the time to the next, and a pulse has two at each end of a phase. Here a source has
/// corners where a pulse would end (before the next begins, so that what turns at the edge is read as it was) and so much behind that
/// as an op-amp settles in: the drive stays within 4e-6 of the stroke (rms), in .45 of the time.
std::string with_phases_of_time(const std::string& netlist) {
  const fpaa::NetlistParts parts = parts_in_time();
  const double early = 0.6 * parts.gap;
  std::string out;
  for (const std::string_view line : split(netlist, '\n')) {
    const auto words = split(line, ' ');  // name node 0 PULSE(0 1 delay edge edge width period)
    double delay = 0.0, period = 0.0;
    if (words.size() == 10 && words[3] == "PULSE(0" && parse_number(words[5], delay) &&
        parse_number(words[9].substr(0, words[9].size() - 1), period)) {
      const double settling = std::min(1.0 / parts.opamp.gain_bandwidth.value, 0.1 * period);
      out += fmt::format("B{0} {0} 0 V=u(sin({1:.17g}*((time-{2:.17g})/{3:.17g}-1e-6)))\n", words[1],
                         2.0 * std::numbers::pi, delay - early * period, period);
      if (delay == 0.0)
        out += fmt::format("V{0} {0}corners 0 PULSE(0 1 {1:.17g} {2:.17g} {2:.17g} {3:.17g} {4:.17g})\n",
                           words[1], (0.5 - early) * period, settling, 0.5 * period - settling, period);
    } else {
      out.append(line).push_back('\n');
    }
  }
  return out;
}

/// One frequency's window: whole repeats of the reference, `count` samples, after `skipped` ones.
struct Window {
  tracking::Reference reference;
  Hertz operating;
  double repeat_s = 0.0, step_s = 0.0;
  std::size_t count = 0, skipped = 0, a_repeat = 0;

  double end_s() const { return static_cast<double>(skipped + count + 1) * step_s; }
};

class BoardTracker {
 public:
  BoardTracker(const Project& project, const Design& design, tracking::GeneratorForm form)
      : project_(project),
        form_(form),
        graph_(value_or_throw(fpaa::plan_graph(*design.plan))),
        board_(fpaa::board_by_name(design.plan->board)),
        netlist_(with_own_contacts(fpaa::board_netlist(*design.plan, parts_in_time(), "board"))),
        generator_(tracking_plant(project).generated().at(project.track.amplitude())) {
    double decay = INFINITY;
    for (const Section& section : design.sections().sections) {
      for (const Complex& pole : section.poles) decay = std::min(decay, -pole.real());
    }
    settled_s_ = kTimeConstants / decay;
    double largest = 1e-3;
    for (int i = 0; i <= 100; ++i)
      largest = std::max(
          largest, std::abs(generator_.value(project.target.branch, 0.01 * i * project.track.amplitude())));
    volts_ = kOfLargestInput * design.plan->max_input_v / largest;
    const std::set<double> clocks = design.plan->clocks_hz();
    slowest_hz_ = *clocks.begin();
    fastest_hz_ = *clocks.rbegin();
    for (const double hz : clocks) cost_ += kSecondsAPeriod * hz * design.plan->opamps();
  }

  Window window(Hertz operating) const {
    Window out{tracking::Reference(project_.track.waveform(), project_.track.amplitude()), operating};
    out.repeat_s = static_cast<double>(out.reference.periods()) / operating.value;
    const double repeats = std::ceil(kLeastClocks / (slowest_hz_ * out.repeat_s));
    const double samples = std::max(kSamplesAPeriod * static_cast<double>(out.reference.periods()),
                                    kSamplesAClock * fastest_hz_ * out.repeat_s);
    out.a_repeat = 1024 * whole_number<std::size_t>(std::ceil(samples / 1024.0), 1, 1024);
    out.step_s = out.repeat_s / static_cast<double>(out.a_repeat);
    out.count = out.a_repeat * whole_number<std::size_t>(repeats, 1, 1024);
    out.skipped = whole_number<std::size_t>(std::ceil(settled_s_ / out.step_s), 0, std::size_t{1} << 40);
    return out;
  }
  /// Seconds of ngspice, about.
  double cost_s(const Window& window) const { return window.end_s() * cost_; }
  BoardInTime track(const Window& window) const;

 private:
  ngspice::Transient run_in_ngspice(const Window& window) const;
  fpaa::BoardRun made(const ngspice::Transient& run) const;
  std::string polynomial(Disturbance::Branch branch) const {
    const std::array<double, 3>& a = generator_.coefficients(branch);
    return fmt::format("V({0})*({1:.15g}+V({0})*({2:.15g}+V({0})*{3:.15g}))", form_.is_self_fed() ? "v" : "r",
                       a[0], a[1], a[2]);
  }

  const Project& project_;
  tracking::GeneratorForm form_;
  fpaa::PlanGraph graph_;
  const fpaa::Board& board_;
  std::string netlist_;
  Disturbance generator_;
  double volts_ = 1.0;  ///< at the board for a disturbance of the whole stroke
  double settled_s_ = 0.0, fastest_hz_ = 0.0, slowest_hz_ = 0.0, cost_ = 0.0;
};

/// The reference r, an ideal generator, its switch, and the board before that switch (tracking::Options::Place).
ngspice::Transient BoardTracker::run_in_ngspice(const Window& window) const {
  const double repeats = std::ceil(window.end_s() / window.repeat_s);
  const Disturbance::Branch branch = project_.target.branch;
  const bool up = branch == Disturbance::Branch::ascending;
  const std::string deck = fmt::format(
      "board\n{}{}{}{}Bw w 0 V={:.15g}*{}\nXb w c board\nRc c 0 1e9\nBv v 0 V=V(r)-{}*V(c)/{:.15g}-{}*{}\n{}\n",
      kSteps, netlist_, generator::reference_sources(window.reference, window.operating, 0.0, repeats),
      generator::rising_source(window.reference, window.operating, 0.0, repeats), volts_, polynomial(branch),
      up ? "V(rising)" : "(1-V(rising))", volts_, up ? "(1-V(rising))" : "V(rising)",
      polynomial(up ? Disturbance::Branch::descending : Disturbance::Branch::ascending),
      fpaa::board_deck_options());
  return ngspice::run_transient(deck, {"v", "w", "c"},
                                std::min(1.0 / (kSamplesAClock * fastest_hz_), window.repeat_s / 200.0),
                                window.end_s(), "board.sub");
}

/// By charge conservation, reading what ngspice's board read.
fpaa::BoardRun BoardTracker::made(const ngspice::Transient& run) const {
  std::vector<fpaa::WiredCam> cams;
  for (const auto& node : graph_.nodes) {
    fpaa::WiredCam cam{*node.cam, node.chip, {}};
    cam.name = node.name;
    cam.inputs.assign(cam.input_count(), "nothing");
    for (const auto& input : node.inputs)
      cam.inputs[input.number - 1] = input.from.node ? graph_.nodes[*input.from.node].name : "w";
    cams.push_back(std::move(cam));
  }
  const auto read = [&run, i = std::size_t{1}](double t, std::span<const double>) mutable {
    return run.at(1, t, i);
  };
  return {
      cams, {{"w", {}, read}, {"nothing", {}, [](double, std::span<const double>) { return 0.0; }}}, board_};
}

/// By what the stage makes of ngspice's drive, sampled half a step after the repeat begins and every step from there on.
BoardInTime judged(const Project& project, const tracking::Reference& reference, Hertz operating,
                   const tracking::DriveWaveform& drive, const std::vector<double>& by_charges,
                   std::size_t a_repeat) {
  std::vector<double> wanted;
  for (std::size_t n = 0; n < a_repeat; ++n)
    wanted.push_back(reference.value((static_cast<double>(n) + 0.5) / static_cast<double>(a_repeat)));
  const tracking::PolynomialStage stage = own_stage(project);
  BoardInTime out{.frequency = operating, .followed_s = drive.step_s * static_cast<double>(drive.v.size())};
  out.rms_percent =
      tracking::tracking_error(stage.response(drive.v, drive.step_s, operating, tracking::DriveKind::stepped),
                               wanted, static_cast<double>(a_repeat) * drive.step_s)
          .rms_percent_without_lag;
  out.difference_percent = 100.0 * error_figures(by_charges, drive.v).rms / reference.alpha();
  return out;
}

BoardInTime BoardTracker::track(const Window& window) const {
  const ngspice::Transient run = run_in_ngspice(window);
  fpaa::BoardRun board = made(run);
  tracking::DriveWaveform drive{std::vector<double>(window.count), window.step_s};
  std::vector<double> by_charges(window.count);
  std::size_t i = 1;
  for (std::size_t k = window.skipped; k < window.skipped + window.count; ++k) {
    const double t = (static_cast<double>(k) + 0.5) * window.step_s;  // off turns, where the drive jumps
    board.advance_to(t);
    const double theta = t / window.repeat_s;
    const bool rises = tracking::Reference::rises(window.reference.piece(theta - std::floor(theta)));
    const double made =
        graph_.output.node ? board.value(graph_.nodes[*graph_.output.node].name) : run.at(1, t, i);
    const std::size_t place = k % window.count;
    drive.v[place] = run.at(0, t, i);
    by_charges[place] = drive.v[place];
    if (branch_of(rises) == project_.target.branch) by_charges[place] += (run.at(2, t, i) - made) / volts_;
  }
  return judged(project_, window.reference, window.operating, drive, by_charges, window.a_repeat);
}

/// Frequencies from the highest down as long as there is time, several at once.
void follow(BoardsInTime& out, std::vector<Hertz> frequencies, const std::function<double(Hertz)>& cost_s,
            const std::function<BoardInTime(Hertz)>& track) {
  if (!ngspice::is_available()) {
    out.missing = "ngspice is not installed";
    return;
  }
  std::sort(frequencies.rbegin(), frequencies.rend());
  double cost = 0.0;
  const auto first_left = std::ranges::find_if(frequencies, [&](Hertz f) {
    cost += cost_s(f);
    return cost > kMostSeconds;
  });
  const auto count = static_cast<std::size_t>(first_left - frequencies.begin());
  if (count == 0)
    out.missing = fmt::format("ngspice would take some {} s at {} Hz", rounded_text(cost, 2),
                              rounded_text(frequencies.front().value));
  else if (count < frequencies.size())
    out.missing = fmt::format("ngspice ran at {} Hz{}", rounded_text(frequencies[count - 1].value),
                              count > 1 ? " and above" : "");
  out.at.resize(count);
  try {
    // The last one, of the lowest frequency, takes longest.
    parallel_for(count, thread_count(0), [&](std::size_t i) {
      stop_if_interrupted();
      out.at[count - 1 - i] = track(frequencies[count - 1 - i]);
    });
  } catch (const InputError& error) {  // "timestep too small"
    out.at.clear();
    out.missing = error.what();
  }
}

/// A controller on the board over one repeat, in parts of it that begin so much earlier that the loop has settled.
class BoardControllerTracker {
 public:
  BoardControllerTracker(const Project& project, const fpaa::ControllerVariant& variant)
      : project_(project), controller_(variant, project.target.disturbance) {
    for (const fpaa::ControllerCam& cam : variant.cams) clock_hz_ = std::max(clock_hz_, cam.clock_a.value);
    opamps_ = variant.resources.opamps;
  }
  double cost_s(Hertz f) const {
    return kSecondsAPeriod * opamps_ *
           (clock_hz_ * static_cast<double>(reference_.periods()) / f.value + 2.0 * kLoopClocks);
  }
  BoardInTime track(Hertz f) const {
    const double repeat_s = static_cast<double>(reference_.periods()) / f.value;
    const fpaa::ControllerVariant built = controller_.serving(f);
    const std::vector<double> by_charges = controller_.drive(reference_, f, 0.5).v;
    const std::string netlist =
        with_phases_of_time(with_own_contacts(fpaa::controller_netlist(built, {}, "board controller")));
    tracking::DriveWaveform drive{by_charges, repeat_s / static_cast<double>(by_charges.size())};
    parallel_for(kParts, thread_count(0), [&](std::size_t part) {
      const std::size_t from = part * drive.v.size() / kParts, to = (part + 1) * drive.v.size() / kParts;
      // On an edge of the clock as it stands at the repeat's begin.
      const double start_s =
          (std::floor(static_cast<double>(from) * drive.step_s * clock_hz_) - kLoopClocks) / clock_hz_;
      const double end_s = static_cast<double>(to) * drive.step_s, stop_s = end_s - start_s;
      const double start = start_s / repeat_s, end = end_s / repeat_s;
      const ngspice::Transient run = ngspice::run_transient(
          fmt::format("board controller\n{}{}{}{}Xc r rising v controller\nRv v 0 1e9\n{}\n", kSteps, netlist,
                      generator::reference_sources(reference_, f, start, end),
                      generator::rising_source(reference_, f, start, end), fpaa::board_deck_options()),
          {"v"}, 1.0 / clock_hz_, stop_s, "board_controller.sub");
      std::size_t place = 1;
      for (std::size_t k = from; k < to; ++k)
        drive.v[k] = run.at(0, (static_cast<double>(k) + 0.5) * drive.step_s - start_s, place);
    });
    return judged(project_, reference_, f, drive, by_charges, drive.v.size());
  }

 private:
  static constexpr double kLoopClocks = 80.0;  ///< a round takes two to four and leaves less than half
  static constexpr std::size_t kParts = 2;

  const Project& project_;
  tracking::Reference reference_ = tracking::Reference(project_.track.waveform(), project_.track.amplitude());
  BoardController controller_;
  double clock_hz_ = 0.0;
  int opamps_ = 0;
};

}  // namespace

BoardsInTime track_board_in_time(const Project& project, const Design& design,
                                 const std::vector<TrackedCandidate>& candidates) {
  BoardsInTime out;
  const TrackedCandidate* best = nullptr;
  double least = INFINITY;
  for (const TrackedCandidate& one : candidates) {
    if (one.key != tracked::fpaa_with_holds && one.key != tracked::self_fed_fpaa) continue;
    const double worst = std::ranges::max(tracked_percents(project, one.design));
    if (worst < least) {
      least = worst;
      best = &one;
    }
  }
  if (best == nullptr) return out;
  out.key = best->key;
  out.apart =
      "the closed form is of each harmonic's own frequency, ngspice has the images of the clock as well";
  const BoardTracker tracker(project, design, best->design.form);
  follow(
      out, project.track.frequency, [&](Hertz f) { return tracker.cost_s(tracker.window(f)); },
      [&](Hertz f) { return tracker.track(tracker.window(f)); });
  return out;
}

BoardsInTime track_board_controller_in_time(const Project& project,
                                            const std::vector<TrackedDesign>& tracked) {
  BoardsInTime out;
  const TrackedDesign* best = nullptr;
  std::optional<fpaa::ControllerVariant> variant;
  for (fpaa::ControllerVariant& one : board_controllers(project)) {
    const auto found = std::ranges::find(tracked, BoardController(one, project.target.disturbance).key(),
                                         &TrackedDesign::key);
    if (found == tracked.end()) continue;
    if (best != nullptr && best->worst_without_lag_percent() <= found->worst_without_lag_percent()) continue;
    best = &*found;
    variant = std::move(one);
  }
  if (best == nullptr) return out;
  out.key = best->key;
  const BoardControllerTracker tracker(project, *variant);
  try {
    follow(
        out, project.track.frequency, [&](Hertz f) { return tracker.cost_s(f); },
        [&](Hertz f) { return tracker.track(f); });
  } catch (const DesignError& error) {  // a converter, a comparator
    out.at.clear();
    out.missing = error.what();
  }
  return out;
}

}  // namespace bodesmith::project
