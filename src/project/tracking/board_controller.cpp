#include "project/tracking/board_controller.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/documents/json.hpp"
#include "base/hertz_values.hpp"
#include "base/text.hpp"
#include "fpaa/controller/gains.hpp"
#include "fpaa/controller/run.hpp"
#include "signal/csv.hpp"

namespace bodesmith::project {
namespace {

using tracking::TrackingError;

/// Samples of one repeat of the reference: enough to see every hold of a fast one. A slow one is the whole of what there is to
/// see: holds are far shorter than anything that it does.
constexpr double kSamplesPerCycle = 2.0;
constexpr std::size_t kFewestSamples = 4096;
constexpr std::size_t kMostSamples = 65536;
/// Worst errors that differ by less are equal: the smaller controller is taken.
constexpr double kTie = 1.05;

std::size_t sample_count(double repeat_s, Hertz clock) {
  const double wanted = kSamplesPerCycle * repeat_s * clock.value;
  std::size_t out = kFewestSamples;
  while (out < kMostSamples && static_cast<double>(out) < wanted) out *= 2;
  return static_cast<double>(out) < wanted ? kFewestSamples : out;
}

Hertz fastest_clock(const fpaa::ControllerVariant& variant) {
  Hertz out{1.0};
  for (const fpaa::ControllerCam& cam : variant.cams) out = std::max(out, cam.clock_a);
  return out;
}

/// v = r, and v = r - d(r) without rate gains: what any board must beat.
class IdealDrive final : public tracking::BuiltController {
 public:
  IdealDrive(const Disturbance& disturbance, bool polynomial)
      : disturbance_(disturbance), polynomial_(polynomial) {}

  std::string key() const override { return polynomial_ ? "constant_polynomial" : "no_compensation"; }
  std::string name() const override {
    return polynomial_ ? "constant polynomial v = r - d(r), ideal" : "without compensation";
  }
  int part_count() const override { return 0; }
  tracking::DriveWaveform drive(const tracking::Reference& reference, Hertz operating) const override {
    tracking::DriveWaveform out;
    const double repeat = static_cast<double>(reference.periods()) / operating.value;
    out.step_s = repeat / static_cast<double>(kFewestSamples);
    for (std::size_t i = 0; i < kFewestSamples; ++i) {
      const double theta = static_cast<double>(i) / static_cast<double>(kFewestSamples);
      const double r = reference.value(theta);
      const bool up = tracking::Reference::rises(reference.piece(theta));
      const double d = disturbance_.value(branch_of(up), r);
      out.v.push_back(polynomial_ ? r - d : r);
    }
    return out;
  }

 private:
  const Disturbance& disturbance_;
  bool polynomial_;
};

BoardTrackingRow tracked_row(const tracking::BuiltController& controller, const tracking::Stage& stage,
                             const tracking::Reference& reference, const std::vector<Hertz>& frequencies) {
  std::vector<tracking::DriveWaveform> drives;
  BoardTrackingRow out;
  for (const Hertz f : frequencies) {
    drives.push_back(controller.drive(reference, f));
    for (const std::string& name : drives.back().clipped) {
      if (std::ranges::find(out.clipped, name) == out.clipped.end()) out.clipped.push_back(name);
    }
  }
  static_cast<TrackedDesign&>(out) = tracked_controller(controller, stage, reference, frequencies, drives);
  return out;
}

}  // namespace

BoardController::BoardController(fpaa::ControllerVariant variant, Disturbance disturbance)
    : variant_(std::move(variant)), disturbance_(std::move(disturbance)) {}

std::string BoardController::key() const {
  std::string structure = fpaa::to_string(variant_.structure);
  std::replace(structure.begin(), structure.end(), '-', '_');
  return fmt::format("controller_fpaa_{}_{}", fpaa::to_string(variant_.by), structure);
}

std::string BoardController::name() const {
  return fmt::format("FPAA controller ({})", variant_.name());
}

int BoardController::part_count() const {
  return static_cast<int>(variant_.cams.size() + variant_.outside.size());
}

fpaa::ControllerVariant BoardController::serving(Hertz operating) const {
  return variant_.at(disturbance_,
                     fpaa::serving_frequency(fpaa::gain_set_frequencies(disturbance_), operating));
}

tracking::DriveWaveform BoardController::drive(const tracking::Reference& reference, Hertz operating,
                                               double first) const {
  const double repeat = static_cast<double>(reference.periods()) / operating.value;
  const auto phase = [repeat](double t) {
    const double turns = t / repeat;
    return turns - std::floor(turns);
  };
  fpaa::ControllerRun run(serving(operating),
                          {[&](double t) { return reference.value(phase(t)); },
                           [&](double t) { return tracking::Reference::rises(reference.piece(phase(t))); }});
  const std::size_t count = sample_count(repeat, fastest_clock(variant_));
  tracking::DriveWaveform out;
  out.kind = tracking::DriveKind::stepped;
  out.step_s = repeat / static_cast<double>(count);
  for (std::size_t i = 0; i < count; ++i)
    out.v.push_back(run.drive((static_cast<double>(i) + first) * out.step_s));
  out.clipped = run.clipped();
  return out;
}

std::vector<fpaa::ControllerVariant> board_controllers(const Project& project) {
  if (!project.fpaa || project.choice != Project::Choice::tracking) return {};
  fpaa::ControllerOptions options;
  options.board = project.fpaa->board;
  auto made = fpaa::make_controller(project.target.disturbance, {}, options);
  auto* board = std::get_if<fpaa::Controller>(&made);
  if (board == nullptr) return {};
  std::erase_if(board->variants, [](const fpaa::ControllerVariant& one) {
    return !one.fits() || one.structure != fpaa::ControllerStructure::loop;
  });
  return std::move(board->variants);
}

BoardTracking track_board(const fpaa::Controller& controller, const Disturbance& disturbance,
                          const tracking::Stage& stage, const std::vector<Hertz>& frequencies,
                          const tracking::Reference& reference) {
  BoardTracking out{frequencies, {}};
  for (const bool polynomial : {false, true})
    out.rows.push_back(tracked_row(IdealDrive(disturbance, polynomial), stage, reference, frequencies));
  for (std::size_t i = 0; i < controller.variants.size(); ++i) {
    const fpaa::ControllerVariant& variant = controller.variants[i];
    const bool runs = !variant.refusal;
    out.rows.push_back(tracked_row(BoardController(variant, disturbance), stage, reference,
                                   runs ? frequencies : std::vector<Hertz>()));
    out.rows.back().name = variant.name();
    out.rows.back().variant = i;
    if (!runs) out.rows.back().why_not = variant.refusal->reason;
  }
  return out;
}

void choose_by_tracking(fpaa::Controller& controller, const BoardTracking& tracking,
                        const fpaa::ControllerOptions& options) {
  const BoardTrackingRow* best = nullptr;
  const auto cams = [&](const BoardTrackingRow& row) {
    return controller.variants[*row.variant].cams.size();
  };
  const auto may_be_taken = [&](const BoardTrackingRow& row) {
    if (!row.variant || row.at.empty()) return false;
    const fpaa::ControllerVariant& v = controller.variants[*row.variant];
    return (!options.polynomial || v.by == *options.polynomial) &&
           (!options.structure || v.structure == *options.structure);
  };
  for (const BoardTrackingRow& row : tracking.rows) {
    if (may_be_taken(row) &&
        (best == nullptr || row.worst_without_lag_percent() < best->worst_without_lag_percent()))
      best = &row;
  }
  if (best == nullptr) return;
  const double limit = kTie * best->worst_without_lag_percent();
  for (const BoardTrackingRow& row : tracking.rows) {
    if (may_be_taken(row) && row.worst_without_lag_percent() <= limit && cams(row) < cams(*best)) best = &row;
  }
  controller.chosen = *best->variant;
  const auto polynomial = std::ranges::find(tracking.rows, "constant_polynomial", &BoardTrackingRow::key);
  controller.why = fmt::format(
      "'{}' tracks with {} % rms at worst over {} to {} Hz as the board runs ({} % with the constant polynomial)",
      best->name, rounded_text(best->worst_without_lag_percent(), 2),
      rounded_text(tracking.frequency.front().value), rounded_text(tracking.frequency.back().value),
      rounded_text(polynomial->worst_without_lag_percent(), 2));
}

double TrackedController::worst_percent() const {
  for (const BoardTrackingRow& row : tracking.rows) {
    if (row.variant == controller.chosen) return row.worst_without_lag_percent();
  }
  return std::numeric_limits<double>::infinity();
}

Outcome<TrackedController> track_controller(const Disturbance& disturbance,
                                            const fpaa::BranchPlans& compensators,
                                            const fpaa::ControllerOptions& options, bool clock_is_given,
                                            const tracking::Stage& stage,
                                            const std::vector<Hertz>& frequencies) {
  constexpr double kWantedPercent = 0.05;
  constexpr Hertz kFaster{1e6};
  const auto made = [&](const fpaa::ControllerOptions& at, bool alone) -> Outcome<TrackedController> {
    auto outcome = fpaa::make_controller(disturbance, compensators, at);
    if (const Refusal* refusal = refusal_of(outcome)) return *refusal;
    TrackedController out{std::get<fpaa::Controller>(std::move(outcome)), {}};
    for (std::size_t i = 0; alone && i < out.controller.variants.size(); ++i) {
      if (i != out.controller.chosen && out.controller.variants[i].fits())
        out.controller.variants[i].refusal = Refusal{"not run at this fast clock"};
    }
    out.tracking = track_board(out.controller, disturbance, stage, frequencies);
    choose_by_tracking(out.controller, out.tracking, at);
    return out;
  };
  Outcome<TrackedController> first = made(options, false);
  const auto* out = std::get_if<TrackedController>(&first);
  if (out == nullptr || clock_is_given || out->worst_percent() <= kWantedPercent) return first;
  fpaa::ControllerOptions faster = options;
  faster.fast_clock = kFaster;
  faster.polynomial = out->controller.best().by;
  faster.structure = out->controller.best().structure;
  TrackedController fast = value_or_throw(made(faster, true));
  if (!(fast.worst_percent() <= kWantedPercent)) return first;
  fast.controller.why +=
      fmt::format("; its fast clock is {} ({} % at {})", engineering_text(kFaster.value, "Hz"),
                  rounded_text(out->worst_percent(), 2), engineering_text(options.fast_clock.value, "Hz"));
  return fast;
}

std::string BoardTracking::csv() const {
  CsvWriter out;
  out.add("frequency_hz", hertz_values(frequency));
  for (const BoardTrackingRow& row : rows) {
    if (!row.why_not) out.add(row.key + "_percent", row.each(&TrackingError::rms_percent_without_lag));
  }
  return out.text();
}

Json BoardTracking::to_json() const {
  Json out;
  out["frequency_hz"] = hertz_values(frequency);
  out["rows"] = Json::array();
  for (const BoardTrackingRow& row : rows) {
    Json item = {{"key", row.key}, {"name", row.name}};
    if (row.why_not) {
      item["why_not"] = *row.why_not;
    } else {
      item["rms_percent"] = row.each(&TrackingError::rms_percent_without_lag);
      item["rms_percent_with_lag"] = row.each(&TrackingError::rms_percent);
      item["max_percent"] = row.each(&TrackingError::max_percent);
      item["lag_s"] = row.each(&TrackingError::lag_s);
      item["clipped"] = row.clipped;
    }
    out["rows"].push_back(item);
  }
  return out;
}

}  // namespace bodesmith::project
