#include <fmt/format.h>

#include "base/documents/json.hpp"
#include "base/text.hpp"
#include "project/run.hpp"
#include "synthesis/circuit_file.hpp"

namespace bodesmith::project {

std::vector<std::string> FilterRun::shortfalls() const {
  std::vector<std::string> out;
  if (design.circuit) out = design.circuit->best.shortfalls;
  if (!design.no_plan.empty()) out.push_back(design.no_plan);
  return out;
}

std::string FilterRun::summary(const std::filesystem::path& folder) const {
  const std::string band = fmt::format("{} to {}", engineering_text(project.band.from.value, "Hz", 4),
                                       engineering_text(project.band.to.value, "Hz", 4));
  std::string out = fmt::format("{}\ntarget     {}, {}\n           {}\n", project.name, project.target_file,
                                band, design.how);
  if (project.sections) {
    out += fmt::format("sections   {} poles\n", design.sections.pole_count());
  } else {
    out += fmt::format("sections   {} poles, {} dB from the target\n", design.sections.pole_count(),
                       rounded_text(design.target_db, 3));
  }
  if (design.plan) {
    const fpaa::PlanError& runs = design.plan->error_with_delays;
    out += fmt::format("fpaa       {} CAMs, {} % as the board runs\n", design.plan->cams().size(),
                       rounded_text(runs.max_complex_percent, 3));
  } else if (!design.no_plan.empty()) {
    out += "fpaa       NOT made: " + design.no_plan + "\n";
  }
  if (design.circuit) {
    const synthesis::Candidate& best = design.circuit->best;
    out += fmt::format("circuit    {}, {} op-amps, {} dB with parts and op-amps\n", best.how,
                       best.made.circuit.opamps.size(), rounded_text(best.judged.max_magnitude_db, 3));
    for (const std::string& shortfall : best.shortfalls) out += "           NOT met: " + shortfall + "\n";
  }
  if (design.yield) {
    out += fmt::format("tolerances 95 of 100 circuits within {} dB ({} % resistors, {} % capacitors)\n",
                       rounded_text(design.yield->worst_db.quantile(0.95), 3),
                       rounded_text(project.spread.resistor_percent),
                       rounded_text(project.spread.capacitor_percent));
  }
  out += limits_text(limits);
  for (const std::string& one : not_tried) out += "not tried  " + one + "\n";
  return out + fmt::format("look at    {}\n", (folder / "report.html").string());
}

Json FilterRun::json() const {
  Json out;
  out["name"] = project.name;
  out["target"] = project.target_file;
  out["band_hz"] = {project.band.from.value, project.band.to.value};
  out["how"] = design.how;
  out["poles"] = design.sections.pole_count();
  if (!project.sections) out["target_db"] = design.target_db;
  if (design.plan) out["fpaa_percent"] = design.plan->error_with_delays.max_complex_percent;
  if (!design.no_plan.empty()) out["no_plan"] = design.no_plan;
  if (design.circuit) {
    out["circuit"] = {{"realization", design.circuit->best.realisation},
                      {"error", synthesis::to_json(design.circuit->best.judged)},
                      {"shortfalls", design.circuit->best.shortfalls},
                      {"passed_over", design.circuit->passed_over}};
  }
  out["not_tried"] = not_tried;
  if (design.yield) out["yield_db"] = design.yield->worst_db.quantile(0.95);
  out["limits"] = to_json(limits);
  out["files"] = Json::array();
  for (const std::filesystem::path& path : files) out["files"].push_back(path.string());
  out["timing_s"] = {{"compute", compute_s}, {"design", design.compute_s}};
  return out;
}

std::vector<std::pair<std::string, double>> FilterRun::figures() const {
  std::vector<std::pair<std::string, double>> out = {
      {"poles", static_cast<double>(design.sections.pole_count())}};
  if (!project.sections) out.emplace_back("target_db", design.target_db);
  if (design.plan) out.emplace_back("fpaa_percent", design.plan->error_with_delays.max_complex_percent);
  if (design.circuit) out.emplace_back("circuit_db", design.circuit->best.judged.max_magnitude_db);
  if (design.yield) out.emplace_back("yield_db", design.yield->worst_db.quantile(0.95));
  return out;
}

}  // namespace bodesmith::project
