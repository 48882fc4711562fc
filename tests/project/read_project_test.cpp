// What a project file says, read back, and where a slip in one is said to stand.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "base/files.hpp"
#include "project/design/fractional_fit.hpp"
#include "project/design/target_fit.hpp"
#include "project/project.hpp"
#include "temporary_folder.hpp"

namespace bodesmith::project {
namespace {

const std::string kPoints = "frequency_hz,gain\n1,1\n10,1.2\n20,1.3\n60,1.25\n100,1.4\n";
const std::string kStage = "[target]\npoints = \"points.csv\"\ndisturbance = \"d.json\"\n";
const std::string kRest = "[plant]\nstroke_m = 7e-6\n[track]\nfrequency_hz = [1, 100]\n";

Project read_as(const std::string& text, const std::string& points = kPoints) {
  const TemporaryFolder folder;
  write_file(folder / "points.csv", points);
  write_file(
      folder / "d.json",
      R"({"schema": "bodesmith.disturbance/1", "ascending": [0.35, -0.64, 0.29], "descending": [-0.24, 0.08, 0.16],
                 "rate": {"frequency_hz": [1, 100], "ascending": [1, 1], "descending": [1, 1.17]}})");
  write_file(folder / "t.json",
             R"({"schema": "bodesmith.fractional/1", "numerator": [{"coefficient": 100.0, "power": 0.0}],
                 "denominator": [{"coefficient": 1.0, "power": 0.9}, {"coefficient": 0.01, "power": 1.9}]})");
  write_file(folder / "p.toml", "schema = \"bodesmith.project/1\"\n" + text);
  Provenance from;
  return ProjectSource::read(folder / "p.toml").project(from);
}

/// What is said of it, from the file's name on; "read" where nothing is.
std::string said_of(const std::string& text) {
  try {
    read_as(text);
  } catch (const InputError& error) {
    const std::string what = error.what();
    const std::size_t at = what.find("p.toml");
    return at == std::string::npos ? what : what.substr(at);
  }
  return "read";
}

bool says(const std::string& text, const std::string& words) {
  return said_of(text).find(words) != std::string::npos;
}

TEST(ReadProject, AResponseIsJudgedOverItsPointsUnlessABandIsGiven) {
  const Project plain = read_as("[target]\npoints = \"points.csv\"\n");
  EXPECT_EQ(plain.name, "p");
  EXPECT_FALSE(plain.plant || plain.circuit || plain.fpaa);
  EXPECT_EQ(plain.target.band.from.value, 1.0);
  EXPECT_EQ(plain.target.band.to.value, 100.0);
  EXPECT_EQ(plain.target.base.value, 1.0);
  EXPECT_EQ(plain.fit.beta_max, 5.0);
  const Project given = read_as(
      "name = \"n\"\n[target]\npoints = \"points.csv\"\nfrom_hz = 2.0\nto_hz = 50.0\n[fit]\norder = 3\nrelative_degree = 3\n"
      "real = true\nmax_corner_hz = 400\nbase_hz = 10\n[hardware.circuit]\nresistors = \"E24\"\n[tolerances]\n"
      "resistor_percent = 0.5\n[limits]\nyield_db = 2\npoints_db = 0.3\n");
  EXPECT_EQ(given.name, "n");
  EXPECT_EQ(given.target.band.from.value, 2.0);
  EXPECT_EQ(given.target.band.to.value, 50.0);
  EXPECT_EQ(given.target.base.value, 10.0);
  EXPECT_EQ(*given.fit.order, 3);
  EXPECT_EQ(given.fit.direct.relative_degree, 3);
  EXPECT_TRUE(given.fit.direct.real);
  EXPECT_EQ(given.fit.direct.max_corner->value, 400.0);
  EXPECT_EQ(given.circuit->resistors, "E24");
  EXPECT_EQ(given.circuit->capacitors, "E12");
  EXPECT_EQ(given.tolerances().resistor_percent, 0.5);
  EXPECT_EQ(*given.limits.yield_db, 2.0);
  EXPECT_EQ(*given.limits.points_db, 0.3);
  EXPECT_FALSE(given.limits.circuit_db || given.limits.fit_db || given.limits.fpaa_percent);
}

TEST(ReadProject, AStageIsReadWithItsTrack) {
  const Project project = read_as(
      kStage +
      "branch = \"ascending\"\nbase_hz = 10\n[choose]\nby = \"waveform\"\n[hardware.circuit]\n[hardware.controller]\n"
      "form = \"two-pass\"\nallow_unstable = true\n"
      "[plant]\nstroke_m = 7e-6\nresonance_hz = 5e3\ndamping_ratio = 0.1\namplifier_corner_hz = 1e5\n"
      "damping_compensator = { gain = 2.0, zeros = [3.0, 2.0], poles = [2.0, 5.0] }\n"
      "[track]\nwaveform = [\"sine\", \"triangle\"]\namplitude = [0.25, 1.0, 0.5]\nfrequency_hz = [1, 100]\n"
      "measured_percent = [0.5, 0.6]\n[limits]\ntracking_percent = 0.4\nagreement_percent = 0.1\n");
  EXPECT_EQ(project.target.branch, Disturbance::Branch::ascending);
  EXPECT_EQ(project.target.base.value, 10.0);
  EXPECT_EQ(project.fit.beta_max, 5.0);
  EXPECT_EQ(project.choice, Project::Choice::waveform);
  EXPECT_EQ(*project.controller.form, "two-pass");
  EXPECT_TRUE(project.controller.allow_unstable);
  EXPECT_EQ(project.track.waveform(), tracking::Reference::Shape::sine);
  EXPECT_EQ(project.track.amplitude(), 1.0);
  EXPECT_EQ(project.track.measured_percent.size(), 2U);
  EXPECT_EQ(*project.limits.tracking_percent, 0.4);
  EXPECT_EQ(*project.limits.agreement_percent, 0.1);
  EXPECT_EQ(project.plant->resonance->value, 5e3);
  EXPECT_EQ(project.plant->amplifier_corner->value, 1e5);
  // s^2 + 3 s + 2 and s^2 + 2 s + 5.
  const Section& damping = *project.plant->damping_compensator;
  EXPECT_NEAR(std::abs(damping.zeros[0] * damping.zeros[1] - 2.0), 0.0, 1e-12);
  EXPECT_NEAR(std::abs(damping.zeros[0] + damping.zeros[1] + 3.0), 0.0, 1e-12);
  EXPECT_NEAR(std::abs(damping.poles[0].imag()), 2.0, 1e-12);
  EXPECT_NEAR(damping.poles[0].real(), -1.0, 1e-12);
}

TEST(ReadProject, SlipsAreSaidWhereTheyStand) {
  const std::string response = "[target]\npoints = \"points.csv\"\n";
  EXPECT_EQ(said_of(response), "read");
  EXPECT_EQ(said_of(kStage + kRest), "read");
  EXPECT_TRUE(says("[target]\npoints = \"none.csv\"\n", "p.toml:3: 'target.points' names"));
  EXPECT_TRUE(says(response + "from_hz = 3.0\n", "has one end of a band"));
  EXPECT_TRUE(
      says(response + "from_hz = 3.0\nto_hz = 3.0\n", "p.toml:5: 'target.to_hz' is not above from_hz"));
  EXPECT_TRUE(
      says(response + "fractional = \"t.json\"\n", "expected one of points, sections and fractional"));
  EXPECT_TRUE(says("[target]\nfractional = \"t.json\"\n", "needs from_hz and to_hz"));
  EXPECT_TRUE(says(kStage + kRest + "[fit]\nbeta_positive = true\n", "needs method = \"bounded\""));
  EXPECT_EQ(said_of(kStage + kRest + "[fit]\nmethod = \"bounded\"\nbeta_positive = true\n"), "read");
  EXPECT_NE(said_of(response + "[fit]\norder = 2\nrelative_degree = 3\n"), "read");
  EXPECT_NE(said_of(response + "[fit]\norder = 13\n"), "read");
  EXPECT_TRUE(
      says(response + "[approximate]\norder = 2\nmax_error_db = 0.1\n", "has both order and max_error_db"));
  EXPECT_TRUE(says(response + "[tolerances]\ncapacitor_percent = 100\n", "expected less than 100"));
  EXPECT_EQ(said_of(response + "[tolerances]\ncapacitor_percent = 99\n"), "read");
  EXPECT_TRUE(says(response + "[limits]\ntracking_percent = 1\n", "is for projects with a disturbance"));
  EXPECT_TRUE(says(kStage + kRest + "[limits]\nyield_db = 1\n", "is for projects without a disturbance"));
  EXPECT_TRUE(says(kStage + kRest + "[hardware.controller]\n", "needs [hardware.circuit]"));
  EXPECT_NE(said_of(kStage + kRest + "[fit]\norder = 2\n"), "read") << "of a stage the chart decides";
  EXPECT_NE(said_of(response + "[choose]\nby = \"tracking\"\n"), "read");
}

TEST(ReadProject, WhatTheStageCannotDoIsSaidAtItsAmplitude) {
  const auto with = [](const std::string& plant, const std::string& track) {
    return kStage + "[plant]\nstroke_m = 7e-6\n" + plant + "[track]\nfrequency_hz = [1, 100]\n" + track;
  };
  EXPECT_EQ(said_of(with("", "amplitude = 1.0\n")), "read");
  EXPECT_TRUE(says(with("", "amplitude = [0.5, 1.001]\n"), "beyond the full stroke"));
  EXPECT_TRUE(says(with("drive_range = [1.0, 0.0]\n", ""), "is no range"));
  EXPECT_TRUE(says(with("", "measured_percent = [1, 2, 3]\n"), "expected one for each of the 2 tracked"));
  EXPECT_TRUE(says(kStage + "[plant]\nstroke_m = 1\n[track]\nfrequency_hz = []\n",
                   "expected at least one frequency"));
  for (const char* hz : {"1e308", "1.1e9", "0.9e-6"})
    EXPECT_TRUE(says(kStage + "[plant]\nstroke_m = 1\n[track]\nfrequency_hz = [1, " + hz + "]\n",
                     "is not within 1e-6 to 1e9"))
        << hz;
  // v + K d(v) = r: falling by .16 of the stroke at most, the drive goes beyond the stroke where d is below 0.
  EXPECT_EQ(said_of(with("drive_range = [-1.0, 2.0]\n", "amplitude = 1.0\n")), "read");
  EXPECT_TRUE(says(with("drive_range = [0.0, 0.9]\n", "amplitude = [0.5, 1.0]\n"),
                   "an amplitude of 1 takes a drive of"));
  EXPECT_TRUE(
      says(with("drive_range = [0.2, 2.0]\n", "amplitude = 1.0\n"), "an amplitude of 1 takes a drive of"));
  EXPECT_EQ(said_of(with("drive_range = [0.0, 0.9]\n", "amplitude = 0.25\n")), "read");
}

// The fewest poles within an error: the more is allowed the fewer, and never more error than that.
TEST(TargetFit, TakesTheFewestPolesThatKeepAnError) {
  int before = 99;
  for (const double allowed : {0.02, 0.3, 3.5}) {
    const Project project =
        read_as("[target]\npoints = \"points.csv\"\n[fit]\nmax_error_db = " + std::to_string(allowed) + "\n");
    const Design design = fit_response(project);
    ASSERT_EQ(design.alternatives.size(), 1U);
    EXPECT_LE(design.built().points_max_db, allowed);
    EXPECT_LE(design.sections().pole_count(), before);
    before = design.sections().pole_count();
    double worst = 0.0;
    for (const BodePoint& point : project.target.points.points) {
      if (point.frequency > project.target.base)
        worst = std::max(
            worst, std::abs(20.0 * std::log10(std::abs(design.sections().response(point.frequency.rad_s())) /
                                              point.gain)));
    }
    EXPECT_LE(worst, allowed + 1e-6);
    EXPECT_NE(design.how.find("The fewest poles within"), std::string::npos);
  }
  EXPECT_LE(before, 1);
}

TEST(TargetFit, GoesTheWayThatWasAsked) {
  const auto design_by = [](const std::string& fit) {
    return fit_response(read_as("[target]\npoints = \"points.csv\"\n[fit]\n" + fit));
  };
  const Design through = design_by("method = \"interpolate\"\n");
  ASSERT_TRUE(through.fit);
  EXPECT_EQ(through.fit->terms.size(), 4U);
  EXPECT_FALSE(through.direct);
  EXPECT_TRUE(through.approximation);
  const Design automatic = design_by("");
  ASSERT_TRUE(automatic.fit) << "five points are few enough";
  EXPECT_EQ(automatic.sections().pole_count(), through.sections().pole_count());
  for (const char* fit : {"order = 2\n", "method = \"direct\"\norder = 2\n"}) {
    const Design direct = design_by(fit);
    ASSERT_TRUE(direct.direct) << fit;
    EXPECT_FALSE(direct.fit);
    EXPECT_EQ(direct.sections().pole_count(), 2);
  }
  EXPECT_TRUE(design_by("method = \"bounded\"\nbeta_max = 1.5\n").fit->bounded);
  // What goes through 41 points of a line cannot be built: refused if that is asked, otherwise they are fitted.
  Project many = read_as("[target]\npoints = \"points.csv\"\n[fit]\nmethod = \"interpolate\"\n");
  many.target.points.points.clear();
  for (int i = 0; i <= 40; ++i) {
    const Hertz f{std::pow(10.0, 0.1 * i)};
    many.target.points.points.push_back({f, 1.0 / std::sqrt(f.value), std::nullopt, 1.0, 0});
  }
  EXPECT_THROW(fit_response(many), DesignError);
  many.fit.method = Project::Fit::Method::automatic;
  EXPECT_NE(fit_response(many).how.find("41 points would make 40 bands"), std::string::npos);
}

// s^-0.9 and a lag of order 1: the integrator that is kept is one of the poles, and falls as the transfer does.
TEST(FractionalFit, MeetsGainAndPhaseOverItsBand) {
  const Project project =
      read_as("[target]\nfractional = \"t.json\"\nfrom_hz = 1.0\nto_hz = 1000.0\n[fit]\norder = 5\n");
  const Design design = fit_response(project);
  double db = 0.0, degrees = 0.0;
  for (int i = 0; i <= 1000; ++i) {
    const RadPerSecond w = Hertz{std::pow(10.0, 3.0 * i / 1000.0)}.rad_s();
    const std::complex<double> s(0.0, w.value);
    const std::complex<double> wanted = 100.0 / (std::pow(s, 0.9) + 0.01 * std::pow(s, 1.9));
    const std::complex<double> ratio = design.sections().response(w) / wanted;
    db = std::max(db, std::abs(20.0 * std::log10(std::abs(ratio))));
    degrees = std::max(degrees, std::abs(std::arg(ratio)) * 180.0 / M_PI);
  }
  EXPECT_NEAR(design.built().points_max_db, db, 0.02 * db + 1e-6);
  EXPECT_NEAR(design.direct->max_phase_deg, degrees, 0.02 * degrees + 1e-6);
  EXPECT_LT(db, 0.3);
  EXPECT_NE(design.how.find("Its integrator of order 0.9 ends at a gain of"), std::string::npos)
      << design.how;
  FractionalFitOptions options;
  options.band = project.target.band;
  options.order = 4;
  options.keep_integrator = true;
  const FractionalFit kept = fit_fractional(*project.target.fractional, "t.json", options);
  EXPECT_EQ(kept.poles_at_zero, 1);
  EXPECT_EQ(kept.fit.sections.sections.front().poles[0], 0.0);
  EXPECT_EQ(kept.lowest_pole().value, 0.0);
  EXPECT_LT(kept.fit.max_db, 0.5);
}

}  // namespace
}  // namespace bodesmith::project
