#include <fmt/format.h>

#include "base/text.hpp"
#include "project/report/report_chapters.hpp"
#include "project/run.hpp"
#include "report/page.hpp"
#include "report/plot.hpp"

namespace bodesmith::project {
namespace {

report::Series disturbance_curve(const std::string& name, const Disturbance& disturbance,
                                 Disturbance::Branch branch) {
  report::Series out{name, {}, {}};
  for (int i = 0; i <= 100; ++i) {
    out.x.push_back(i / 100.0);
    out.y.push_back(disturbance.value(branch, out.x.back()));
  }
  return out;
}

void target_of_stage(report::Page& page, const Run& run) {
  const Project::Target& target = run.project.target;
  page.paragraph(fmt::format(
      "The {} disturbance of the stage changes in size with the operating frequency. The compensator's gain is to "
      "follow it through {} measured points, relative to {} Hz, so that the hysteresis that is subtracted is always "
      "as large as the one that is there.",
      to_string(target.branch), target.points.points.size(), rounded_text(target.base.value)));
  report::Table table{{"frequency, Hz", "gain", "dB"}, {}, {}};
  for (const BodePoint& point : target.points.points) {
    table.rows.push_back({rounded_text(point.frequency.value, 6), rounded_text(point.gain, 5),
                          fmt::format("{:.4f}", to_decibel(point.gain))});
  }
  page.table(table);
  report::Plot polynomials;
  polynomials.title = "Full-stroke disturbance d(x)";
  polynomials.x = {"reference x"};
  polynomials.y = {"d, of range"};
  polynomials.height = 280;
  polynomials.series = {disturbance_curve("ascending", target.disturbance, Disturbance::Branch::ascending),
                        disturbance_curve("descending", target.disturbance, Disturbance::Branch::descending)};
  page.plots({polynomials}, "The polynomials of both branches at the base frequency.");
}

void target_of_response(report::Page& page, const Run& run) {
  const Project::Target& target = run.project.target;
  page.paragraph(fmt::format("{}, judged from {}. {}", target.file, span_text(target.band), run.design.how));
  page.plots(
      stages_plots(run.project, run.design),
      "Gain and phase of every stage, and beneath them what each leaves. Beyond the band nothing was asked.");
  if (!target.has_points() || target.points.points.size() > 60) return;
  report::Table table{{"frequency", "target, dB", "sections, dB", "error, dB"}, {}, {}};
  for (const BodePoint& point : target.points.points) {
    const double wanted = to_decibel(point.gain);
    const double got = to_decibel(std::abs(run.design.sections().response(point.frequency.rad_s())));
    table.rows.push_back({hertz_text(point.frequency.value), fmt::format("{:.3f}", wanted),
                          fmt::format("{:.3f}", got), fmt::format("{:+.4f}", got - wanted)});
  }
  page.table(table);
}

}  // namespace

void target_chapter(report::Page& page, const Run& run) {
  page.chapter("Target");
  run.project.plant ? target_of_stage(page, run) : target_of_response(page, run);
}

}  // namespace bodesmith::project
