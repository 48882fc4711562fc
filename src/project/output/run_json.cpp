#include <cmath>

#include "base/documents/json.hpp"
#include "project/run.hpp"
#include "synthesis/circuit_file.hpp"

namespace bodesmith::project {
namespace {

Json waveform_json(const WaveformError& error) {
  return {{"rms_percent", error.rms_percent}, {"worst_percent", error.worst_percent}};
}

Json budget_json(const Budget& budget) {
  Json out = Json::array();
  for (const BudgetRow& row : budget.rows) {
    out.push_back({{"stage", row.stage},
                   {"against", row.previous},
                   {"max_magnitude_db", row.against_previous.max_magnitude_db},
                   {"max_phase_deg", row.against_previous.max_phase_deg},
                   {"max_complex_percent", row.against_previous.max_complex_percent},
                   {"points_max_db", row.points_max_db},
                   {"waveform", waveform_json(row.waveform)}});
  }
  return out;
}

Json finite_or_null(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

/// What the alternative becomes on the board and in parts; null where it cannot be made there, or was not asked for.
Json hardware_json(const Design& design) {
  Json out = {{"fpaa", nullptr}, {"circuit", nullptr}};
  if (design.plan) {
    out["fpaa"] = {{"cams", design.plan->cams().size()},
                   {"max_complex_percent_with_delays", design.plan->error_with_delays.max_complex_percent}};
  }
  if (design.circuit) {
    const synthesis::Realised& made = design.realised();
    out["circuit"] = {{"opamps", made.circuit.opamps.size()},
                      {"parts", made.circuit.parts.size()},
                      {"max_magnitude_db", made.report.all.max_magnitude_db}};
  }
  return out;
}

Json alternatives_json(const Run& run) {
  const Design& design = run.design;
  Json out = Json::array();
  for (std::size_t i = 0; i < design.alternatives.size(); ++i) {
    const Alternative& a = design.alternatives[i];
    Json item = {{"name", a.name},
                 {"built", i == design.chosen},
                 {"poles", a.sections.pole_count()},
                 {"points_max_db", a.points_max_db},
                 {"phase_at_points_deg", a.phase_at_points_deg},
                 {"waveform", waveform_json(a.waveform)},
                 {"tracked_percent", finite_or_null(a.tracked_percent)},
                 {"fpaa_blocks", a.fpaa_blocks}};
    if (std::isfinite(a.above_band_db)) item["above_band_db"] = a.above_band_db;
    item["tracked_at_percent"] = Json::array();
    for (const double percent : a.tracked_at_percent)
      item["tracked_at_percent"].push_back(finite_or_null(percent));
    const AlternativeStudy& study = run.alternatives[i];
    item["hardware"] = hardware_json(study.design);
    item["refused"] = study.refused;
    item["budget"] = budget_json(study.budget);
    out.push_back(std::move(item));
  }
  return out;
}

Json ngspice_json(const std::optional<synthesis::CompensatorCheck>& check) {
  if (!check) return nullptr;
  return {{"against_network_db", check->against_network.max_magnitude_db},
          {"against_sections_db", check->against_sections.max_magnitude_db},
          {"band_hz", {check->band.from.value, check->band.to.value}}};
}

void add_target(const Run& run, Json& out) {
  const Project::Target& target = run.project.target;
  out["target"] = target.file;
  out["band_hz"] = {target.band.from.value, target.band.to.value};
  out["how"] = run.design.how;
}

void add_plant(const Run& run, Json& out) {
  out["alternatives"] = alternatives_json(run);
  out["passed_over"] = run.design.passed_over;
  out["budget"] = budget_json(run.budget);
  out["waveform_without_rate_compensation"] = waveform_json(run.budget.uncompensated);
  out["waveform_best_constant_gain"] = waveform_json(run.budget.constant);
  out["best_constant_gain"] = run.budget.constant_gain;
  out["ngspice"] = ngspice_json(run.ngspice);
  out["tracking"] = to_json(run.tracking);
}

}  // namespace

Json Run::json() const {
  Json out;
  out["name"] = project.name;
  if (!project.plant) add_target(*this, out);
  for (const auto& [key, value] : figures()) out[key] = value;
  out["poles"] = design.sections().pole_count();
  if (!design.no_plan.empty()) out["no_plan"] = design.no_plan;
  if (design.circuit) {
    out["circuit"] = {{"realization", design.circuit->best.realisation},
                      {"error", synthesis::to_json(design.circuit->best.judged)},
                      {"shortfalls", design.circuit->best.shortfalls},
                      {"passed_over", design.circuit->passed_over}};
  }
  out["limits"] = to_json(limits);
  if (project.plant) add_plant(*this, out);
  out["not_tried"] = not_tried;
  out["files"] = Json::array();
  for (const std::filesystem::path& path : files) out["files"].push_back(path.string());
  Json& timing = out["timing_s"] = {{"compute", compute_s}, {"design", design.compute_s}};
  if (project.plant) {
    timing["alternatives"] = design.alternatives_s;
    timing["tracking"] = tracking.compute_s;
  }
  return out;
}

std::vector<std::pair<std::string, double>> Run::figures() const {
  const Alternative& built = design.built();
  std::vector<std::pair<std::string, double>> out = {
      {"poles", static_cast<double>(built.sections.pole_count())}};
  if (!project.target.sections)
    out.emplace_back(project.plant ? "points_db" : "target_db", built.points_max_db);
  if (design.plan) out.emplace_back("fpaa_percent", design.plan->error_with_delays.max_complex_percent);
  if (design.circuit) out.emplace_back("circuit_db", design.circuit->best.judged.max_magnitude_db);
  if (const TrackedDesign* tracked = tracking.find(tracking.as_built))
    out.emplace_back("tracking_percent", tracked->worst_without_lag_percent());
  if (design.yield) out.emplace_back("yield_db", design.yield->worst_db.quantile(0.95));
  return out;
}

}  // namespace bodesmith::project
