#include "project/whole_way.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/json.hpp"
#include "base/json_header.hpp"
#include "base/progress.hpp"
#include "base/text.hpp"
#include "fpaa/board_picture.hpp"
#include "fpaa/build_sheet.hpp"
#include "kicad/schematic.hpp"
#include "project/report_page.hpp"
#include "signal/csv.hpp"
#include "spice/emit.hpp"
#include "spice/emit_disturbance.hpp"
#include "spice/ngspice.hpp"
#include "yield/circuit_json.hpp"

namespace bodesmith::project {
namespace {
namespace fs = std::filesystem;

std::string json_text(std::string_view name, const WholeWay& way, const Json& body, double seconds) {
  Json json = json_header(name, way.from);
  json.update(body);
  json["timing_s"] = {{"compute", seconds}};
  return to_text(json);
}

/// Every stage's response beside the wanted points' band.
std::string bode_csv(const Design& design, const Budget& budget) {
  const std::vector<Hertz> grid =
      log_grid({Hertz{budget.band.from.value / 10.0}, Hertz{budget.band.to.value * 10.0}}, 241);
  CsvWriter csv;
  std::vector<double> hertz;
  for (const Hertz f : grid) hertz.push_back(f.value);
  csv.add("frequency_hz", hertz);
  for (const DesignStage& stage : design_stages(design)) {
    std::vector<double> db;
    std::vector<double> degrees;
    for (const Hertz f : grid) {
      const std::complex<double> h = stage.response(f.rad_s());
      db.push_back(to_decibel(std::abs(h)));
      degrees.push_back(to_degrees(std::arg(h)));
    }
    std::string name = stage.name;
    std::replace(name.begin(), name.end(), ' ', '_');
    std::replace(name.begin(), name.end(), '-', '_');
    csv.add(name + "_magnitude_db", db);
    csv.add(name + "_phase_deg", degrees);
  }
  return csv.text();
}

/// What is to be built: written before the simulation, which may take long and be interrupted.
OutputSet design_files(const WholeWay& way, const fs::path& folder) {
  OutputSet out(folder);
  const Design& design = way.design;
  out.add("cascade.json", json_text("cascade", way, design.fit.to_json(), design.compute_s));
  const Alternative& chosen = design.alternatives[design.chosen];
  Sections built = chosen.sections;
  if (!built.error) {
    const ApproximationError error = approximation_error(built, design.fit.cascade);
    built.error = Sections::Error{error.band, error.band_db, error.band_deg, error.everywhere_db};
  }
  Json sections = built.to_json();
  sections["made_by"] = chosen.name;
  if (chosen.kind == Alternative::Kind::cascade) sections.update(design.approximation.report_json());
  out.add("sections.json", json_text("sections", way, sections, design.compute_s));
  if (design.plan) {
    out.add("fpaa/plan.json", json_text("fpaa_plan", way, design.plan->to_json(), design.compute_s));
    out.add("fpaa/board.svg", fpaa::board_picture_svg(*design.plan));
    out.add("fpaa/build_sheet.md", fpaa::build_sheet_markdown(*design.plan));
    out.add("fpaa/build_sheet.html", fpaa::build_sheet_html(*design.plan));
  }
  if (design.circuit) {
    OutputSet spice;
    add_spice_files(*design.circuit, way.project.name, spice);
    add_kicad_files(design.circuit->circuit, way.project.name, spice);
    out.include("spice", spice);
    out.add("spice/circuit.json", json_text("circuit", way, to_json(*design.circuit), design.compute_s));
  }
  out.add("layout/layout.json", json_text("layout", way, design.layout.to_json(), design.compute_s));
  out.add("layout/disturbance.sub", disturbance_library(design.layout, way.project.name));
  if (design.layout.amplitude) {
    out.add("layout/disturbance_amplitude.sub",
            disturbance_library(design.layout, way.project.name, {true, std::nullopt}));
  }
  out.add("layout/disturbance.svg", layout_drawing(design.layout));
  out.add("bode.csv", bode_csv(design, way.budget));
  out.add("bode.svg", stages_svg(way.project, design, way.budget));
  return out;
}

void list_files(WholeWay& way, const OutputSet& out) {
  for (const fs::path& path : out.paths()) way.files.push_back(path);
}

Json waveform_json(const WaveformError& error) {
  return {{"rms_percent", error.rms_percent}, {"worst_percent", error.worst_percent}};
}

}  // namespace

bool WholeWay::limits_met() const {
  return std::all_of(limits.begin(), limits.end(), [](const LimitCheck& check) { return check.met(); });
}

Json WholeWay::summary_json() const {
  Json out;
  out["name"] = project.name;
  out["limits"] = Json::array();
  for (const LimitCheck& check : limits) {
    out["limits"].push_back(
        {{"name", check.name}, {"limit", check.limit}, {"got", check.got}, {"met", check.met()}});
  }
  out["alternatives"] = Json::array();
  for (size_t i = 0; i < design.alternatives.size(); ++i) {
    const Alternative& a = design.alternatives[i];
    Json item = {{"name", a.name},
                 {"built", i == design.chosen},
                 {"poles", a.sections.pole_count()},
                 {"points_max_db", a.points_max_db},
                 {"phase_at_points_deg", a.phase_at_points_deg},
                 {"waveform", waveform_json(a.waveform)},
                 {"fpaa_blocks", a.fpaa_blocks}};
    if (std::isfinite(a.above_band_db)) item["above_band_db"] = a.above_band_db;
    out["alternatives"].push_back(std::move(item));
  }
  out["passed_over"] = design.passed_over;
  out["budget"] = Json::array();
  for (const BudgetRow& row : budget.rows) {
    out["budget"].push_back({{"stage", row.stage},
                             {"against", row.previous},
                             {"max_magnitude_db", row.against_previous.max_magnitude_db},
                             {"max_phase_deg", row.against_previous.max_phase_deg},
                             {"max_complex_percent", row.against_previous.max_complex_percent},
                             {"points_max_db", row.points_max_db},
                             {"waveform", waveform_json(row.waveform)}});
  }
  out["waveform_without_rate_compensation"] = waveform_json(budget.uncompensated);
  out["waveform_best_constant_gain"] = waveform_json(budget.constant);
  out["best_constant_gain"] = budget.constant_gain;
  if (ngspice) {
    out["ngspice"] = {{"against_network_db", ngspice->against_network.max_magnitude_db},
                      {"against_sections_db", ngspice->against_sections.max_magnitude_db},
                      {"band_hz", {ngspice->band.from.value, ngspice->band.to.value}}};
  } else {
    out["ngspice"] = nullptr;
  }
  out["tracking"] = tracking.to_json();
  out["files"] = Json::array();
  for (const fs::path& path : files) out["files"].push_back(path.string());
  out["timing_s"] = {{"compute", compute_s},
                     {"design", design.compute_s},
                     {"alternatives", design.alternatives_s},
                     {"tracking", tracking.compute_s}};
  return out;
}

std::string WholeWay::summary_text() const {
  std::string out = project.name + "\n";
  if (design.fit.cascade.fit) {
    out += fmt::format("cascade    {} terms, largest miss at the points {:.1e} dB\n",
                       design.fit.cascade.terms.size(), design.fit.cascade.fit->max_db);
  }
  const Alternative& chosen = design.alternatives[design.chosen];
  if (chosen.kind == Alternative::Kind::cascade) {
    out += fmt::format("sections   {} poles, {} dB from the cascade at every frequency\n",
                       design.approximation.sections.pole_count(),
                       rounded_text(design.approximation.error.everywhere_db, 3));
  } else {
    out += fmt::format("sections   {}: {} dB at the points\n", chosen.name,
                       rounded_text(chosen.points_max_db, 3));
  }
  out +=
      "           alternatives: poles, dB at the points, waveform error in % of range (worst), gain above "
      "the band\n";
  for (size_t i = 0; i < design.alternatives.size(); ++i) {
    const Alternative& a = design.alternatives[i];
    out += fmt::format("         {} {:<22} {:>2} {:>9} {:>7.3f} {:>7.2f} dB\n",
                       i == design.chosen ? "*" : " ", a.name, a.sections.pole_count(),
                       rounded_text(a.points_max_db, 2), a.waveform.worst_percent, a.above_band_db);
  }
  for (const std::string& reason : design.passed_over) out += "           cannot be built: " + reason + "\n";
  if (design.plan) {
    out +=
        fmt::format("fpaa       {} CAMs at {} Hz, worst complex error {} % ({} % with holds and delays)\n",
                    design.plan->cams().size(), rounded_text(design.plan->cams().front()->clock_a.value, 6),
                    rounded_text(design.plan->error.max_complex_percent, 3),
                    rounded_text(design.plan->error_with_delays.max_complex_percent, 3));
  }
  if (design.circuit) {
    out += fmt::format("circuit    {} stages, {} dB by its parts", design.circuit->circuit.stages.size(),
                       rounded_text(design.circuit->report.parts.max_magnitude_db, 3));
    out += ngspice ? fmt::format(", ngspice {} dB from the sections\n",
                                 rounded_text(ngspice->against_sections.max_magnitude_db, 3))
                   : std::string(", not run: ngspice is not installed\n");
  }
  out += fmt::format("layout     {} multipliers, d within {} % of range\n", design.layout.multipliers.size(),
                     rounded_text(design.layout.max_error_percent, 3));
  out += "tracking   rms error, % of range, at";
  for (const Hertz f : tracking.frequency) out += fmt::format(" {:>8}", rounded_text(f.value));
  out += " Hz\n";
  for (const TrackedDesign& tracked : tracking.designs) {
    out += fmt::format("  {:<35}", tracked.name);
    for (const double value : tracked.rms_percent) out += fmt::format(" {:>8.3f}", value);
    out += "\n";
  }
  for (const std::string& finding : tracking.findings) out += "note: " + finding + "\n";
  for (const LimitCheck& check : limits) {
    out += fmt::format("limit      {} {}: {} {}\n", check.name, rounded_text(check.limit),
                       rounded_text(check.got, 3), check.met() ? "met" : "MISSED");
  }
  out += "report     report.html\n";
  return out;
}

WholeWay go_the_whole_way(const fs::path& project_file, const fs::path& folder) {
  const Stopwatch watch;
  Progress progress("run");
  WholeWay way;
  way.project = Project::read(project_file, way.from);
  try {
    way.design = make_design(way.project);
  } catch (const DesignError& error) {
    throw DesignError(project_file.string() + ": " + error.what());
  }
  progress.at(0.1);
  way.budget = make_budget(way.project, way.design);
  way.limits = check_limits(way.project, way.design);
  OutputSet built = design_files(way, folder);
  built.commit();
  list_files(way, built);
  progress.at(0.2);

  if (way.design.circuit && ngspice_available()) {
    way.ngspice = check_with_ngspice(way.design.circuit->circuit, way.design.sections());
  }
  stop_if_interrupted();
  progress.at(0.4);
  way.tracking = study_tracking(way.project, way.design, way.budget);
  progress.at(0.9);
  way.compute_s = watch.seconds();

  OutputSet studied(folder);
  studied.add("tracking.csv", way.tracking.csv());
  const ReportInput input{way.project, way.design,  way.budget, way.tracking,
                          way.limits,  way.ngspice, way.from};
  studied.add("report.html", report_page(input));
  list_files(way, studied);
  way.files.emplace_back("run.json");
  Json run = json_header("run", way.from);
  run.update(way.summary_json());
  studied.add("run.json", to_text(run));
  studied.commit();
  return way;
}

}  // namespace bodesmith::project
