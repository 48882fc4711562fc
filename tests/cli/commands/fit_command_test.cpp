#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "base/documents/document.hpp"
#include "base/provenance.hpp"
#include "lti/cascade.hpp"
#include "lti/sections.hpp"
#include "run_program.hpp"

namespace bodesmith {
namespace {

const std::string kFitGains = std::string(BODESMITH_SOURCE_DIR) + "/examples/nanopositioner/gains.csv";

TEST(FitCommand, WritesACascadeThatGoesThroughThePoints) {
  const TemporaryFolder folder;
  const std::string out = (folder / "cascade.json").string();
  const auto result = run_bodesmith("fit " + kFitGains + " -o " + out);
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.out.find("lead"), std::string::npos);
  EXPECT_NE(result.err.find("the curve about 10 Hz is determined by this point alone"), std::string::npos);
  Provenance from;
  const Cascade cascade = Cascade::read(out, from);
  EXPECT_NEAR(std::abs(cascade.response(Hertz{100}.rad_s())), 1.17, 1e-9);
  EXPECT_EQ(cascade.terms.size(), 4u);
  const Node text = parse_json(read_file(out), out);
  EXPECT_EQ(text.at("inputs").size(), 1u);
  EXPECT_EQ(text.at("fit").at("terms")[2].at("orientation").string(), "lag");
}

TEST(FitCommand, BaseAndBounds) {
  const TemporaryFolder folder;
  write_file(folder / "p.csv", "frequency_hz,gain\n20,1.1\n60,1.04\n100,1.17\n");
  const std::string to = " -o " + (folder / "c.json").string();
  const auto result = run_bodesmith("fit " + (folder / "p.csv").string() + " --base-hz 1 --json" + to);
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.err.find("between 1 Hz and 20 Hz"), std::string::npos);
  const Node summary = parse_json(result.out, "stdout");
  EXPECT_EQ(summary.at("terms").size(), 3u);
  EXPECT_EQ(
      run_bodesmith("fit " + kFitGains + " --beta-max 2 --beta-positive --max-error-db 0.1" + to).status, 1);
  EXPECT_EQ(run_bodesmith("fit " + kFitGains + " --beta-max 2 --max-error-db 0.1" + to).status, 0);
}

TEST(FitCommand, BadInputIsOneLineAndWritesNothing) {
  const TemporaryFolder folder;
  const std::string to = " -o " + (folder / "c.json").string();
  write_file(folder / "one.csv", "frequency_hz,gain\n20,1.1\n");
  write_file(folder / "zero.csv", "frequency_hz,gain\n1,1\n20,0\n");
  write_file(folder / "empty.csv", "");
  for (const std::string& arguments :
       {(folder / "one.csv").string(), (folder / "zero.csv").string(), (folder / "empty.csv").string(),
        (folder / "none.csv").string(), kFitGains + " --base-hz -1", kFitGains + " --beta-max 0",
        kFitGains + " --beta-positive", kFitGains + " --base-hz 100", kFitGains + " --wrong"}) {
    const auto result = run_bodesmith("fit " + arguments + to);
    EXPECT_EQ(result.status, 2) << arguments;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_FALSE(std::filesystem::exists(folder / "c.json"));
  }
  EXPECT_EQ(run_bodesmith("fit " + kFitGains).status, 2);
}

TEST(FitCommand, DirectFitOfTheFivePoints) {
  const TemporaryFolder folder;
  const std::string out = (folder / "sections.json").string();
  const auto result =
      run_bodesmith("fit " + kFitGains + " --direct --order 3 --real --max-corner-hz 500 -o " + out);
  ASSERT_EQ(result.status, 0) << result.err;
  Provenance from;
  const Sections sections = Sections::read(out, from);
  EXPECT_EQ(sections.pole_count(), 3);
  const double f[] = {1, 10, 20, 60, 100};
  const double g[] = {1, 1.06, 1.1, 1.04, 1.17};
  for (int i = 0; i < 5; ++i) {
    EXPECT_NEAR(to_decibel(std::abs(sections.response(Hertz{f[i]}.rad_s()))), to_decibel(g[i]), 0.01);
  }
  EXPECT_LE(sections.corner_band().to.value, 500.0 * (1 + 1e-9));
  EXPECT_EQ(run_bodesmith("fit " + kFitGains + " --direct --order 1 --max-error-db 0.001 -o " + out).status,
            1);
  EXPECT_EQ(run_bodesmith("fit " + kFitGains + " --direct --max-error-db 0.01 -o " + out).status, 0);
  const auto again = [&] {
    return run_bodesmith("fit " + kFitGains + " --direct --order 2 --seed 3 -o " + out).out;
  };
  EXPECT_EQ(again(), again());
}

TEST(FitCommand, WaveformFit) {
  const TemporaryFolder folder;
  const std::string disturbance =
      std::string(BODESMITH_SOURCE_DIR) + "/examples/nanopositioner/disturbance.json";
  const std::string out = (folder / "sections.json").string();
  const auto result = run_bodesmith("fit --waveform " + disturbance + " --order 1 --json -o " + out);
  ASSERT_EQ(result.status, 0) << result.err;
  const Node summary = parse_json(result.out, "stdout");
  EXPECT_EQ(summary.at("branch").string(), "descending");
  EXPECT_LT(summary.at("error").at("rms_percent").number(),
            summary.at("no_compensation").at("rms_percent").number());
  Provenance from;
  EXPECT_EQ(Sections::read(out, from).pole_count(), 1);
}

TEST(FitCommand, ModesThatExcludeEachOther) {
  const TemporaryFolder folder;
  const std::string disturbance =
      std::string(BODESMITH_SOURCE_DIR) + "/examples/nanopositioner/disturbance.json";
  const std::string to = " -o " + (folder / "c.json").string();
  for (const std::string& arguments :
       {std::string(), kFitGains + " --direct", kFitGains + " --order 3", kFitGains + " --direct --order 13",
        kFitGains + " --waveform " + disturbance, "--waveform " + disturbance + " --norm max",
        "--waveform " + disturbance + " --branch ascending", "--waveform " + kFitGains}) {
    const auto result = run_bodesmith("fit " + arguments + to);
    EXPECT_EQ(result.status, 2) << arguments;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_FALSE(std::filesystem::exists(folder / "c.json"));
  }
}

}  // namespace
}  // namespace bodesmith
