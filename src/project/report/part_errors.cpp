#include <fmt/format.h>

#include <algorithm>
#include <span>

#include "base/text.hpp"
#include "project/run.hpp"
#include "report/page.hpp"

namespace bodesmith::project {
namespace {

report::Table spread_table(const tolerance::TrimStudy& trims, const std::vector<Hertz>& frequencies) {
  report::Table table{{"frequency, Hz", "nominal", "untrimmed, half below", "95 % below",
                       "trimmed, half below", "95 % below"},
                      {},
                      {}};
  for (std::size_t i = 0; i < frequencies.size() && i < trims.after_at.size(); ++i) {
    const tolerance::ErrorSpread &before = trims.before_at[i], &after = trims.after_at[i];
    table.rows.push_back({rounded_text(frequencies[i].value), rounded_text(before.nominal_percent, 2),
                          rounded_text(before.median_percent, 2), rounded_text(before.p95_percent, 2),
                          rounded_text(after.median_percent, 2), rounded_text(after.p95_percent, 2)});
  }
  return table;
}

report::Table share_table(const std::vector<tolerance::Share>& parts) {
  report::Table table{{"part", "share of the variance, %", "adds at one standard deviation, %"}, {}, {}};
  for (const tolerance::Share& part : std::span(parts).first(std::min<std::size_t>(parts.size(), 8))) {
    table.rows.push_back({part.name, rounded_text(100.0 * part.share, 2), rounded_text(part.rms_percent, 2)});
  }
  return table;
}

std::string stability_sentence(const generator::LoopStability& loop) {
  if (loop.at.empty()) return "The op-amps are ideal: the stability of the loop was not looked at.";
  std::string out = fmt::format(
      "The generator's loop has a gain of at most {}{}. The least phase margin of an op-amp with all its feedback is {}° "
      "({}, {})",
      rounded_text(loop.greatest_gain, 3), loop.greatest_gain < 1.0 ? ", below 1 at every frequency" : "",
      rounded_text(loop.margin_deg, 3), loop.opamp, loop.role);
  if (loop.ngspice) out += fmt::format(", {}° by ngspice", rounded_text(loop.ngspice->margin_deg, 3));
  return out + ".";
}

}  // namespace

void part_errors_chapter(report::Page& page, const Run& run) {
  if (!run.part_errors) return;
  const tolerance::ControllerReport& report = *run.part_errors;
  page.chapter("Errors of the controller's parts");
  page.paragraph(fmt::format(
      "{} copies of the analog controller with parts drawn at random (what is assumed: controller.json, errors_of_parts). "
      "Tracking error of the stage that reads its drive along a triangle, percent of range, lag removed.",
      report.study.draws));
  page.table(spread_table(report.trims, report.study.frequencies),
             "Copies as they are built, and trimmed blind by the steps of controller/trim.md");
  page.table(share_table(report.study.parts), "Parts that matter most, untrimmed");
  page.paragraph(stability_sentence(report.loop));
  if (const std::string warning = generator::loop_warning(report.loop); !warning.empty())
    page.warning(warning);
}

}  // namespace bodesmith::project
