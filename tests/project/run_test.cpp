// Whole runs, in this process: what they say is worked out again from the files they wrote and from functions of other rooms.
#include "project/run.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "base/documents/document.hpp"
#include "base/documents/json.hpp"
#include "base/files.hpp"
#include "base/text.hpp"
#include "chain/chain.hpp"
#include "chain/model_file.hpp"
#include "lti/sections.hpp"
#include "project/tracking/tracked_plant.hpp"
#include "schematic/analysis/response.hpp"
#include "schematic/ngspice/ngspice.hpp"
#include "signal/csv.hpp"
#include "synthesis/circuit_file.hpp"
#include "temporary_folder.hpp"

namespace bodesmith::project {
namespace {

using ::testing::HasSubstr;
using Complex = std::complex<double>;

double level_db(Complex h) {
  return 20.0 * std::log10(std::abs(h));
}

/// A project's run, once for all tests of its suite.
class Ran {
 public:
  Ran(const std::string& text, const std::map<std::string, std::string>& files) {
    for (const auto& [name, content] : files) write_file(folder_ / name, content);
    write_file(folder_ / "project.toml", "schema = \"bodesmith.project/1\"\n" + text);
    run_ = run_project(ProjectSource::read(folder_ / "project.toml"), folder_ / "out");
  }
  const Run& operator*() const { return run_; }
  const Run* operator->() const { return &run_; }
  std::filesystem::path path(const std::string& name) const { return folder_ / "out" / name; }
  std::string text(const std::string& name) const { return read_file(path(name)); }
  Csv csv(const std::string& name) const { return Csv::parse(text(name), name); }
  Sections sections() const {
    Provenance from;
    return Sections::read(path("sections.json"), from);
  }

 private:
  TemporaryFolder folder_;
  Run run_;
};

/// The nanopositioner's stage and two frequencies, along triangles and sines.
const Ran& stage() {
  static const Ran made = [] {
    const std::string example = std::string(BODESMITH_SOURCE_DIR) + "/examples/nanopositioner/";
    return Ran(
        "name = \"two frequencies\"\n"
        "[target]\npoints = \"gains.csv\"\ndisturbance = \"disturbance.json\"\n"
        "[approximate]\nmax_error_db = 0.04\n[hardware.fpaa]\nclock_hz = 2000.0\n[hardware.circuit]\nresistors = \"E96\"\n"
        "[plant]\nstroke_m = 6.92e-6\namplifier_corner_hz = 100e3\nresonance_hz = 65.1e3\ndamping_ratio = 0.1206\n"
        "damping_compensator = { gain = 0.86, zeros = [9.854e4, 1.67e11], poles = [1.917e5, 1.436e11] }\n"
        "[track]\nwaveform = [\"triangle\", \"sine\"]\nfrequency_hz = [20, 100]\n"
        "measured_percent = [0.56, 0.57]\n"
        "[limits]\nfit_db = 1e-6\npoints_db = 9\napproximation_db = 0.04\nfpaa_percent = 90\ncircuit_db = 0.05\n"
        "tracking_percent = 0.05\n",
        {{"gains.csv", read_file(example + "gains.csv")},
         {"disturbance.json", read_file(example + "disturbance.json")}});
  }();
  return made;
}

/// One period's drive, several times over: the reference itself, uncompensated.
class AsAsked : public tracking::BuiltController {
 public:
  explicit AsAsked(std::size_t repeats) : repeats_(repeats) {}
  std::string key() const override { return "as_asked"; }
  std::string name() const override { return key(); }
  int part_count() const override { return 0; }
  tracking::DriveWaveform drive(const tracking::Reference& reference, Hertz operating) const override {
    const std::vector<double> one = reference.samples(4096);
    tracking::DriveWaveform out{{}, static_cast<double>(reference.periods()) / operating.value / 4096.0};
    for (std::size_t i = 0; i < repeats_; ++i) out.v.insert(out.v.end(), one.begin(), one.end());
    return out;
  }

 private:
  std::size_t repeats_;
};

TrackedDesign uncompensated(const tracking::Stage& stage, const tracking::Reference& reference,
                            const std::vector<Hertz>& frequencies, std::size_t repeats) {
  const AsAsked drive(repeats);
  std::vector<tracking::DriveWaveform> drives;
  for (const Hertz f : frequencies) drives.push_back(drive.drive(reference, f));
  return tracked_controller(drive, stage, reference, frequencies, drives);
}

TEST(WholeRun, ErrorsOfItsStagesAreThoseOfItsFiles) {
  const project::Run& run = *stage();
  const Sections sections = stage().sections();
  const auto cascade = [&](RadPerSecond w) { return run.design.fit->cascade.response(w); };
  std::vector<std::string> names;
  for (const BudgetRow& row : run.budget.rows) names.push_back(row.stage + "<" + row.previous);
  EXPECT_THAT(names,
              ::testing::ElementsAre("cascade<", "sections<cascade", "fpaa<sections", "fpaa with holds<fpaa",
                                     "circuit<sections", "circuit with op-amps<circuit"));
  double db = 0.0, degrees = 0.0, percent = 0.0;
  const Band band = run.budget.band;
  for (int i = 0; i <= 4000; ++i) {
    const RadPerSecond w =
        Hertz{band.from.value * std::pow(band.to.value / band.from.value, i / 4000.0)}.rad_s();
    const Complex ratio = sections.response(w) / cascade(w);
    db = std::max(db, std::abs(level_db(ratio)));
    degrees = std::max(degrees, std::abs(std::arg(ratio)) * 180.0 / M_PI);
    percent = std::max(percent, 100.0 * std::abs(ratio - 1.0));
  }
  const ResponseDifference& stated = run.budget.rows[1].against_previous;
  EXPECT_NEAR(stated.max_magnitude_db, db, 0.01 * db);
  EXPECT_NEAR(stated.max_phase_deg, degrees, 0.01 * degrees);
  EXPECT_NEAR(stated.max_complex_percent, percent, 0.01 * percent);
  // The board as designed and as it runs, the parts and their op-amps: as their own files state it.
  const auto complex_percent = [&](std::size_t row) {
    return run.budget.rows[row].against_previous.max_complex_percent;
  };
  const double board = run.design.plan->error_with_delays.max_complex_percent;
  EXPECT_LE(board, 1.01 * (complex_percent(2) + complex_percent(3)));
  EXPECT_GE(board, 0.99 * std::abs(complex_percent(2) - complex_percent(3)));
  EXPECT_NEAR(run.budget.rows[4].against_previous.max_magnitude_db,
              run.design.realised().report.all.max_magnitude_db, 2e-3);
  if (run.ngspice) {
    EXPECT_LT(run.ngspice->against_network.max_magnitude_db, 1e-3);
  }
  // bode.csv has a decade on either side.
  const Csv bode = stage().csv("bode.csv");
  const std::vector<double> hz = bode.column("frequency_hz");
  EXPECT_NEAR(hz.front(), 0.1 * band.from.value, 1e-6 * hz.front());
  EXPECT_NEAR(hz.back(), 10.0 * band.to.value, 1e-6 * hz.back());
  for (std::size_t i = 0; i < hz.size(); ++i) {
    EXPECT_NEAR(bode.column("sections_magnitude_db")[i], level_db(sections.response(Hertz{hz[i]}.rad_s())),
                1e-4);
    EXPECT_NEAR(bode.column("cascade_magnitude_db")[i], level_db(cascade(Hertz{hz[i]}.rad_s())), 1e-4);
  }
}

TEST(WholeRun, TheBestConstantGainIsBestAndNoCompensationIsAGainOfOne) {
  const project::Run& run = *stage();
  WaveformErrorOptions options;
  options.path = DrivenPath::descending;
  const auto waveform = [&](double gain) {
    return waveform_error([gain](RadPerSecond) { return Complex(gain); }, run.project.target.disturbance,
                          run.project.track.frequency, options);
  };
  const double best = waveform(run.budget.constant_gain).rms_percent;
  EXPECT_NEAR(run.budget.constant.rms_percent, best, 1e-9);
  for (const double other : {0.99, 1.01})
    EXPECT_GT(waveform(run.budget.constant_gain * other).rms_percent, best);
  EXPECT_NEAR(run.budget.uncompensated.worst_percent, waveform(1.0).worst_percent, 1e-9);
  const auto worst = [&](std::size_t row) { return run.budget.rows[row].waveform.worst_percent; };
  EXPECT_EQ(run.budget.magnitude_only_is_worse, worst(0) > run.budget.uncompensated.worst_percent);
  const Sections sections = stage().sections();
  EXPECT_NEAR(worst(1),
              waveform_error([&](RadPerSecond w) { return sections.response(w); },
                             run.project.target.disturbance, run.project.track.frequency, options)
                  .worst_percent,
              1e-6);
}

TEST(WholeRun, AlternativesAreWhatTheirSectionsSay) {
  const project::Run& run = *stage();
  EXPECT_EQ(run.design.alternatives.size(), 7U);
  ASSERT_EQ(run.alternatives.size(), 7U);
  std::set<std::string> names;
  for (std::size_t i = 0; i < run.design.alternatives.size(); ++i) {
    const Alternative& one = run.design.alternatives[i];
    SCOPED_TRACE(one.name);
    names.insert(one.name);
    double db = 0.0, degrees = 0.0;
    for (const BodePoint& point : run.project.target.points.points) {
      if (point.frequency.value <= 1.0) continue;
      const Complex h = one.sections.response(point.frequency.rad_s());
      db = std::max(db, std::abs(level_db(h / point.gain)));
      degrees = std::max(degrees, std::abs(std::arg(h)) * 180.0 / M_PI);
    }
    EXPECT_NEAR(one.points_max_db, db, 1e-9);
    EXPECT_NEAR(one.phase_at_points_deg, degrees, 1e-9);
    EXPECT_NEAR(one.above_band_db, level_db(one.sections.response(Hertz{1e9}.rad_s())), 1e-3);
    EXPECT_EQ(one.fpaa_blocks % 2, 0);
    EXPECT_GE(one.fpaa_blocks, one.sections.pole_count());
    EXPECT_LE(one.fpaa_blocks, one.sections.pole_count() + 1);
    EXPECT_EQ(one.tracked_percent, std::ranges::max(one.tracked_at_percent));
    EXPECT_EQ(one.tracked_at_percent.size(), 2U);
    // Each as it would be built, beside the one that is.
    const AlternativeStudy& study = run.alternatives[i];
    EXPECT_EQ(study.design.chosen, i);
    EXPECT_EQ(study.design.plan.has_value() && study.design.circuit.has_value(), study.refused.empty());
    EXPECT_EQ(study.budget.rows.size(),
              2U + (study.design.plan ? 2U : 0U) + (study.design.circuit ? 2U : 0U));
    EXPECT_EQ(study.budget.rows[0].waveform.worst_percent, run.budget.rows[0].waveform.worst_percent);
    EXPECT_NEAR(study.budget.rows[1].points_max_db, one.points_max_db, 1e-9);
    EXPECT_NEAR(study.budget.rows[1].waveform.worst_percent, one.waveform.worst_percent, 1e-6);
    if (study.refused.empty() && i != run.design.chosen) {
      EXPECT_GE(one.tracked_percent, run.design.built().tracked_percent) << "better than what was built";
    }
  }
  EXPECT_EQ(names.size(), 7U);
}

TEST(WholeRun, WithoutCompensationTheStageIsItsOwnLoops) {
  const project::Run& run = *stage();
  const tracking::Reference triangle(tracking::Reference::Shape::triangle, 1.0);
  const TrackedDesign* none = run.tracking.find(tracked::none);
  ASSERT_NE(none, nullptr);
  const tracking::PolynomialStage own = own_stage(run.project);
  const std::vector<Hertz>& frequencies = run.tracking.frequency;
  const TrackedDesign once = uncompensated(own, triangle, frequencies, 1);
  const TrackedDesign thrice = uncompensated(own, triangle, frequencies, 3);
  for (std::size_t i = 0; i < frequencies.size(); ++i) {
    EXPECT_NEAR(none->at[i].rms_percent, once.at[i].rms_percent, 0.01);
    EXPECT_NEAR(none->at[i].rms_percent_without_lag, once.at[i].rms_percent_without_lag, 0.01);
    EXPECT_NEAR(thrice.at[i].rms_percent, once.at[i].rms_percent, 1e-6);
    EXPECT_NEAR(thrice.at[i].lag_s, once.at[i].lag_s, 1e-3 / frequencies[i].value);
  }
  // Along sines, on the same polynomials.
  std::set<std::string> stages;
  int compared = 0;
  for (const TrackedElsewhere& one : run.tracking.elsewhere) {
    stages.insert(one.stage);
    const bool main = one.waveform == tracking::Reference::Shape::triangle && one.amplitude == 1.0;
    EXPECT_FALSE(main && one.stage.starts_with("polynomial"));
    EXPECT_EQ(one.fit_percent.empty(), one.stage.starts_with("polynomial"));
    for (const double percent : one.fit_percent) EXPECT_LT(percent, 2.0) << one.stage;
    for (const TrackedDesign& design : one.designs)
      EXPECT_EQ(design.built, design.key.starts_with("controller_") &&
                                  (design.key != "controller_cvode" || !ngspice::is_available()))
          << design.key;
    if (one.stage != "polynomial") continue;
    tracking::PolynomialStage::Options options;
    options.alpha = one.amplitude;
    const tracking::PolynomialStage like(run.project.target.disturbance, tracking_plant(run.project).paths(),
                                         options);
    const TrackedDesign wanted =
        uncompensated(like, tracking::Reference(one.waveform, one.amplitude), frequencies, 1);
    const auto found = std::ranges::find(one.designs, std::string(tracked::none), &TrackedDesign::key);
    ASSERT_NE(found, one.designs.end());
    ++compared;
    for (std::size_t i = 0; i < frequencies.size(); ++i)
      EXPECT_NEAR(found->at[i].rms_percent, wanted.at[i].rms_percent, 0.02) << to_string(one.waveform);
  }
  EXPECT_EQ(compared, 1);
  EXPECT_THAT(stages, ::testing::ElementsAre("bouc_wen", "polynomial", "polynomial_nested",
                                             "prandtl_ishlinskii", "preisach"));
  // What was built leaves far less, on the stage it was made for and on others.
  const TrackedDesign& built = *run.tracking.find(run.tracking.as_built);
  EXPECT_LT(built.worst_without_lag_percent(), 0.02 * none->worst_without_lag_percent());
  for (const TrackedDesign& design : run.tracking.designs) {
    if (design.built) {
      EXPECT_GE(1.01 * design.worst_without_lag_percent(), built.worst_without_lag_percent()) << design.key;
    }
  }
}

TEST(WholeRun, EnginesThatShareNothingAgree) {
  const std::vector<EngineRow>& rows = stage()->tracking.engines;
  ASSERT_EQ(rows.size(), 4U);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    SCOPED_TRACE(rows[i].what);
    EXPECT_EQ(rows[i].cvode_percent.has_value(), i < 2) << "a board is no ODE";
    ASSERT_TRUE(rows[i].closed_form_percent);
    if (i == 1) {
      EXPECT_NEAR(*rows[i].cvode_percent, *rows[i].closed_form_percent, 0.01);
    }
    if (!ngspice::is_available()) {
      EXPECT_THAT(rows[i].missing, HasSubstr("ngspice is not installed"));
      continue;
    }
    EXPECT_LT(*rows[i].agreement_percent, i < 2 ? 0.02 : 0.01);
    EXPECT_GT(*rows[i].agreement_percent, 0.0);
    // ngspice runs a board at its highest frequencies alone.
    const double closed = *rows[i].closed_form_percent, spice = *rows[i].ngspice_percent;
    if (i > 0) {
      EXPECT_NEAR(spice, closed, 0.01 + 0.02 * closed);
    }
    if (i > 1) {
      EXPECT_THAT(rows[i].missing, HasSubstr("from edge to edge"));
    }
  }
}

TEST(WholeRun, LimitsFiguresAndFilesSayOneThing) {
  const project::Run& run = *stage();
  std::map<std::string, double> got;
  for (const LimitCheck& check : run.limits) got[check.name] = *check.got;
  std::map<std::string, double> figures;
  for (const auto& [name, value] : run.figures()) figures[name] = value;
  const Node json = parse_json(stage().text("run.json"), "run.json");
  EXPECT_EQ(got.size(), 6U);
  EXPECT_LT(got["fit_db"], 1e-9);
  EXPECT_EQ(got["approximation_db"], run.design.approximation->error.everywhere_db);
  for (const std::string name : {"points_db", "fpaa_percent", "circuit_db", "tracking_percent"}) {
    EXPECT_EQ(got[name], figures[name]) << name;
    EXPECT_NEAR(json.at(name).number(), figures[name], 1e-12 * figures[name]) << name;
    EXPECT_THAT(stage().text("summary.txt"), HasSubstr(rounded_text(figures[name], 3))) << name;
    EXPECT_THAT(stage().text("report.html"), HasSubstr(rounded_text(figures[name], 3))) << name;
  }
  EXPECT_EQ(figures["poles"], stage().sections().pole_count());
  EXPECT_TRUE(run.limits_met());
  const Csv table = stage().csv("tracking.csv");
  const Node tracking = json.at("tracking");
  EXPECT_EQ(tracking.at("designs").size(), run.tracking.designs.size());
  for (const Node& design : tracking.at("designs").items()) {
    const TrackedDesign& one = *run.tracking.find(design.at("key").string());
    for (std::size_t i = 0; i < run.tracking.frequency.size(); ++i) {
      EXPECT_NEAR(table.column(one.key + "_percent")[i], one.at[i].rms_percent, 1e-5 * one.at[i].rms_percent);
      EXPECT_NEAR(table.column(one.key + "_without_lag_percent")[i], one.at[i].rms_percent_without_lag, 1e-6);
      EXPECT_NEAR(design.at("lag_s").numbers()[i], one.at[i].lag_s, 1e-9);
      EXPECT_NEAR(design.at("max_percent").numbers()[i], one.at[i].max_percent, 1e-6);
    }
  }
  std::size_t lines = 0;
  for (const TrackedElsewhere& one : run.tracking.elsewhere) lines += one.designs.size() * 2;
  const std::string elsewhere = stage().text("tracking_stages.csv");
  EXPECT_EQ(static_cast<std::size_t>(std::ranges::count(elsewhere, '\n')), lines + 1);
  for (const Node& file : json.at("files").items())
    EXPECT_TRUE(std::filesystem::is_regular_file(stage().path(file.string()))) << file.string();
  EXPECT_FALSE(std::filesystem::exists(stage().path("UNFINISHED.txt")));
  for (const Alternative& one : run.design.alternatives)
    EXPECT_THAT(stage().text("report.html"), HasSubstr(one.name));
}

// With no time at all the design stands, and all that was left out is named.
TEST(WholeRun, WithoutTimeWhatIsLeftOutIsNamed) {
  const TemporaryFolder folder;
  const std::string example = std::string(BODESMITH_SOURCE_DIR) + "/examples/nanopositioner/";
  for (const char* name : {"gains.csv", "disturbance.json"})
    write_file(folder / name, read_file(example + name));
  write_file(
      folder / "project.toml",
      "schema = \"bodesmith.project/1\"\n[target]\npoints = \"gains.csv\"\ndisturbance = \"disturbance.json\"\n"
      "[hardware.circuit]\n[plant]\nstroke_m = 7e-6\n[track]\nfrequency_hz = [100]\n");
  ProjectSource source = ProjectSource::read(folder / "project.toml");
  source.deadline = Deadline(0.0);
  const project::Run run = run_project(source, folder / "out");
  EXPECT_TRUE(run.tracking.elsewhere.empty());
  EXPECT_THAT(run.not_tried, ::testing::Contains("errors of the controller's parts"));
  EXPECT_THAT(run.not_tried, ::testing::Contains("stages of other families, other references"));
  for (std::size_t i = 0; i < run.alternatives.size(); ++i) {
    const std::string named = "hardware of '" + run.design.alternatives[i].name + "'";
    EXPECT_EQ(std::ranges::count(run.not_tried, named), run.alternatives[i].design.circuit ? 0 : 1) << named;
  }
  EXPECT_TRUE(run.alternatives[run.design.chosen].design.circuit);
  EXPECT_FALSE(run.part_errors);
}

/// A shelf between two levels, with a circuit and its tolerances.
const Ran& filter() {
  static const Ran made(
      "name = \"shelf\"\n[target]\npoints = \"points.csv\"\n[fit]\norder = 2\n[hardware.circuit]\nresistors = \"E24\"\n"
      "[tolerances]\nresistor_percent = 1.0\ncapacitor_percent = 5.0\n[limits]\npoints_db = 0.5\nyield_db = 2.0\ncircuit_db = 1e-9\n",
      {{"points.csv", "frequency_hz,magnitude_db\n10,0\n100,0.5\n300,2.5\n1000,5.5\n3000,6.5\n10000,7\n"}});
  return made;
}

TEST(WholeRun, AFiltersFilesAreItsResponse) {
  const project::Run& run = *filter();
  const Sections sections = filter().sections();
  EXPECT_EQ(sections.pole_count(), 2);
  double off = 0.0;
  const Csv points = Csv::parse("hz,db\n10,0\n100,0.5\n300,2.5\n1000,5.5\n3000,6.5\n10000,7\n", "points.csv");
  for (std::size_t i = 0; i < points.rows(); ++i)
    off = std::max(off, std::abs(level_db(sections.response(Hertz{points.column("hz")[i]}.rad_s())) -
                                 points.column("db")[i]));
  EXPECT_NEAR(run.design.built().points_max_db, off, 1e-6);
  Provenance from;
  const chain::Chain model = chain::read_model(filter().path("model.toml"), from);
  const synthesis::Circuit& circuit = run.design.realised().circuit;
  const Csv bode = filter().csv("bode.csv");
  std::vector<Hertz> grid;
  for (const double hz : bode.column("frequency_hz")) grid.push_back(Hertz{hz});
  EXPECT_NEAR(grid.front().value, 5.0, 1e-6);
  EXPECT_NEAR(grid.back().value, 2e4, 1e-2);
  const std::vector<Complex> wanted = schematic::network_response(circuit, grid);
  double error_db = 0.0;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    EXPECT_NEAR(bode.column("circuit_with_op_amps_magnitude_db")[i], level_db(wanted[i]), 1e-4);
    EXPECT_NEAR(level_db(*model.response(grid[i].rad_s())), level_db(wanted[i]), 0.01) << grid[i].value;
    if (grid[i].value >= 10.0 && grid[i].value <= 1e4)
      error_db = std::max(error_db, std::abs(level_db(wanted[i] / sections.response(grid[i].rad_s()))));
  }
  const std::map<std::string, double> figures = [&] {
    std::map<std::string, double> out;
    for (const auto& [name, value] : run.figures()) out[name] = value;
    return out;
  }();
  EXPECT_NEAR(figures.at("circuit_db"), error_db, 0.05 * error_db + 1e-4);
  EXPECT_FALSE(run.limits_met()) << "no parts are within 1e-9 dB";
  for (const LimitCheck& check : run.limits) EXPECT_EQ(check.met(), check.name != "circuit_db") << check.name;
  const Node yield = parse_json(filter().text("yield.json"), "yield.json").at("designs")[0];
  EXPECT_NEAR(yield.at("worst_db").at("p95").number(), figures.at("yield_db"), 1e-9);
  for (const char* name : {"circuit_db", "yield_db", "target_db"})
    EXPECT_THAT(filter().text("report.html"), HasSubstr(rounded_text(figures.at(name), 3))) << name;
  EXPECT_THAT(run.summary("there"), HasSubstr("NOT met"));
  EXPECT_THAT(run.summary("there"), HasSubstr("there/report.html"));
}

}  // namespace
}  // namespace bodesmith::project
