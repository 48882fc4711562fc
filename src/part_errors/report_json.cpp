#include <algorithm>

#include "base/json.hpp"
#include "part_errors/report.hpp"

namespace bodesmith::part_errors {
namespace {

constexpr std::size_t kNamedParts = 12;

const char* branch_name(Disturbance::Branch branch) {
  return branch == Disturbance::Branch::ascending ? "ascending" : "descending";
}

Json spread_json(const Spread& spread) {
  return {{"nominal_percent", spread.nominal_percent},
          {"median_percent", spread.median_percent},
          {"p95_percent", spread.p95_percent},
          {"max_percent", spread.max_percent}};
}

Json spreads_json(const std::vector<Hertz>& frequencies, const std::vector<Spread>& at) {
  Json out = Json::array();
  for (std::size_t i = 0; i < at.size(); ++i) {
    Json one = {{"frequency_hz", frequencies[i].value}};
    one.update(spread_json(at[i]));
    out.push_back(one);
  }
  return out;
}

Json shares_json(const std::vector<Share>& shares, std::size_t most) {
  Json out = Json::array();
  for (std::size_t i = 0; i < std::min(most, shares.size()); ++i) {
    out.push_back({{"name", shares[i].name},
                   {"group", shares[i].group},
                   {"variance_share", shares[i].share},
                   {"rms_percent", shares[i].rms_percent}});
  }
  return out;
}

Json study_json(const Report& report) {
  const Study& study = report.study;
  Json assumed;
  for (const PartErrors::Named& one : PartErrors::names()) assumed[one.name] = report.errors.*one.value;
  assumed["distribution"] =
      "resistors, capacitors and references uniform within the tolerance; all others normal, the figure being one "
      "standard deviation, cut at three";
  Json checked = Json::array();
  for (const DrawCheck& one : report.checked) {
    checked.push_back({{"draw", one.draw},
                       {"frequency_hz", one.frequency.value},
                       {"error_percent", one.percent},
                       {"ngspice_percent", one.ngspice_percent},
                       {"drive_difference_rms_percent", one.drive_rms_percent}});
  }
  return {{"assumed", assumed},
          {"checked_in_ngspice", checked},
          {"draws", study.draws},
          {"worst_frequency", spread_json(study.worst)},
          {"at", spreads_json(study.frequencies, study.at)},
          {"groups", shares_json(study.groups, study.groups.size())},
          {"parts", shares_json(study.parts, kNamedParts)},
          {"explained_by_shares", study.explained}};
}

Json trim_json(const Report& report, const controller::AnalogController& controller) {
  const TrimStudy& trims = report.trims;
  Json steps = Json::array();
  for (const TrimStep& step : trims.steps) {
    steps.push_back({{"trim", step.trim.name},
                     {"how", step.trim.how},
                     {"unit", step.trim.unit},
                     {"range", step.range},
                     {"reading", step.reading.words(controller, report.study.frequencies.back())},
                     {"expected_v", step.expected_v},
                     {"volts_per_setting", step.volts_per_setting}});
  }
  return {{"steps", steps},
          {"rounds", trims.rounds},
          {"foreseen_share", trims.foreseen_share},
          {"before", spread_json(trims.before)},
          {"after", spread_json(trims.after)},
          {"at", spreads_json(report.study.frequencies, trims.after_at)}};
}

Json point_json(const LoopPoint& point) {
  return {{"branch", branch_name(point.branch)},
          {"v", point.v},
          {"operating_hz", point.operating.value},
          {"rate_gain", point.rate_gain}};
}

}  // namespace

Json to_json(const LoopStability& loop) {
  Json out = {{"generator_greatest_loop_gain", loop.greatest_gain},
              {"generator_below_one_everywhere", loop.greatest_gain < 1.0},
              {"phase_margin_deg", loop.margin_deg},
              {"opamp", loop.opamp},
              {"role", loop.role},
              {"crossing_hz", loop.crossing.value},
              {"worst", point_json(loop.point)},
              {"warning", loop_warning(loop)}};
  if (loop.ngspice) {
    Json checked = {{"phase_margin_deg", loop.ngspice->margin_deg},
                    {"crossing_hz", loop.ngspice->crossing.value},
                    {"generator_greatest_loop_gain", loop.ngspice->greatest_gain},
                    {"greatest_difference_from_network", loop.ngspice->greatest_difference}};
    if (loop.ngspice->step) {
      const SwitchStep& step = *loop.ngspice->step;
      checked["change_of_branch"] = {{"r_v", step.v},
                                     {"step_percent", step.step_percent},
                                     {"overshoot_percent", step.overshoot_percent},
                                     {"settled_s", step.settled_s}};
    }
    out["ngspice"] = checked;
  }
  out["at"] = Json::array();
  for (const LoopAt& at : loop.at) {
    Json one = point_json(at.point);
    one["loop_gain"] = at.greatest_gain;
    one["gain_margin_db"] = at.gain_margin_db;
    Json margins = Json::array();
    for (const LoopAt::OpAmpMargin& m : at.opamps) {
      margins.push_back(
          {{"opamp", m.opamp}, {"phase_margin_deg", m.margin_deg}, {"crossing_hz", m.crossing.value}});
    }
    one["opamps"] = margins;
    out["at"].push_back(one);
  }
  return out;
}

Json to_json(const Report& report, const controller::AnalogController& controller) {
  Json out = {{"errors_of_parts", study_json(report)}, {"trim", trim_json(report, controller)}};
  if (!report.loop.at.empty()) out["stability"] = to_json(report.loop);
  return out;
}

}  // namespace bodesmith::part_errors
