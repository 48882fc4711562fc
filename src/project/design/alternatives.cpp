#include "project/design/alternatives.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "base/progress.hpp"
#include "fit/direct/direct_fit.hpp"
#include "fit/waveform/waveform_fit.hpp"
#include "numeric/parallel_for.hpp"
#include "project/tracking/tracked_plant.hpp"

namespace bodesmith::project {
namespace {

Alternative rated_alternative(const Project& project, std::string name, Alternative::Kind kind,
                              const Sections& sections) {
  Alternative out;
  out.name = std::move(name);
  out.kind = kind;
  out.sections = sections;
  const auto response = [&sections](RadPerSecond w) { return sections.response(w); };
  out.points_max_db = max_error_at_points(project, response);
  for (const BodePoint& point : project.target.points.points) {
    if (point.frequency <= project.target.base) continue;
    out.phase_at_points_deg =
        std::max(out.phase_at_points_deg, std::abs(to_degrees(std::arg(response(point.frequency.rad_s())))));
  }
  double gain_at_infinity = sections.gain;
  for (const Section& section : sections.sections) gain_at_infinity *= section.high_frequency_gain();
  out.above_band_db = gain_at_infinity == 0.0 ? -INFINITY : to_decibel(gain_at_infinity);
  WaveformErrorOptions options;
  options.path = compensated_path(project);
  out.waveform = waveform_error(response, project.target.disturbance, project.track.frequency, options);
  out.tracked_at_percent = tracked_percents(
      project, compensated_design(project, out.name, sections, tracking::GeneratorForm::self_fed()));
  for (const double percent : out.tracked_at_percent)
    out.tracked_percent = std::max(out.tracked_percent, percent);
  const int poles = sections.pole_count();
  out.fpaa_blocks = poles + poles % 2;
  return out;
}

Alternative direct_alternative(const Project& project, int order) {
  DirectFitOptions options;
  options.order = order;
  options.real = true;
  options.max_corner = Hertz{5.0 * project.target.points.points.back().frequency.value};
  const DirectFit fit = fit_directly(project.target.points, options);
  return rated_alternative(project, fmt::format("direct fit, {} poles", order), Alternative::Kind::direct,
                           fit.sections);
}

Alternative waveform_alternative(const Project& project, int order) {
  WaveformFitOptions options;
  options.order = order;
  options.path = compensated_path(project);
  options.worst = true;
  options.operating = project.track.frequency;
  const WaveformSections fit = fit_waveform_sections(project.target.disturbance, options);
  return rated_alternative(project, fmt::format("waveform fit, {} pole{}", order, order == 1 ? "" : "s"),
                           Alternative::Kind::waveform, fit.sections);
}

}  // namespace

DrivenPath compensated_path(const Project& project) {
  return project.target.branch == Disturbance::Branch::ascending ? DrivenPath::ascending
                                                                 : DrivenPath::descending;
}

double max_error_at_points(const Project& project, const FrequencyResponse& response) {
  double out = 0.0;
  for (const BodePoint& point : project.target.points.points) {
    if (point.frequency <= project.target.base) continue;
    const double got = std::abs(response(point.frequency.rad_s()));
    out = std::max(out, std::abs(to_decibel(got / point.gain)));
  }
  return out;
}

std::vector<Alternative> make_alternatives(const Project& project,
                                           const CascadeApproximation& approximation) {
  std::vector<std::function<Alternative()>> makers;
  makers.emplace_back([&] {
    return rated_alternative(project, "cascade, " + approximation.method, Alternative::Kind::cascade,
                             approximation.sections);
  });
  for (const int order : {2, 3, 4})
    makers.emplace_back([&project, order] { return direct_alternative(project, order); });
  if (!project.target.disturbance.is_static(project.target.branch)) {
    for (const int order : {1, 2, 4})
      makers.emplace_back([&project, order] { return waveform_alternative(project, order); });
  }
  std::vector<Alternative> out(makers.size());
  // The last ones, of the most poles, take longest.
  parallel_for(makers.size(), thread_count(0), [&](std::size_t i) {
    const std::size_t at = makers.size() - 1 - i;
    out[at] = makers[at]();
  });
  stop_if_interrupted();
  return out;
}

std::vector<std::size_t> rank_alternatives(const Project& project,
                                           const std::vector<Alternative>& alternatives) {
  if (project.choice == Project::Choice::as_asked) return {0};
  using Choice = Project::Choice;
  const Choice by = project.choice;
  const double limit = project.limits.points_db.value_or(0.05);
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < alternatives.size(); ++i) {
    if (by != Choice::fewest_sections || alternatives[i].points_max_db <= limit) order.push_back(i);
  }
  if (order.empty()) return {0};
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
    const Alternative& first = alternatives[a];
    const Alternative& second = alternatives[b];
    if (by == Choice::tracking) return first.tracked_percent < second.tracked_percent;
    if (by == Choice::waveform) return first.waveform.worst_percent < second.waveform.worst_percent;
    return first.sections.pole_count() < second.sections.pole_count();
  });
  return order;
}

Band design_band(const Project& project, const std::optional<CascadeFit>& fit, const Sections& sections) {
  if (!project.plant) return project.target.band;
  Band band{project.target.points.points.front().frequency, project.target.points.points.back().frequency};
  const auto widen = [&band](const Band& other) {
    if (!(other.from.value > 0.0) || !(other.to >= other.from)) return;
    band.from = std::min(band.from, other.from);
    band.to = std::max(band.to, other.to);
  };
  if (!fit->cascade.terms.empty()) widen(fit->cascade.corner_band());
  widen(sections.corner_band());
  return band;
}

}  // namespace bodesmith::project
