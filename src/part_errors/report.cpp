#include "part_errors/report.hpp"

#include <fmt/format.h>

#include "base/progress.hpp"
#include "base/text.hpp"
#include "spice/ngspice.hpp"

namespace bodesmith::part_errors {
namespace {

std::string percent_text(double value) {
  return rounded_text(value, 3) + " %";
}

}  // namespace

Report examine(const controller::AnalogController& controller, const tracking::Stage& stage,
               const ReportOptions& options) {
  const Stopwatch watch;
  Report out;
  out.errors = options.study.errors;
  out.loop = options.ngspice && spice::ngspice_available() ? checked_loop_stability(controller)
                                                           : loop_stability(controller);
  require_stable(out.loop, options.allow_unstable);
  out.study = study_errors(controller, stage, options.study);
  out.trims = study_trims(controller, stage, options.study, options.trims, &out.study);
  if (options.ngspice && options.checked_draws > 0 && spice::ngspice_available())
    out.checked = check_draws(controller, stage, options.study, options.checked_draws);
  out.seconds = watch.seconds();
  return out;
}

std::string summary_text(const Report& report) {
  const Study& study = report.study;
  std::string out =
      fmt::format("tracked error over {} copies, worst frequency: nominal {}, median {}, 95 % below {}\n",
                  study.draws, percent_text(study.worst.nominal_percent),
                  percent_text(study.worst.median_percent), percent_text(study.worst.p95_percent));
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
  const LoopStability& loop = report.loop;
  if (loop.at.empty()) return out + "stability: not looked at, the op-amps are ideal\n";
  out += fmt::format(
      "stability: the generator's loop gain is at most {}{}; least phase margin of an op-amp {} deg ({}, {})",
      rounded_text(loop.greatest_gain, 3), loop.greatest_gain < 1.0 ? ", below 1 at every frequency" : "",
      rounded_text(loop.margin_deg, 3), loop.opamp, loop.role);
  if (loop.ngspice) out += fmt::format("; ngspice {} deg", rounded_text(loop.ngspice->margin_deg, 3));
  return out + "\n";
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

}  // namespace bodesmith::part_errors
