#include "project/design/board_controller.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/documents/json.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "fpaa/controller/gains.hpp"
#include "fpaa/controller/run.hpp"
#include "signal/csv.hpp"

namespace bodesmith::project {
namespace {

/// Samples of one repeat of the reference: enough to see every hold of a fast reference, and the whole of a
/// slow one.
constexpr double kSamplesPerCycle = 2.0;
constexpr std::size_t kFewestSamples = 4096;
constexpr std::size_t kMostSamples = 65536;
/// Worst errors that differ by less are equal: the smaller controller is taken.
constexpr double kTie = 1.05;

std::size_t sample_count(double repeat_s, Hertz clock) {
  const double wanted = kSamplesPerCycle * repeat_s * clock.value;
  std::size_t out = kFewestSamples;
  while (out < kMostSamples && static_cast<double>(out) < wanted) out *= 2;
  return out;
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

void add_error(BoardTrackingRow& row, const tracking::DriveWaveform& drive, const tracking::Stage& stage,
               const tracking::Reference& reference, Hertz operating) {
  const double repeat = static_cast<double>(reference.periods()) / operating.value;
  const std::vector<double> y = stage.response(drive.v, drive.step_s, operating);
  const auto error = tracking::tracking_error(y, reference.samples(drive.v.size()), repeat);
  row.rms_percent.push_back(error.rms_percent_without_lag);
  row.rms_percent_with_lag.push_back(error.rms_percent);
  row.max_percent.push_back(error.max_percent);
  row.lag_s.push_back(error.lag_s);
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

tracking::DriveWaveform BoardController::drive(const tracking::Reference& reference, Hertz operating) const {
  std::vector<std::string> clipped;
  return drive(reference, operating, clipped);
}

tracking::DriveWaveform BoardController::drive(const tracking::Reference& reference, Hertz operating,
                                               std::vector<std::string>& clipped) const {
  const double repeat = static_cast<double>(reference.periods()) / operating.value;
  const auto phase = [repeat](double t) {
    const double turns = t / repeat;
    return turns - std::floor(turns);
  };
  const Hertz served = fpaa::serving_frequency(fpaa::gain_set_frequencies(disturbance_), operating);
  fpaa::ControllerRun run(variant_.at(disturbance_, served),
                          {[&](double t) { return reference.value(phase(t)); },
                           [&](double t) { return tracking::Reference::rises(reference.piece(phase(t))); }});
  const std::size_t count = sample_count(repeat, fastest_clock(variant_));
  tracking::DriveWaveform out;
  out.step_s = repeat / static_cast<double>(count);
  for (std::size_t i = 0; i < count; ++i) out.v.push_back(run.drive(static_cast<double>(i) * out.step_s));
  clipped = run.clipped();
  return out;
}

double BoardTrackingRow::worst_percent() const {
  if (rms_percent.empty()) return std::numeric_limits<double>::infinity();
  return *std::max_element(rms_percent.begin(), rms_percent.end());
}

BoardTracking track_board(const fpaa::Controller& controller, const Disturbance& disturbance,
                          const tracking::Stage& stage, const std::vector<Hertz>& frequencies,
                          const tracking::Reference& reference) {
  const Stopwatch watch;
  BoardTracking out;
  out.frequency = frequencies;
  for (const bool polynomial : {false, true}) {
    const IdealDrive ideal(disturbance, polynomial);
    BoardTrackingRow row;
    row.key = ideal.key();
    row.name = ideal.name();
    for (const Hertz f : frequencies) add_error(row, ideal.drive(reference, f), stage, reference, f);
    out.rows.push_back(std::move(row));
  }
  for (std::size_t i = 0; i < controller.variants.size(); ++i) {
    const BoardController board(controller.variants[i], disturbance);
    BoardTrackingRow row;
    row.key = board.key();
    row.name = board.variant().name();
    row.variant = i;
    if (board.variant().refusal) {
      row.why_not = board.variant().refusal->reason;
    } else {
      for (const Hertz f : frequencies) {
        std::vector<std::string> clipped;
        add_error(row, board.drive(reference, f, clipped), stage, reference, f);
        for (const std::string& name : clipped) {
          if (std::find(row.clipped.begin(), row.clipped.end(), name) == row.clipped.end())
            row.clipped.push_back(name);
        }
      }
    }
    out.rows.push_back(std::move(row));
  }
  out.compute_s = watch.seconds();
  return out;
}

const BoardTrackingRow* BoardTracking::find(std::string_view key) const {
  const auto at =
      std::find_if(rows.begin(), rows.end(), [&](const BoardTrackingRow& r) { return r.key == key; });
  return at == rows.end() ? nullptr : &*at;
}

void choose_by_tracking(fpaa::Controller& controller, const BoardTracking& tracking,
                        const fpaa::ControllerOptions& options) {
  const BoardTrackingRow* best = nullptr;
  const auto cams = [&](const BoardTrackingRow& row) {
    return controller.variants[*row.variant].cams.size();
  };
  const auto may_be_taken = [&](const BoardTrackingRow& row) {
    if (!row.variant || row.rms_percent.empty()) return false;
    const fpaa::ControllerVariant& v = controller.variants[*row.variant];
    return (!options.polynomial || v.by == *options.polynomial) &&
           (!options.structure || v.structure == *options.structure);
  };
  for (const BoardTrackingRow& row : tracking.rows) {
    if (may_be_taken(row) && (best == nullptr || row.worst_percent() < best->worst_percent())) best = &row;
  }
  if (best == nullptr) return;
  const double limit = kTie * best->worst_percent();
  for (const BoardTrackingRow& row : tracking.rows) {
    if (may_be_taken(row) && row.worst_percent() <= limit && cams(row) < cams(*best)) best = &row;
  }
  controller.chosen = *best->variant;
  const BoardTrackingRow* polynomial = tracking.find("constant_polynomial");
  controller.why = fmt::format(
      "'{}' tracks with {} % rms at worst over {} to {} Hz as the board runs ({} % with the constant polynomial)",
      best->name, rounded_text(best->worst_percent(), 2), rounded_text(tracking.frequency.front().value),
      rounded_text(tracking.frequency.back().value), rounded_text(polynomial->worst_percent(), 2));
}

double TrackedController::worst_percent() const {
  for (const BoardTrackingRow& row : tracking.rows) {
    if (row.variant == controller.chosen) return row.worst_percent();
  }
  return std::numeric_limits<double>::infinity();
}

Outcome<TrackedController> track_controller(const Disturbance& disturbance, const fpaa::Plan* ascending,
                                            const fpaa::Plan* descending,
                                            const fpaa::ControllerOptions& options, bool clock_is_given,
                                            const tracking::Stage& stage,
                                            const std::vector<Hertz>& frequencies) {
  constexpr double kWantedPercent = 0.05;
  constexpr Hertz kFaster{1e6};
  const auto made = [&](const fpaa::ControllerOptions& at, bool alone) -> Outcome<TrackedController> {
    auto outcome = fpaa::make_controller(disturbance, ascending, descending, at);
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
  std::vector<std::string> columns = {"frequency_hz"};
  for (const BoardTrackingRow& row : rows) {
    if (!row.why_not) columns.push_back(row.key + "_percent");
  }
  CsvTable out(columns);
  for (std::size_t i = 0; i < frequency.size(); ++i) {
    std::vector<std::string> line = {number_text(frequency[i].value)};
    for (const BoardTrackingRow& row : rows) {
      if (!row.why_not) line.push_back(number_text(row.rms_percent[i]));
    }
    out.add_row(line);
  }
  return out.text();
}

Json BoardTracking::to_json() const {
  Json out;
  out["frequency_hz"] = Json::array();
  for (const Hertz f : frequency) out["frequency_hz"].push_back(f.value);
  out["rows"] = Json::array();
  for (const BoardTrackingRow& row : rows) {
    Json item = {{"key", row.key}, {"name", row.name}};
    if (row.why_not) {
      item["why_not"] = *row.why_not;
    } else {
      item["rms_percent"] = row.rms_percent;
      item["rms_percent_with_lag"] = row.rms_percent_with_lag;
      item["max_percent"] = row.max_percent;
      item["lag_s"] = row.lag_s;
      item["clipped"] = row.clipped;
    }
    out["rows"].push_back(item);
  }
  return out;
}

}  // namespace bodesmith::project
