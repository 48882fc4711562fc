#include "project/tracking/tracking_study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/documents/json.hpp"
#include "base/hertz_values.hpp"
#include "signal/columns.hpp"
#include "signal/csv.hpp"

namespace bodesmith::project {
namespace {

using tracking::TrackingError;

Json design_json(const TrackedDesign& design) {
  Json out = {{"key", design.key},
              {"name", design.name},
              {"built", design.built},
              {"rms_percent", design.each(&TrackingError::rms_percent)},
              {"max_percent", design.each(&TrackingError::max_percent)},
              {"rms_percent_without_lag", design.each(&TrackingError::rms_percent_without_lag)},
              {"lag_s", design.each(&TrackingError::lag_s)}};
  if (!design.on_reference_percent.empty()) out["rms_percent_on_reference"] = design.on_reference_percent;
  return out;
}

Json elsewhere_json(const TrackedElsewhere& one) {
  Json out = {{"stage", one.stage}, {"waveform", to_string(one.waveform)}, {"amplitude", one.amplitude}};
  if (!one.fit_percent.empty()) out["fit_percent"] = one.fit_percent;
  out["designs"] = Json::array();
  for (const TrackedDesign& design : one.designs) out["designs"].push_back(design_json(design));
  return out;
}

}  // namespace

Json to_json(const TrackingStudy& study) {
  Json out;
  out["frequency_hz"] = hertz_values(study.frequency);
  out["waveform"] = to_string(study.waveform);
  out["amplitude"] = study.amplitude;
  out["as_built"] = study.as_built;
  if (const TrackedDesign* built = study.find(study.as_built)) {
    out["as_built_worst_percent"] = built->worst_percent();
    out["as_built_worst_percent_without_lag"] = built->worst_without_lag_percent();
  }
  out["designs"] = Json::array();
  for (const TrackedDesign& design : study.designs) out["designs"].push_back(design_json(design));
  out["elsewhere"] = Json::array();
  for (const TrackedElsewhere& one : study.elsewhere) out["elsewhere"].push_back(elsewhere_json(one));
  out["cross_check_percent"] = study.max_cross_check_percent;
  const auto or_null = [](const std::optional<double>& value) {
    return value ? Json(*value) : Json(nullptr);
  };
  out["agreement_percent"] = or_null(study.agreement_percent);
  out["engines"] = Json::array();
  for (const EngineRow& one : study.engines)
    out["engines"].push_back({{"what", one.what},
                              {"closed_form_percent", or_null(one.closed_form_percent)},
                              {"cvode_percent", or_null(one.cvode_percent)},
                              {"ngspice_percent", or_null(one.ngspice_percent)},
                              {"agreement_percent", or_null(one.agreement_percent)},
                              {"missing", one.missing}});
  out["findings"] = study.findings;
  return out;
}

std::string tracking_csv(const TrackingStudy& study) {
  CsvWriter writer;
  writer.add(column::frequency_hz, hertz_values(study.frequency));
  for (const TrackedDesign& design : study.designs)
    writer.add(design.key + "_percent", design.each(&TrackingError::rms_percent));
  for (const TrackedDesign& design : study.designs)
    writer.add(design.key + "_without_lag_percent", design.each(&TrackingError::rms_percent_without_lag));
  for (const TrackedDesign& design : study.designs) {
    if (!design.on_reference_percent.empty())
      writer.add(design.key + "_on_reference_percent", design.on_reference_percent);
  }
  return writer.text();
}

std::string tracking_stages_csv(const TrackingStudy& study) {
  std::string out =
      "stage,waveform,amplitude,frequency_hz,design,rms_percent,without_lag_percent,fit_percent\n";
  for (const TrackedElsewhere& one : study.elsewhere) {
    for (const TrackedDesign& design : one.designs) {
      for (std::size_t i = 0; i < study.frequency.size(); ++i) {
        out += fmt::format("{},{},{},{},{},{:.6g},{:.6g},", one.stage, to_string(one.waveform), one.amplitude,
                           study.frequency[i].value, design.key, design.at[i].rms_percent,
                           design.at[i].rms_percent_without_lag);
        if (!one.fit_percent.empty()) out += fmt::format("{:.6g}", one.fit_percent[i]);
        out += "\n";
      }
    }
  }
  return out;
}

std::vector<double> TrackedDesign::each(double TrackingError::*figure) const {
  std::vector<double> out;
  for (const TrackingError& one : at) out.push_back(one.*figure);
  return out;
}

double TrackedDesign::worst_percent() const {
  return at.empty() ? INFINITY : std::ranges::max(at, {}, &TrackingError::rms_percent).rms_percent;
}

double TrackedDesign::worst_without_lag_percent() const {
  const auto without_lag = &TrackingError::rms_percent_without_lag;
  return at.empty() ? INFINITY : std::ranges::max(at, {}, without_lag).*without_lag;
}

TrackedDesign tracked_controller(const tracking::BuiltController& controller, const tracking::Stage& stage,
                                 const tracking::Reference& reference, const std::vector<Hertz>& frequencies,
                                 const std::vector<tracking::DriveWaveform>& drives) {
  TrackedDesign out{controller.key(), controller.name(), true, controller.part_count(), {}, {}};
  for (std::size_t i = 0; i < frequencies.size(); ++i) {
    const tracking::DriveWaveform& drive = drives[i];
    const double repeat = static_cast<double>(reference.periods()) / frequencies[i].value;
    const auto samples = static_cast<double>(drive.v.size());
    const double repeats = std::max(1.0, std::round(samples * drive.step_s / repeat));
    out.at.push_back(
        tracking::tracking_error(stage.response(drive.v, drive.step_s, frequencies[i], drive.kind),
                                 reference.samples(static_cast<std::size_t>(samples / repeats)), repeat));
  }
  return out;
}

const TrackedDesign* TrackingStudy::find(std::string_view key) const {
  const auto found = std::ranges::find(designs, key, &TrackedDesign::key);
  return found == designs.end() ? nullptr : &*found;
}

std::string frequency_span(const TrackingStudy& study) {
  const auto [low, high] = std::minmax_element(study.frequency.begin(), study.frequency.end());
  if (low == high) return rounded_text(low->value) + " Hz";
  return fmt::format("{} to {} Hz", rounded_text(low->value), rounded_text(high->value));
}

report::Table headline_table(const Project& project, const TrackingStudy& study) {
  report::Table out{{"", "as it is", "delay removed"}, {}, {}};
  const auto add = [&](const std::string& what, const TrackedDesign* design) {
    if (design == nullptr) return;
    out.rows.push_back({what, fmt::format("{:.3f}", design->worst_percent()),
                        fmt::format("{:.3f}", design->worst_without_lag_percent())});
  };
  const TrackedDesign* built = study.find(study.as_built);
  add("as built: " + (built == nullptr ? std::string() : built->name), built);
  add("without compensation", study.find(tracked::none));
  add("the paper's design: one pass, ideal cascade", study.find(tracked::cascade));
  if (const TrackedDesign* board = study.find(tracked::paper_board)) add(board->name, board);
  const std::vector<double>& measured = project.track.measured_percent;
  if (!measured.empty()) {
    const auto [low, high] = std::minmax_element(measured.begin(), measured.end());
    out.rows.push_back({"measured on the paper's stage", "", fmt::format("{:.2f} to {:.2f}", *low, *high)});
  }
  return out;
}

}  // namespace bodesmith::project
