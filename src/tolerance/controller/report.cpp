#include "tolerance/controller/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/documents/json.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "base/text_template.hpp"
#include "schematic/ngspice/ngspice.hpp"

namespace bodesmith::tolerance {
namespace {

std::string percent_text(double value) {
  return rounded_text(value, 3) + " %";
}

constexpr std::size_t kNamedParts = 12;

Json spread_json(const ErrorSpread& spread) {
  return {{"nominal_percent", spread.nominal_percent},
          {"median_percent", spread.median_percent},
          {"p95_percent", spread.p95_percent},
          {"max_percent", spread.max_percent}};
}

Json spreads_json(const std::vector<Hertz>& frequencies, const std::vector<ErrorSpread>& at) {
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

Json study_json(const ControllerReport& report, const generator::DisturbanceCircuit& controller) {
  const Study& study = report.study;
  Json checked = Json::array();
  for (const DrawCheck& one : report.checked) {
    checked.push_back({{"draw", one.draw},
                       {"frequency_hz", one.frequency.value},
                       {"error_percent", one.percent},
                       {"ngspice_percent", one.ngspice_percent},
                       {"drive_difference_rms_percent", one.drive_rms_percent}});
  }
  return {{"assumed", to_json(report.errors)},
          {"held_stroke_low_percent",
           controller.stroke ? Json(100.0 * controller.stroke->held_off(1.0)) : Json(nullptr)},
          {"checked_in_ngspice", checked},
          {"draws", study.draws},
          {"worst_frequency", spread_json(study.worst)},
          {"at", spreads_json(study.frequencies, study.at)},
          {"groups", shares_json(study.groups, study.groups.size())},
          {"parts", shares_json(study.parts, kNamedParts)},
          {"explained_by_shares", study.explained}};
}

Json trim_json(const ControllerReport& report, const generator::DisturbanceCircuit& controller) {
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

std::string volts_text(double volts) {
  return fmt::format("{:.4f} V", std::abs(volts) < 5e-5 ? 0.0 : volts);
}

std::string range_text(const TrimStep& step) {
  return step.trim.unit.empty() ? fmt::format("+-{} %", rounded_text(100.0 * step.range, 3))
                                : fmt::format("+-{} m{}", rounded_text(1e3 * step.range, 3), step.trim.unit);
}

/// What the whole range of a potentiometer moves the reading by.
std::string moves_text(const TrimStep& step) {
  return fmt::format("{} mV", rounded_text(1e3 * std::abs(2.0 * step.range * step.volts_per_setting), 2));
}

Json expected_points(const generator::DisturbanceCircuit& controller) {
  const generator::RestWiring wiring(controller);
  const Board board(wiring, copy_of(controller, {}, {}));
  Json out = Json::array();
  for (const double r : {0.0, 0.25, 0.5, 0.75, 1.0}) {
    out.push_back({{"r", fmt::format("{:.2f}", r)},
                   {"rising", fmt::format("{:.4f}", board.at_rest(r, true) + 0.0)},
                   {"falling", fmt::format("{:.4f}", board.at_rest(r, false) + 0.0)}});
  }
  return out;
}

}  // namespace

double examined_stroke(const generator::DisturbanceCircuit& controller, double asked) {
  return controller.stroke ? 1.0 : asked;
}

ControllerReport examine(const generator::DisturbanceCircuit& controller, const tracking::Stage& stage,
                         const ControllerReportOptions& options) {
  ControllerReport out;
  out.errors = options.study.errors;
  out.loop = options.ngspice && ngspice::is_available() ? generator::checked_loop_stability(controller)
                                                        : generator::loop_stability(controller);
  generator::require_stable(out.loop, options.allow_unstable);
  StudyOptions study = options.study;
  study.switch_delays_s = switch_delays_s(controller, study.frequencies);
  out.study = study_errors(controller, stage, study);
  out.trims = study_trims(controller, stage, study, options.trims, &out.study);
  if (options.ngspice && options.checked_draws > 0 && ngspice::is_available())
    out.checked = check_draws(controller, stage, study, options.checked_draws);
  return out;
}

std::string summary_text(const ControllerReport& report, const generator::DisturbanceCircuit& controller) {
  const Study& study = report.study;
  std::string out =
      fmt::format("tracked error over {} copies, worst frequency: nominal {}, median {}, 95 % below {}\n",
                  study.draws, percent_text(study.worst.nominal_percent),
                  percent_text(study.worst.median_percent), percent_text(study.worst.p95_percent));
  if (controller.stroke) {
    out +=
        fmt::format("  in every copy: what holds the stroke is low by {} (droop, charge of its contacts)\n",
                    percent_text(100.0 * controller.stroke->held_off(1.0)));
  }
  for (std::size_t i = 0; i < study.parts.size() && i < 5; ++i) {
    out += fmt::format("  {}: {} % of the variance\n", study.parts[i].name,
                       rounded_text(100.0 * study.parts[i].share, 2));
  }
  for (const DrawCheck& one : report.checked) {
    out += fmt::format("  copy {} at {} Hz: {}, ngspice {}\n", one.draw, rounded_text(one.frequency.value),
                       percent_text(one.percent), percent_text(one.ngspice_percent));
  }
  const TrimStudy& trims = report.trims;
  if (!trims.steps.empty()) {
    std::string names;
    for (const TrimStep& step : trims.steps) names += (names.empty() ? "" : ", ") + step.trim.name;
    out += fmt::format("trimmed blind ({}): median {}, 95 % below {}\n", names,
                       percent_text(trims.after.median_percent), percent_text(trims.after.p95_percent));
  }
  return out + generator::summary_text(report.loop);
}

std::string draws_csv(const Study& study) {
  std::string out = "draw";
  for (const Hertz f : study.frequencies)
    out += fmt::format(",error_{}_hz_percent", rounded_text(f.value, 6));
  out += "\n";
  for (std::size_t i = 0; i < study.percent.size(); ++i) {
    out += fmt::format("{}", i);
    for (const double value : study.percent[i]) out += "," + number_text(value);
    out += "\n";
  }
  return out;
}

Json to_json(const ControllerReport& report, const generator::DisturbanceCircuit& controller) {
  Json out = {{"errors_of_parts", study_json(report, controller)}, {"trim", trim_json(report, controller)}};
  if (!report.loop.at.empty()) out["stability"] = generator::to_json(report.loop);
  return out;
}

std::string trim_page(const ControllerReport& report, const generator::DisturbanceCircuit& controller,
                      const std::string& title) {
  const TrimStudy& trims = report.trims;
  const Hertz fastest = report.study.frequencies.back();
  Json data = {{"title", title}, {"steps", Json::array()}};
  for (std::size_t i = 0; i < trims.steps.size(); ++i) {
    const TrimStep& step = trims.steps[i];
    data["steps"].push_back({{"number", std::to_string(i + 1)},
                             {"trim", step.trim.name},
                             {"how", step.trim.how},
                             {"range", range_text(step)},
                             {"reading", step.reading.words(controller, fastest)},
                             {"expected", volts_text(step.expected_v)},
                             {"moves", moves_text(step)},
                             {"way", step.volts_per_setting > 0.0 ? "rises" : "falls"}});
  }
  data["any"] = !trims.steps.empty();
  data["rounds"] = std::to_string(trims.rounds);
  data["points"] = expected_points(controller);
  data["at"] = Json::array();
  for (std::size_t i = 0; i < trims.after_at.size(); ++i) {
    data["at"].push_back({{"frequency", rounded_text(report.study.frequencies[i].value)},
                          {"before_median", rounded_text(trims.before_at[i].median_percent, 2)},
                          {"before_p95", rounded_text(trims.before_at[i].p95_percent, 2)},
                          {"after_median", rounded_text(trims.after_at[i].median_percent, 2)},
                          {"after_p95", rounded_text(trims.after_at[i].p95_percent, 2)}});
  }
  data["parts"] = Json::array();
  for (std::size_t i = 0; i < report.study.parts.size() && i < 8; ++i) {
    const Share& one = report.study.parts[i];
    data["parts"].push_back({{"name", one.name},
                             {"share", rounded_text(100.0 * one.share, 2)},
                             {"rms", rounded_text(one.rms_percent, 2)}});
  }
  data["rates"] = controller.slope.has_value();
  if (controller.slope) {
    const Reading slope{Reading::Kind::slope, 0.0};
    const generator::RestWiring wiring(controller);
    const Board board(wiring, copy_of(controller, {}, {}));
    const Input input = input_of(tracking::Reference(), fastest, 256);
    data["slope_words"] = slope.words(controller, fastest);
    data["slope_v"] = volts_text(board.mean_slope_v(input));
  }
  return render_template("controller/trim.md", data);
}

}  // namespace bodesmith::tolerance
