#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/document.hpp"
#include "base/files.hpp"
#include "run_program.hpp"
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
  Provenance from;
  const TimeRecord a = TimeRecord::read_csv(folder / "a.csv", from, true);
  const TimeRecord b = TimeRecord::read_csv(folder / "b.csv", from, true);
  ASSERT_EQ(a.size(), 200u);
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a.y[i], b.y[i], 1e-6);
  EXPECT_EQ(a.y[0], 0.0);
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

TEST_F(SimulateCommand, BadInputIsOneLineAndLeavesNothing) {
  write_file(folder / "bad.toml",
             "schema = \"bodesmith.model/1\"\n[[block]]\ntype = \"lowpass\"\ncorner_hz = -1\n");
  for (const std::string& arguments :
       {file("bad.toml") + " --input " + file("u.csv"), file("model.toml") + " --input " + file("none.csv"),
        file("model.toml"), file("model.toml") + " --input " + file("u.csv") + " --engine fast",
        file("model.toml") + " --input " + file("u.csv") + " --start warm",
        file("model.toml") + " --input " + file("u.csv") + " --tolerance 0",
        file("model.toml") + " --input " + file("u.csv") + " --degree 9"}) {
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

}  // namespace
}  // namespace bodesmith
