#include "project/tracking/board_in_time.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "base/error.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "base/whole_number.hpp"
#include "fpaa/plan/board_run.hpp"
#include "fpaa/plan/plan_graph.hpp"
#include "fpaa/sheets/board_netlist.hpp"
#include "numeric/parallel_for.hpp"
#include "project/tracking/tracked_plant.hpp"
#include "schematic/ngspice/ngspice.hpp"
#include "signal/statistics.hpp"
#include "synthesis/controller/as_built.hpp"

namespace bodesmith::project {
namespace {

/// What ngspice may take, over all frequencies, and what a period of a clock takes it for each op-amp of the board.
constexpr double kMostSeconds = 5.0, kSecondsAPeriod = 2e-3;
constexpr double kTimeConstants = 8.0;  ///< of the slowest pole before the window: 3e-4 of its start is left
/// The clock and the reference meet nowhere: so many periods of the slowest clock are most of what they can do together.
constexpr double kLeastClocks = 25.0;
constexpr double kSamplesAClock = 8.0;
/// SPICE's trtol. Whatever its steps inside an edge of a clock are, charge is kept: at 200, half the steps, drives are as near to those
/// at 1 (3e-6 of the stroke) as at SPICE's own 7.
constexpr double kTruncation = 200.0;
constexpr double kOfLargestInput = 0.5;  ///< of the board: a drive may go beyond the stroke

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
        netlist_(fpaa::board_netlist(*design.plan, {}, "board")),
        generator_(tracking_plant(project).generated().at(project.track.amplitude())) {
    double decay = INFINITY;
    for (const Section& section : design.sections().sections) {
      for (const std::complex<double>& pole : section.poles) decay = std::min(decay, -pole.real());
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
    const double blocks = std::ceil(std::max(1.0, kSamplesAClock * fastest_hz_ * out.repeat_s / 1024.0));
    out.a_repeat = 1024 * whole_number<std::size_t>(blocks, 1, 1024);
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
  constexpr double kSwitched = 1e-6;  // of a repeat
  const int repeats = whole_number<int>(std::ceil(window.end_s() / window.repeat_s));
  std::string rising;
  for (int i = 0; i <= repeats; ++i) {
    for (std::size_t piece = 0; piece < window.reference.turns().size(); ++piece) {
      const double at = window.reference.turns()[piece] + i;
      const int up = tracking::Reference::rises(piece) ? 1 : 0;
      if (at > 0.0) rising += fmt::format("{:.15g} {} ", (at - kSwitched) * window.repeat_s, 1 - up);
      rising += fmt::format("{:.15g} {}\n+ ", at * window.repeat_s, up);
    }
  }
  const Disturbance::Branch branch = project_.target.branch;
  const bool up = branch == Disturbance::Branch::ascending;
  const std::string deck = fmt::format(
      "board\n.options trtol={}\n{}{}Vg g 0 PWL({})\nBw w 0 V={:.15g}*{}\nXb w c board\nRc c 0 1e9\nBv v 0 V=V(r)-{}*V(c)/{:.15g}-{}*{}\n{}\n",
      kTruncation, netlist_, controller::reference_sources(window.reference, window.operating, repeats),
      rising, volts_, polynomial(branch), up ? "V(g)" : "(1-V(g))", volts_, up ? "(1-V(g))" : "V(g)",
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

BoardInTime BoardTracker::track(const Window& window) const {
  const ngspice::Transient run = run_in_ngspice(window);
  fpaa::BoardRun board = made(run);
  tracking::DriveWaveform drive{std::vector<double>(window.count), window.step_s};
  std::vector<double> by_charges(window.count);
  std::size_t i = 1;
  for (std::size_t k = window.skipped; k < window.skipped + window.count; ++k) {
    const double t = (static_cast<double>(k) + 0.5) * window.step_s;  // beside turns, where the drive jumps
    board.advance_to(t);
    const double theta = t / window.repeat_s;
    const bool rises = tracking::Reference::rises(window.reference.piece(theta - std::floor(theta)));
    const double made =
        graph_.output->node ? board.value(graph_.nodes[*graph_.output->node].name) : run.at(1, t, i);
    const std::size_t place = k % window.count;
    drive.v[place] = run.at(0, t, i);
    by_charges[place] = drive.v[place];
    if (branch_of(rises) == project_.target.branch) by_charges[place] += (run.at(2, t, i) - made) / volts_;
  }
  const tracking::PolynomialStage stage = own_stage(project_);
  std::vector<double> reference;
  for (std::size_t n = 0; n < window.a_repeat; ++n)
    reference.push_back(
        window.reference.value((static_cast<double>(n) + 0.5) / static_cast<double>(window.a_repeat)));
  BoardInTime out;
  out.rms_percent = tracking::tracking_error(stage.response(drive.v, drive.step_s, window.operating),
                                             reference, window.repeat_s)
                        .rms_percent_without_lag;
  out.difference_percent = 100.0 * error_figures(by_charges, drive.v).rms / window.reference.alpha();
  return out;
}

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
  if (!ngspice::is_available()) {
    out.missing = "ngspice is not installed";
    return out;
  }
  const BoardTracker tracker(project, design, best->design.form);
  std::vector<Hertz> frequencies = project.track.frequency;
  std::sort(frequencies.rbegin(), frequencies.rend());
  std::vector<Window> windows;
  double cost = 0.0;
  for (const Hertz f : frequencies) {
    const Window window = tracker.window(f);
    cost += tracker.cost_s(window);
    if (cost > kMostSeconds) break;
    windows.push_back(window);
  }
  if (windows.empty())
    out.missing = fmt::format("ngspice would take some {} s at {} Hz", rounded_text(cost, 2),
                              rounded_text(frequencies.front().value));
  else if (windows.size() < frequencies.size())
    out.missing = fmt::format("ngspice ran at {} Hz and above", rounded_text(windows.back().operating.value));
  out.at.resize(windows.size());
  try {
    // The last one, of the lowest frequency, takes longest.
    parallel_for(windows.size(), thread_count(0), [&](std::size_t i) {
      stop_if_interrupted();
      const std::size_t at = windows.size() - 1 - i;
      out.at[at] = tracker.track(windows[at]);
    });
  } catch (const InputError& error) {  // "timestep too small"
    out.at.clear();
    out.missing = error.what();
  }
  return out;
}

}  // namespace bodesmith::project
