#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "base/documents/document.hpp"
#include "base/files.hpp"
#include "browser_check.hpp"
#include "run_program.hpp"
#include "signal/csv.hpp"
#include "signal/time_record.hpp"
#include "temporary_folder.hpp"

namespace bodesmith {
namespace {

struct SimulateCommand : ::testing::Test {
  void SetUp() override {
    write_file(folder / "model.toml",
               "schema = \"bodesmith.model/1\"\n[[block]]\ntype = \"lowpass\"\ncorner_hz = 10.0\n"
               "[[block]]\ntype = \"polynomial\"\ncoefficients = [0.0, 1.0, 0.0, 0.5]\n");
    std::string csv = "time_s,u,y\n";
    for (int i = 0; i < 200; ++i)
      csv += std::to_string(0.001 * i) + "," + std::to_string(std::sin(0.05 * i)) + ",0.5\n";
    write_file(folder / "u.csv", csv);
  }
  std::string file(const std::string& name) const { return "'" + (folder / name).string() + "'"; }
  TemporaryFolder folder;
};

TEST_F(SimulateCommand, EnginesAgreeAndTheSummarySaysWhatWasDone) {
  const auto first = run_bodesmith("simulate " + file("model.toml") + " --input " + file("u.csv") + " -o " +
                                   file("a.csv") + " --json");
  ASSERT_EQ(first.status, 0) << first.err;
  const Node summary = parse_json(first.out, "summary");
  EXPECT_EQ(summary.at("schema").string(), "bodesmith.simulate_summary/1");
  EXPECT_GT(summary.at("timing_s").at("compute").number(), 0.0);
  EXPECT_LT(summary.at("error_estimate").number(), 1e-7);
  EXPECT_GT(summary.at("against_record").at("rms").number(), 0.1);
  EXPECT_EQ(summary.at("inputs").size(), 2u);
  const auto second = run_bodesmith("simulate " + file("model.toml") + " --input " + file("u.csv") + " -o " +
                                    file("b.csv") + " --engine cvode");
  ASSERT_EQ(second.status, 0) << second.err;
  EXPECT_EQ(second.out.find("approximated"), std::string::npos) << "there are no fractional terms";
  Provenance from;
  const TimeRecord a = TimeRecord::read_csv(folder / "a.csv", from, true);
  const TimeRecord b = TimeRecord::read_csv(folder / "b.csv", from, true);
  ASSERT_EQ(a.size(), 200u);
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a.y[i], b.y[i], 1e-6);
  EXPECT_EQ(a.y[0], 0.0);
}

TEST_F(SimulateCommand, AutomaticSaysWhatItPickedForEachSegment) {
  const auto segments = [&](const std::string& more) {
    const auto done =
        run_bodesmith("simulate " + file("mixed.toml") + " --reference triangle --frequency-hz 5 -o " +
                      file("y.csv") + " --json " + more);
    EXPECT_EQ(done.status, 0) << done.err;
    const Node summary = parse_json(done.out, "summary");
    EXPECT_TRUE(summary.has("error_estimate"));
    std::string out = summary.at("engine").string();
    for (const Node& s : summary.at("segments").items()) {
      out += "; " + std::to_string(s.at("blocks")[0].integer(1, 9)) + "-" +
             std::to_string(s.at("blocks")[1].integer(1, 9)) + " " + s.at("method").string();
    }
    return out;
  };
  const std::string lags =
      "schema = \"bodesmith.model/1\"\n[[block]]\ntype = \"lowpass\"\ncorner_hz = 30.0\n"
      "[[block]]\ntype = \"lowpass\"\ncorner_hz = 50.0\n";
  write_file(folder / "mixed.toml", lags);
  EXPECT_EQ(segments(""), "exact; 1-2 closed form between corners");
  write_file(folder / "mixed.toml", lags +
                                        "[[block]]\ntype = \"saturation\"\nlower = 0.2\nupper = 0.6\n"
                                        "[[block]]\ntype = \"delay\"\ndelay_s = 0.002\n"
                                        "[[block]]\ntype = \"backlash\"\nwidth = 0.1\n");
  EXPECT_EQ(segments("--tolerance 1e-6"),
            "record; 1-2 matrix exponential on each hold; 3-3 value by value; 4-4 matrix exponential on each "
            "hold; 5-5 memory, node by node");
  EXPECT_EQ(segments("--engine cvode"),
            "cvode; 1-3 one ODE with events; 4-4 delay, shifted; 5-5 one ODE with events");
}

TEST_F(SimulateCommand, EquilibriumStartsAtRest) {
  std::string csv = "time_s,u\n";
  for (int i = 0; i < 20; ++i) csv += std::to_string(0.001 * i) + ",2.0\n";
  write_file(folder / "still.csv", csv);
  const auto done = run_bodesmith("simulate " + file("model.toml") + " --input " + file("still.csv") +
                                  " -o " + file("y.csv") + " --start equilibrium");
  ASSERT_EQ(done.status, 0) << done.err;
  Provenance from;
  const TimeRecord y = TimeRecord::read_csv(folder / "y.csv", from, true);
  for (const double v : y.y) EXPECT_NEAR(v, 2.0 + 0.5 * 8.0, 1e-12);
}

TEST_F(SimulateCommand, AModelSaysHowItStartsUnlessAnotherStartIsAskedFor) {
  std::string csv = "time_s,u\n";
  for (int i = 0; i < 20; ++i) csv += std::to_string(0.001 * i) + ",2.0\n";
  write_file(folder / "still.csv", csv);
  const std::string block = "[[block]]\ntype = \"lowpass\"\ncorner_hz = 30.0\n";
  const auto first = [&](const std::string& model, const std::string& options) {
    write_file(folder / "started.toml", "schema = \"bodesmith.model/1\"\n" + model + block);
    const auto done = run_bodesmith("simulate " + file("started.toml") + " --input " + file("still.csv") +
                                    " -o " + file("y.csv") + options);
    EXPECT_EQ(done.status, 0) << done.err;
    Provenance from;
    return TimeRecord::read_csv(folder / "y.csv", from, true).y.front();
  };
  for (const std::string engine : {"automatic", "exact", "record", "cvode"}) {
    const std::string by = " --engine " + engine;
    EXPECT_NEAR(first("", by), 0.0, 1e-12) << engine;
    EXPECT_NEAR(first("start = \"equilibrium\"\n", by), 2.0, 1e-9) << engine;
    EXPECT_NEAR(first("start = \"equilibrium\"\n", by + " --start zero"), 0.0, 1e-12) << engine;
    EXPECT_NEAR(first("start = \"zero\"\n", by + " --start equilibrium"), 2.0, 1e-9) << engine;
  }
}

TEST_F(SimulateCommand, BadInputIsOneLineAndLeavesNothing) {
  write_file(folder / "bad.toml",
             "schema = \"bodesmith.model/1\"\n[[block]]\ntype = \"lowpass\"\ncorner_hz = -1\n");
  for (const std::string& arguments :
       {file("bad.toml") + " --input " + file("u.csv"), file("model.toml") + " --input " + file("none.csv"),
        file("model.toml"), file("model.toml") + " --input " + file("u.csv") + " --engine fast",
        file("model.toml") + " --input " + file("u.csv") + " --start warm",
        file("model.toml") + " --input " + file("u.csv") + " --tolerance 0",
        file("model.toml") + " --input " + file("u.csv") + " --oversample 0"}) {
    const auto done = run_bodesmith("simulate " + arguments + " -o " + file("out.csv"));
    EXPECT_EQ(done.status, 2) << arguments << done.err;
    EXPECT_EQ(std::count(done.err.begin(), done.err.end(), '\n'), 1) << done.err;
    EXPECT_FALSE(std::filesystem::exists(folder / "out.csv"));
  }
  EXPECT_EQ(run_bodesmith("simulate " + file("model.toml") + " --input " + file("u.csv")).status, 2);
  EXPECT_NE(
      run_bodesmith("simulate " + file("bad.toml") + " --input " + file("u.csv") + " -o " + file("out.csv"))
          .err.find("bad.toml:4:"),
      std::string::npos);
}

TEST_F(SimulateCommand, MakesItsOwnReferencesAndSweeps) {
  const auto once =
      run_bodesmith("simulate " + file("model.toml") +
                    " --reference triangle --frequency-hz 5 --step-s 0.001 -o " + file("y.csv"));
  ASSERT_EQ(once.status, 0) << once.err;
  Provenance from;
  const TimeRecord y = TimeRecord::read_csv(folder / "y.csv", from, true);
  ASSERT_EQ(y.size(), 1001u);
  EXPECT_EQ(y.u[100], 1.0);
  const std::string sweep = "simulate " + file("model.toml") +
                            " --sweep-frequency-hz 1,10 --sweep-amplitude 0.2,0.5 -o " + file("sweep.csv");
  ASSERT_EQ(run_bodesmith(sweep).status, 0);
  const std::string first = read_file(folder / "sweep.csv");
  EXPECT_EQ(std::count(first.begin(), first.end(), '\n'), 6);
  const auto again = run_bodesmith(sweep + " --resume --json");
  ASSERT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(parse_json(again.out, "summary").at("runs_taken_over").integer(0, 10), 4);
  EXPECT_EQ(read_file(folder / "sweep.csv"), first);
  EXPECT_EQ(run_bodesmith("simulate " + file("model.toml") + " --sweep-frequency-hz 1,x -o " + file("s.csv"))
                .status,
            2);
  EXPECT_EQ(run_bodesmith("simulate " + file("model.toml") + " --reference wave -o " + file("s.csv")).status,
            2);
  EXPECT_EQ(run_bodesmith("simulate " + file("model.toml") + " --reference sine --input " + file("u.csv") +
                          " -o " + file("s.csv"))
                .status,
            2);
}

TEST_F(SimulateCommand, AnUnstableSpringIsSaidNotReturned) {
  write_file(folder / "soft.toml",
             "schema = \"bodesmith.model/1\"\n[[block]]\ntype = \"resonator\"\nnatural_frequency_hz = "
             "10.0\ndamping_ratio = 0.1\ncubic = -4.0\n");
  const auto done =
      run_bodesmith("simulate " + file("soft.toml") + " --input " + file("u.csv") + " -o " + file("out.csv"));
  EXPECT_EQ(done.status, 2) << done.out;
  EXPECT_NE(done.err.find("without bound"), std::string::npos) << done.err;
}

TEST_F(SimulateCommand, SpectraAndLoopsOfALagAreItsClosedForm) {
  write_file(folder / "lag.toml",
             "schema = \"bodesmith.model/1\"\n[[block]]\ntype = \"lowpass\"\ncorner_hz = 10.0\n");
  const auto done = run_bodesmith("simulate " + file("lag.toml") +
                                  " --reference sine --frequency-hz 10 --step-s 1e-4 --duration-s 2 -o " +
                                  file("y.csv") + " --spectra " + file("s.csv") + " --loops " +
                                  file("l.csv") + " --report " + file("r.html") + " --json");
  ASSERT_EQ(done.status, 0) << done.err;
  const Node summary = parse_json(done.out, "summary");
  const Node first = summary.at("spectra").at("harmonics")[0];
  EXPECT_NEAR(first.at("frequency_hz").number(), 10.0, 1e-9);
  // Straight lines between samples take 3e-6 off the sine. At its corner a lag has 1/sqrt 2 and -45 degrees;
  // the loop's height over the range of y is sin 45.
  EXPECT_NEAR(first.at("y_amplitude").number() / first.at("u_amplitude").number(), std::sqrt(0.5), 5e-6);
  EXPECT_NEAR(first.at("y_phase_deg").number() - first.at("u_phase_deg").number(), -45.0, 1e-4);
  EXPECT_LT(summary.at("spectra").at("thd_percent").at("y").number(), 1e-4);
  EXPECT_EQ(summary.at("loops").at("periods").integer(0, 100), 20);
  EXPECT_NEAR(summary.at("loops").at("height_percent").number(), 100.0 * std::sqrt(0.5), 1e-3);
  const Csv spectra = Csv::parse(read_file(folder / "s.csv"), "s.csv");
  ASSERT_EQ(spectra.rows(), 501u);
  EXPECT_EQ(spectra.column("harmonic")[3], 3.0);
  const Csv loops = Csv::parse(read_file(folder / "l.csv"), "l.csv");
  EXPECT_EQ(loops.rows(), 20u * 101u);
  EXPECT_GT(loops.column("descending").back(), loops.column("ascending").back());
  const std::string page = read_file(folder / "r.html");
  EXPECT_NE(page.find("Total harmonic distortion"), std::string::npos);
  EXPECT_EQ(page.find("nan"), std::string::npos);
}

TEST_F(SimulateCommand, WhatDoesNotRepeatIsSaidToBeWindowed) {
  const auto done =
      run_bodesmith("simulate " + file("model.toml") + " --reference chirp --last-hz 50 -o " + file("y.csv") +
                    " --spectra " + file("s.csv") + " --report " + file("r.svg"));
  ASSERT_EQ(done.status, 0) << done.err;
  EXPECT_NE(done.err.find("does not repeat"), std::string::npos) << done.err;
  EXPECT_EQ(read_file(folder / "s.csv").find("harmonic"), std::string::npos);
  EXPECT_TRUE(read_file(folder / "r.svg").starts_with("<svg"));
}

TEST_F(SimulateCommand, SweepsCarryLoopsSpectraAndPictures) {
  const std::string sweep =
      "simulate " + file("model.toml") +
      " --sweep-frequency-hz 1,10 --sweep-amplitude 0.2,0.5 --samples-per-period 100 -o " + file("sweep.csv");
  const auto done = run_bodesmith(sweep + " --spectra " + file("s.csv") + " --loops " + file("l.csv") +
                                  " --report " + file("r.html"));
  ASSERT_EQ(done.status, 0) << done.err;
  const Csv spectra = Csv::parse(read_file(folder / "s.csv"), "s.csv");
  ASSERT_EQ(spectra.rows(), 4u * 51u);
  EXPECT_EQ(spectra.column("frequency_hz").back(), 10.0);
  EXPECT_NEAR(spectra.column("u_amplitude")[1], 0.2 * 8.0 / (M_PI * M_PI), 1e-3);
  const Csv loops = Csv::parse(read_file(folder / "l.csv"), "l.csv");
  EXPECT_GT(loops.rows(), 300u);
  EXPECT_NE(read_file(folder / "r.html").find("Loop height"), std::string::npos);
  if (no_browser().empty()) {
    const ProgramResult page = drive_page("check_pages.py", file("r.html"));
    EXPECT_EQ(page.status, 0) << page.out << page.err;
  }
  EXPECT_EQ(run_bodesmith(sweep + " --resume --loops " + file("l.csv")).status, 2);
}

/// A loop on the command line, exactly and in CVODE.
struct SimulateLoop : SimulateCommand {
  void SetUp() override {
    write_file(folder / "plant.toml",
               "schema = \"bodesmith.model/1\"\n[[block]]\ntype = \"gain\"\ngain = 1.3\n[[block]]\n"
               "type = \"lowpass\"\ncorner_hz = 200.0\n");
    write_file(folder / "inverse.toml",
               "schema = \"bodesmith.model/1\"\n[[block]]\ntype = \"gain\"\ngain = 0.7\n");
    write_controller("");
  }
  void write_controller(const std::string& more) {
    write_file(
        folder / "pid.toml",
        "schema = \"bodesmith.controller/1\"\ntype = \"pid\"\nkp = 0.3\nki_per_s = 120.0\nkd_s = 1e-4\n"
        "derivative_corner_hz = 500.0\n" +
            more);
  }
  Csv run(const std::string& more, const std::string& table = "y.csv") {
    const auto done =
        run_bodesmith("simulate " + file("plant.toml") + " --controller " + file("pid.toml") +
                      " --reference triangle --frequency-hz 5 -o " + file(table) + " --json " + more);
    EXPECT_EQ(done.status, 0) << done.err;
    if (done.status == 0) summary = std::make_unique<Node>(parse_json(done.out, "summary"));
    return Csv::parse(read_file(folder / table), table);
  }
  std::unique_ptr<Node> summary;
};

TEST_F(SimulateLoop, EnginesAgreeContinuousAndSampled) {
  for (const std::string& more :
       {std::string(), std::string("sample_s = 0.002\n"), std::string("feedforward = \"inverse.toml\"\n")}) {
    write_controller(more);
    const Csv exact = run("--engine exact");
    EXPECT_EQ(summary->at("engine").string(), "exact");
    EXPECT_LT(summary->at("error_estimate").number(), 1e-12);
    EXPECT_EQ(exact.names(), (std::vector<std::string>{"time_s", "r", "u", "y"}));
    const Csv cvode = run("--engine cvode --tolerance 1e-11");
    EXPECT_EQ(summary->at("engine").string(), "cvode");
    for (std::size_t i = 0; i < exact.rows(); ++i) {
      ASSERT_NEAR(exact.column("y")[i], cvode.column("y")[i], 1e-9) << more << i;
      ASSERT_NEAR(exact.column("u")[i], cvode.column("u")[i], 1e-7) << more << i;
    }
    EXPECT_LT(summary->at("tracking_error").at("rms_percent_of_range").number(), 20.0);
  }
}

TEST_F(SimulateLoop, FeedForwardHelpsAndADriveFileIsTheSame) {
  run("");
  const double alone = summary->at("tracking_error").at("rms").number();
  write_controller("feedforward = \"inverse.toml\"\n");
  const Csv hybrid =
      run("--spectra " + file("s.csv") + " --loops " + file("l.csv") + " --report " + file("r.html"));
  EXPECT_LT(summary->at("tracking_error").at("rms").number(), 0.5 * alone);
  EXPECT_NE(read_file(folder / "s.csv").find("r_amplitude"), std::string::npos);
  EXPECT_NE(read_file(folder / "r.html").find("Tracking error"), std::string::npos);
  std::string drive = "time_s,u\n";
  for (std::size_t i = 0; i < hybrid.rows(); ++i)
    drive += std::to_string(1e-3 * static_cast<double>(i)) + "," +
             std::to_string(0.7 * hybrid.column("r")[i]) + "\n";
  write_file(folder / "drive.csv", drive);
  write_controller("feedforward = \"drive.csv\"\n");
  const Csv same = run("");
  for (std::size_t i = 0; i < same.rows(); ++i) ASSERT_NEAR(same.column("y")[i], hybrid.column("y")[i], 2e-6);
  // A sweep of the loop: its table shrinks with the frequency.
  write_controller("feedforward = \"inverse.toml\"\n");
  const auto sweep = run_bodesmith("simulate " + file("plant.toml") + " --controller " + file("pid.toml") +
                                   " --sweep-frequency-hz 1,20 -o " + file("sweep.csv"));
  ASSERT_EQ(sweep.status, 0) << sweep.err;
  const Csv table = Csv::parse(read_file(folder / "sweep.csv"), "sweep.csv");
  EXPECT_LT(table.column("rms_percent")[0], table.column("rms_percent")[1]);
}

TEST_F(SimulateLoop, BadControllersNameTheirLine) {
  const auto refused = [&](const std::string& more, const std::string& words) {
    write_controller(more);
    const auto done = run_bodesmith("simulate " + file("plant.toml") + " --controller " + file("pid.toml") +
                                    " --reference triangle --frequency-hz 5 -o " + file("none.csv"));
    EXPECT_EQ(done.status, 2) << more;
    EXPECT_EQ(std::count(done.err.begin(), done.err.end(), '\n'), 1) << done.err;
    EXPECT_NE(done.err.find(words), std::string::npos) << done.err;
    EXPECT_FALSE(std::filesystem::exists(folder / "none.csv"));
  };
  refused("sample_s = 0\n", "pid.toml:7:");
  refused("ki = 3\n", "pid.toml:7:");
  refused("lower = 2.0\nupper = 1.0\n", "pid.toml:8:");
  refused("feedforward = \"nothing.toml\"\n", "pid.toml:7:");
  write_file(folder / "short.csv", "time_s,u\n0,0\n0.001,0.1\n");
  refused("feedforward = \"short.csv\"\n", "short.csv");
  write_controller("");
  write_file(folder / "plant.toml",
             "schema = \"bodesmith.model/1\"\n[[block]]\ntype = \"gain\"\ngain = 1.3\n");
  refused("", "answers its drive at once");
}

}  // namespace
}  // namespace bodesmith
