#include "project/tracking/engines.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <iterator>
#include <map>

#include "base/error.hpp"
#include "base/text.hpp"
#include "project/tracking/tracked_plant.hpp"
#include "schematic/ngspice/ngspice.hpp"
#include "schematic/writers/spice_library.hpp"
#include "signal/statistics.hpp"
#include "synthesis/decks/compensator_files.hpp"
#include "tracking/track.hpp"

namespace bodesmith::project {
namespace {

using Responses = std::map<double, Complex>;  // by Hz

/// ngspice at the first harmonics of every tracked frequency and at steps of a hundredth from there to the last of all; a thousandth
/// of the lowest stands for rest.
Responses ngspice_responses(const Project& project, const synthesis::Circuit& circuit,
                            std::size_t harmonics) {
  constexpr double kEach = 64.0, kStep = 1.01;
  const double repeats = static_cast<double>(tracking::Reference(project.track.waveform()).periods());
  const auto [lowest, highest] = std::ranges::minmax(project.track.frequency);
  Responses out;
  for (const Hertz f : project.track.frequency) {
    for (double k = 1.0; k <= kEach; ++k) out[k * f.value / repeats] = {};
  }
  const double last = static_cast<double>(harmonics) * highest.value;
  for (double hz = kEach * lowest.value / repeats; hz < last; hz *= kStep) out[hz] = {};
  out[last] = {};
  out[1e-3 * out.begin()->first] = {};
  std::vector<Hertz> grid;
  for (const auto& [hz, response] : out) grid.push_back(Hertz{hz});
  const auto got = ngspice::run_ac_of_text(
      schematic::spice_text(synthesis::compensator_library(circuit, "check")), "compensator.sub", grid);
  std::size_t i = 0;
  for (auto& [hz, response] : out) response = got[i++];
  return out;
}

/// Straight between its points.
Complex response_at(const Responses& known, double hz) {
  const auto above = known.lower_bound(hz);
  if (above == known.begin()) return above->second;
  const auto below = std::prev(above);
  if (above == known.end()) return below->second;
  const double part = (hz - below->first) / (above->first - below->first);
  return below->second + part * (above->second - below->second);
}

/// The one with the least worst error; null when none is there.
const TrackedDesign* best_of(const TrackingStudy& study, std::initializer_list<std::string_view> keys) {
  const TrackedDesign* best = nullptr;
  for (const TrackedDesign& one : study.designs) {
    const bool asked =
        std::ranges::any_of(keys, [&](std::string_view key) { return one.key.starts_with(key); });
    if (asked && (best == nullptr || one.worst_without_lag_percent() < best->worst_without_lag_percent()))
      best = &one;
  }
  return best;
}

std::optional<double> worst_of(const TrackedDesign* design) {
  return design == nullptr ? std::nullopt : std::optional(design->worst_without_lag_percent());
}

void raise(std::optional<double>& to, double value) {
  to = std::max(to.value_or(0.0), value);
}

EngineRow circuit_row(const TrackingStudy& study, const TrackedDesign& design,
                      const tracking::Report& followed, const CircuitTracked& circuit) {
  EngineRow out{.what = design.name, .cvode_percent = worst_of(&design)};
  for (const Hertz f : study.frequency) {
    // An error that lasts a moment between two samples is in the means of one engine alone.
    const tracking::Case& in_time = *followed.find(f, design.name);
    if (in_time.check)
      raise(out.agreement_percent, std::max(in_time.check->difference_percent,
                                            std::abs(in_time.check->rms_percent - in_time.rms_percent)));
    const tracking::Case* harmonic = circuit.by_parts.find(f, design.name);
    if (harmonic == nullptr) continue;
    raise(out.closed_form_percent, harmonic->rms_percent_without_lag);
    const tracking::Case* ngspice = circuit.by_ngspice.find(f, design.name);
    if (ngspice == nullptr) continue;
    raise(out.ngspice_percent, ngspice->rms_percent_without_lag);
    raise(out.agreement_percent, error_figures(ngspice->displacement, harmonic->displacement).rms_percent);
  }
  return out;
}

std::string percent_text(const std::optional<double>& percent, const char* without = "-") {
  return percent ? fmt::format("{:.4f}", *percent) : without;
}

}  // namespace

CircuitTracked track_circuit(const Project& project, const Design& design,
                             const std::vector<TrackedCandidate>& candidates) {
  CircuitTracked out;
  if (!design.circuit) return out;
  tracking::Options options = tracking_options(project);
  options.time_domain = false;
  const auto plant = tracking_plant(project);
  std::vector<tracking::Design> by_parts, by_ngspice;
  const Responses at = ngspice::is_available()
                           ? ngspice_responses(project, design.realised().circuit, options.harmonics)
                           : Responses();
  tracking::ResponseCompensator simulated;
  simulated.response = [&at](RadPerSecond w) { return response_at(at, w.hz().value); };
  for (const TrackedCandidate& one : candidates) {
    if (one.key != tracked::circuit && one.key != tracked::self_fed_circuit) continue;
    by_parts.push_back(one.design);
    if (!at.empty())
      by_ngspice.push_back(compensated_design(project, one.design.name, simulated, one.design.form));
  }
  // Near their gain-bandwidth op-amps may have gains round which the closed form does not settle: then without harmonics up there.
  const auto follow = [&](const std::vector<tracking::Design>& designs) -> tracking::Report {
    for (const std::size_t harmonics : {tracking::Options().harmonics, std::size_t{1024}}) {
      options.harmonics = harmonics;
      try {
        return tracking::track(plant, designs, options);
      } catch (const DesignError& error) {
        out.missing = error.what();
      }
    }
    return {};
  };
  out.by_parts = follow(by_parts);
  if (!by_ngspice.empty()) out.by_ngspice = follow(by_ngspice);
  return out;
}

std::vector<EngineRow> engine_rows(const TrackingStudy& study, const tracking::Report& followed,
                                   const CircuitTracked& circuit, const std::vector<BoardsInTime>& boards) {
  std::vector<EngineRow> out;
  const TrackedDesign* ngspice = study.find("controller_circuit");
  if (const TrackedDesign* cvode = study.find("controller_cvode")) {
    out.push_back({.what = "analog controller",
                   .closed_form_percent = worst_of(study.find("controller_at_rest")),
                   .cvode_percent = worst_of(cvode),
                   .ngspice_percent = worst_of(ngspice),
                   .agreement_percent = study.agreement_percent});
  }
  if (const TrackedDesign* built = best_of(study, {tracked::circuit, tracked::self_fed_circuit}))
    out.push_back(circuit_row(study, *built, followed, circuit));
  for (EngineRow& one : out) {
    if (!one.ngspice_percent)
      one.missing = ngspice::is_available() ? circuit.missing : "ngspice is not installed";
  }
  for (const BoardsInTime& board : boards) {
    const TrackedDesign* built = study.find(board.key);
    if (built == nullptr) continue;
    EngineRow& row = out.emplace_back(EngineRow{.what = built->name, .closed_form_percent = worst_of(built)});
    for (const BoardInTime& at : board.at) {
      raise(row.ngspice_percent, at.rms_percent);
      raise(row.agreement_percent, at.difference_percent);
      const auto place = std::ranges::find(study.frequency, at.frequency) - study.frequency.begin();
      const double closed = built->at[static_cast<std::size_t>(place)].rms_percent_without_lag;
      if (board.apart.empty() || std::abs(at.rms_percent - closed) <= std::abs(row.apart_percent)) continue;
      row.apart_percent = at.rms_percent - closed;
      row.apart_where =
          fmt::format("at {} Hz {} % of range by closed form, {} by ngspice over {} s: {}",
                      rounded_text(at.frequency.value), rounded_text(closed, 3),
                      rounded_text(at.rms_percent, 3), rounded_text(at.followed_s, 2), board.apart);
    }
    row.missing = "a board is solved from edge to edge, which leaves nothing to CVODE";
    if (!board.apart.empty()) row.missing += "; " + board.apart;
    if (!board.missing.empty()) row.missing += "; " + board.missing;
  }
  return out;
}

std::vector<std::string> engine_warnings(const std::vector<EngineRow>& rows) {
  constexpr double kAgreePercent = 0.02;
  std::vector<std::string> out;
  for (const EngineRow& one : rows) {
    if (std::abs(one.apart_percent) > kAgreePercent) out.push_back(one.what + ": " + one.apart_where);
    if (!(one.agreement_percent.value_or(0.0) > kAgreePercent)) continue;
    out.push_back(fmt::format(
        "{}: its engines are {} % of range apart in time, more than {}; most of that is when a drive jumps at a turn of the reference",
        one.what, rounded_text(*one.agreement_percent, 2), kAgreePercent));
  }
  return out;
}

report::Table engine_table(const std::vector<EngineRow>& rows) {
  report::Table out{{"", "closed form", "CVODE", "ngspice", "within"}, {}, {}};
  for (const EngineRow& one : rows)
    out.rows.push_back({one.what, percent_text(one.closed_form_percent),
                        percent_text(one.cvode_percent, "no ODE"),
                        percent_text(one.ngspice_percent, "absent"), percent_text(one.agreement_percent)});
  return out;
}

}  // namespace bodesmith::project
