#include "project/sweep/sweep_figures.hpp"

namespace bodesmith::project {

SweepFigures sweep_figures(const ProjectRun& run) {
  const Alternative& built = run.design.built();
  SweepFigures out = {{"poles", static_cast<double>(built.sections.pole_count())},
                      {"points_db", built.points_max_db}};
  if (run.design.plan)
    out.emplace_back("fpaa_percent", run.design.plan->error_with_delays.max_complex_percent);
  if (run.design.circuit) out.emplace_back("circuit_db", run.design.circuit->report.parts.max_magnitude_db);
  if (const TrackedDesign* tracked = run.tracking.find(run.tracking.as_built))
    out.emplace_back("tracking_percent", tracked->worst_without_lag_percent());
  return out;
}

SweepFigures sweep_figures(const FilterRun& run) {
  const FilterDesign& design = run.design;
  SweepFigures out = {{"poles", static_cast<double>(design.sections.pole_count())}};
  if (!run.project.sections) out.emplace_back("target_db", design.target_db);
  if (design.plan) out.emplace_back("fpaa_percent", design.plan->error_with_delays.max_complex_percent);
  if (design.circuit) out.emplace_back("circuit_db", design.circuit->best.judged.max_magnitude_db);
  if (design.yield) out.emplace_back("yield_db", design.yield->worst_db.quantile(0.95));
  return out;
}

}  // namespace bodesmith::project
