#include "synthesis/controller/as_built.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "base/error.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "base/whole_number.hpp"
#include "schematic/analysis/in_time.hpp"
#include "schematic/ngspice/ngspice.hpp"
#include "synthesis/generator/timing.hpp"

namespace bodesmith::generator {
namespace {

using tracking::Reference;

double in_repeat(double phase) {
  return phase - std::floor(phase);
}

schematic::InTime::Input repeating(const Reference& reference, double repeat_s) {
  return [&reference, repeat_s](double t) { return reference.value(in_repeat(t / repeat_s)); };
}

constexpr int kMostRepeats = 20;
/// Time constants of the smoothing: what is left of the start is some 1e-5.
constexpr double kSettled = 10.0;

double slowest_s(const DisturbanceCircuit& controller) {
  return controller.slope ? kSettled * controller.slope->smoothing_s : 0.0;
}

/// At least so many before the one that is kept; at kilohertz the smoothing takes more to settle, which are cheap.
double repeats_before(const DisturbanceCircuit& controller, double repeat_s, double least) {
  return slowest_s(controller) <= least * repeat_s ? least : repeats_to_settle(controller, repeat_s);
}

/// SIN(offset amplitude frequency delay damping phase): -cos is a sine that begins 90 degrees earlier.
std::string sine_source(const std::string& name, const std::string& from, const std::string& to,
                        double offset, double top, double f, double start_s) {
  return fmt::format("{} {} {} SIN({:.15g} {:.15g} {:.15g} 0 0 {:.15g})\n", name, from, to, offset, top, f,
                     360.0 * std::fmod(f * start_s, 1.0) - 90.0);
}

/// Straight lines through the volts at phases, in repeats.
std::string line_source(const char* node, const std::map<double, double>& volts, double start,
                        double repeat_s) {
  std::string out = fmt::format("V{0} {0} 0 PWL(", node);
  for (const auto& [phase, v] : volts)
    out += fmt::format("\n+ {:.15g} {:.15g}", (phase - start) * repeat_s, v);
  return out + ")\n";
}

ngspice::Transient run_as_tightly_as_it_goes(const std::string& deck, bool tight, double step_s,
                                             double stop_s) {
  const auto run = [&](const std::string& options) {
    return ngspice::run_transient("controller\n" + options + deck, {"r", "v"}, step_s, stop_s,
                                  "controller.sub");
  };
  std::vector<const char*> ways = {"", ".options reltol=1e-5\n", ".options reltol=1e-5 method=gear\n"};
  if (tight)
    ways.insert(ways.begin(),
                {".options reltol=1e-6\n", ".options reltol=1e-5 trtol=1\n", ".options reltol=1e-5\n"});
  for (std::size_t i = 0;; ++i) {
    try {
      return run(ways[i]);
    } catch (const InputError&) {
      // "timestep too small": where the corners of the netlist's models are in the way differs with the steps that come before.
      if (i + 1 == ways.size()) throw;
    }
  }
}

}  // namespace

NgspiceRun NgspiceRun::of_one(const Reference& reference) {
  NgspiceRun out = of_many();
  if (reference.shape() == Reference::Shape::triangle && reference.alpha() == 1.0) return out;
  return {.settle_repeats = out.settle_repeats, .samples = 8 * out.samples};
}

SteadyState run_in_cvode(const DisturbanceCircuit& controller, const Reference& reference, Hertz operating,
                         std::size_t samples, const std::vector<double>& at_s) {
  const Stopwatch watch;
  const double repeat = static_cast<double>(reference.periods()) / operating.value;
  // At the far end of the reference everything that is quick has settled.
  const double settle = repeats_before(controller, repeat, controller.stroke ? 1.0 : 0.5);
  SteadyState out{reference,
                  operating,
                  repeat / static_cast<double>(samples),
                  reference.samples(samples),
                  std::vector<double>(samples),
                  {},
                  at_s,
                  std::vector<double>(at_s.size()),
                  0.0};
  struct Wanted {
    double t;
    double* v;
  };
  std::vector<Wanted> wanted;
  // Every phase where it first comes after settling.
  const auto want = [&](double s, double& v) {
    wanted.push_back({s + std::ceil(settle - s / repeat) * repeat, &v});
  };
  for (std::size_t k = 0; k < samples; ++k) want(static_cast<double>(k) * out.step_s, out.v[k]);
  for (std::size_t k = 0; k < at_s.size(); ++k) want(at_s[k], out.own_v[k]);
  std::ranges::sort(wanted, {}, &Wanted::t);
  schematic::InTime run(controller, repeating(reference, repeat), {.input = "r"});
  run.begin(0.0);
  auto next = wanted.begin();
  const auto take = [&](double, double to) {
    for (; next != wanted.end() && next->t <= to; ++next) *next->v = run.volts("v", next->t);
  };
  std::vector<double> ends = reference.turns();
  ends.erase(ends.begin());
  ends.push_back(1.0);
  const double end = settle + 1.0;
  for (double k = 0.0; k < end; ++k) {
    for (const double theta : ends) {
      if (k + theta < end) run.run_to((k + theta) * repeat, take);
    }
  }
  run.run_to(end * repeat, take);
  // Rounding at the very end.
  for (; next != wanted.end(); ++next) *next->v = run.volts("v", end * repeat);
  out.wall_s = watch.seconds();
  return out;
}

double switch_delay_s(const DisturbanceCircuit& controller, const Reference& reference, Hertz operating) {
  const SlopeDetector detector(controller.detector_netlist(), "r");
  const double repeat = static_cast<double>(reference.periods()) / operating.value;
  const double turn = reference.turns().back(), next = reference.turns()[1];
  const std::optional<double> delay =
      detector.delay_s(repeating(reference, repeat), turn * repeat, repeat, (1.0 + next) * repeat);
  if (!delay) {
    throw DesignError(fmt::format("the slope detector misses the turns of a {} of {} Hz",
                                  to_string(reference.shape()), rounded_text(operating.value)));
  }
  return *delay + controller.analog_switch.on_delay_s;
}

std::string reference_sources(const Reference& reference, Hertz operating, double start, double end) {
  const double f = operating.value, half = 0.5 * reference.alpha();
  const double repeat = static_cast<double>(reference.periods()) / f, start_s = start * repeat;
  switch (reference.shape()) {
    case Reference::Shape::sine:
      return sine_source("Vr", "r", "0", half, half, f, start_s);
    case Reference::Shape::two_tone:
      return sine_source("Vr1", "r", "tone3", half, half / 1.5, f, start_s) +
             sine_source("Vr3", "tone3", "0", 0.0, half / 3.0, 3.0 * f, start_s);
    default:
      break;
  }
  std::map<double, double> volts;
  for (const double phase : {start, end}) volts[phase] = reference.value(in_repeat(phase));
  for (double whole = std::floor(start); whole < end; whole += 1.0) {
    for (const double theta : reference.turns()) {
      if (whole + theta > start && whole + theta < end) volts[whole + theta] = reference.value(theta);
    }
  }
  return line_source("r", volts, start, repeat);
}

std::string rising_source(const Reference& reference, Hertz operating, double start, double end) {
  constexpr double kSwitched = 1e-6;  // of a repeat
  std::map<double, double> volts{{start, Reference::rises(reference.piece(in_repeat(start))) ? 1.0 : 0.0}};
  for (double whole = std::floor(start); whole <= end; whole += 1.0) {
    for (std::size_t piece = 0; piece < reference.turns().size(); ++piece) {
      const double phase = whole + reference.turns()[piece];
      if (phase - kSwitched <= start || phase > end) continue;
      volts[phase] = Reference::rises(piece) ? 1.0 : 0.0;
      volts[phase - kSwitched] = 1.0 - volts[phase];
    }
  }
  return line_source("rising", volts, start, static_cast<double>(reference.periods()) / operating.value);
}

int repeats_to_settle(const DisturbanceCircuit& controller, double repeat_s) {
  return whole_number(std::ceil(slowest_s(controller) / repeat_s), 1, kMostRepeats);
}

SteadyState run_in_ngspice(const DisturbanceCircuit& controller, const Reference& reference, Hertz operating,
                           const NgspiceRun& options) {
  const Stopwatch watch;
  const double periods = static_cast<double>(reference.periods()), period = 1.0 / operating.value,
               repeat = periods * period;
  const double settle = repeats_before(controller, repeat, options.settle_repeats);
  const std::string deck = controller_library(controller, "controller", {options.off, false}) +
                           reference_sources(reference, operating, 0.0, std::ceil(settle + 1.0)) +
                           "Xc r v controller\n";
  const ngspice::Transient run = run_as_tightly_as_it_goes(deck, !(operating < options.tight_from),
                                                           period / options.steps, (settle + 1.0) * repeat);
  const std::size_t samples = options.samples * reference.periods();
  SteadyState out{reference, operating, repeat / static_cast<double>(samples), {}, {}, {}, {}, {}, 0.0};
  // Every phase where it first comes after `from` repeats.
  const auto sample = [&](std::size_t column, double from, std::vector<double>& to) {
    std::size_t i = 1;
    for (std::size_t k = 0; k < samples; ++k) {
      const double phase = static_cast<double>(k) / static_cast<double>(samples);
      to.push_back(run.at(column, std::ceil(from - phase) * repeat + static_cast<double>(k) * out.step_s, i));
    }
  };
  sample(0, settle, out.r);
  sample(1, settle, out.v);
  if (settle >= 1.0) sample(1, 0.0, out.first_v);
  for (std::size_t i = 0; i < run.time_s.size(); ++i) {
    if (run.time_s[i] < settle * repeat) continue;
    out.own_s.push_back(std::fmod(run.time_s[i], repeat));
    out.own_v.push_back(run.v[1][i]);
  }
  // From phase 0 on, as everything else.
  const auto begin = std::is_sorted_until(out.own_s.begin(), out.own_s.end()) - out.own_s.begin();
  std::rotate(out.own_s.begin(), out.own_s.begin() + begin, out.own_s.end());
  std::rotate(out.own_v.begin(), out.own_v.begin() + begin, out.own_v.end());
  out.wall_s = watch.seconds();
  return out;
}

tracking::TrackingError stage_error(const DisturbanceCircuit& controller, const SteadyState& run) {
  const tracking::PolynomialStage stage(controller.disturbance, {}, {.alpha = run.reference.alpha()});
  return tracking::tracking_error(
      stage.response(run.v, run.step_s, run.operating, tracking::DriveKind::smooth), run.r, run.period_s());
}

std::string CircuitController::name() const {
  return fmt::format("analog controller, {} ({})", to_string(controller_->form),
                     options_ ? "ngspice" : "CVODE");
}

int CircuitController::part_count() const {
  const DisturbanceCircuit& c = *controller_;
  return static_cast<int>(c.parts.size() + c.opamps.size() + c.multipliers.size() + c.contacts.size() +
                          c.sources.size());
}

tracking::DriveWaveform CircuitController::drive(const tracking::Reference& reference,
                                                 Hertz operating) const {
  const SteadyState run = options_
                              ? run_in_ngspice(*controller_, reference, operating, *options_)
                              : run_in_cvode(*controller_, reference, operating,
                                             NgspiceRun::of_one(reference).samples * reference.periods());
  return {run.v, run.step_s};
}

}  // namespace bodesmith::generator
