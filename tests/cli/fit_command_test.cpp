#include <gtest/gtest.h>

#include <filesystem>

#include "base/document.hpp"
#include "base/provenance.hpp"
#include "lti/cascade.hpp"
#include "run_program.hpp"

namespace bodesmith {
namespace {

const std::string kGains = std::string(BODESMITH_SOURCE_DIR) + "/examples/nanopositioner/gains.csv";

TEST(FitCommand, WritesACascadeThatGoesThroughThePoints) {
  const TemporaryFolder folder;
  const std::string out = (folder / "cascade.json").string();
  const auto result = run_bodesmith("fit " + kGains + " -o " + out);
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.out.find("lead"), std::string::npos);
  EXPECT_NE(result.err.find("hangs on the point at 10 Hz"), std::string::npos);
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
  EXPECT_NE(result.err.find("between 1 and 20 Hz"), std::string::npos);
  const Node summary = parse_json(result.out, "stdout");
  EXPECT_EQ(summary.at("terms").size(), 3u);
  EXPECT_EQ(run_bodesmith("fit " + kGains + " --beta-max 2 --beta-positive --max-error-db 0.1" + to).status,
            1);
  EXPECT_EQ(run_bodesmith("fit " + kGains + " --beta-max 2 --max-error-db 0.1" + to).status, 0);
}

TEST(FitCommand, BadInputIsOneLineAndWritesNothing) {
  const TemporaryFolder folder;
  const std::string to = " -o " + (folder / "c.json").string();
  write_file(folder / "one.csv", "frequency_hz,gain\n20,1.1\n");
  write_file(folder / "zero.csv", "frequency_hz,gain\n1,1\n20,0\n");
  write_file(folder / "empty.csv", "");
  for (const std::string& arguments :
       {(folder / "one.csv").string(), (folder / "zero.csv").string(), (folder / "empty.csv").string(),
        (folder / "none.csv").string(), kGains + " --base-hz -1", kGains + " --beta-max 0",
        kGains + " --beta-positive", kGains + " --base-hz 100", kGains + " --wrong"}) {
    const auto result = run_bodesmith("fit " + arguments + to);
    EXPECT_EQ(result.status, 2) << arguments;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_FALSE(std::filesystem::exists(folder / "c.json"));
  }
  EXPECT_EQ(run_bodesmith("fit " + kGains).status, 2);
}

}  // namespace
}  // namespace bodesmith
