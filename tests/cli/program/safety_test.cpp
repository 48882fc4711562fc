// What a person would lose by a slip: inputs named as outputs, devices, full disks, half said errors.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "base/files.hpp"
#include "gap/diagnosis.hpp"
#include "run_program.hpp"

namespace bodesmith {
namespace {
namespace fs = std::filesystem;

constexpr const char* kSafeModel =
    "schema = \"bodesmith.model/1\"\n[[block]]\ntype = \"lowpass\"\ncorner_hz = 3.0\n";

std::string ramp_record() {
  std::string out = "time_s,u,y\n";
  for (int i = 0; i < 60; ++i)
    out +=
        std::to_string(0.01 * i) + "," + std::to_string(i % 20) + "," + std::to_string(2 * (i % 20)) + "\n";
  return out;
}

long line_count(const std::string& text) {
  return std::count(text.begin(), text.end(), '\n');
}

TEST(Safety, ABareCallSaysWhatIsMissing) {
  const ProgramResult result = run_bodesmith("");
  EXPECT_EQ(result.status, 2);
  EXPECT_EQ(line_count(result.err), 1) << result.err;
  EXPECT_NE(result.out.find("Subcommands"), std::string::npos);
}

TEST(Safety, AnInputIsNeverWrittenOver) {
  const TemporaryFolder folder;
  const auto path = [&](const char* name) { return (folder / name).string(); };
  const std::string example = std::string(BODESMITH_SOURCE_DIR) + "/examples/nanopositioner/gains.csv";
  write_file(folder / "m.toml", kSafeModel);
  write_file(folder / "r.csv", ramp_record());
  write_file(folder / "gains.csv", read_file(example));
  fs::create_symlink("r.csv", folder / "link.csv");
  fs::create_hard_link(folder / "m.toml", folder / "same.toml");
  const std::string sections = "fit " + path("gains.csv") + " --direct --order 2 -o ";
  for (const std::string& command :
       {"simulate " + path("m.toml") + " --input " + path("r.csv") + " -o " + path("r.csv"),
        "simulate " + path("m.toml") + " --input " + path("r.csv") + " -o " + path("link.csv"),
        "simulate " + path("m.toml") + " --input " + path("r.csv") + " -o " + path("same.toml"),
        "identify " + path("r.csv") + " --model linear -o " + path("r.csv"), sections + path("gains.csv"),
        "bode " + path("gains.csv") + " -o " + path("gains.csv")}) {
    const ProgramResult result = run_bodesmith(command);
    EXPECT_EQ(result.status, 2) << command;
    EXPECT_EQ(line_count(result.err), 1) << result.err;
    EXPECT_NE(result.err.find("it is an input"), std::string::npos) << result.err;
  }
  EXPECT_EQ(read_file(folder / "m.toml"), kSafeModel);
  EXPECT_EQ(read_file(folder / "r.csv"), ramp_record());
  EXPECT_EQ(read_file(folder / "gains.csv"), read_file(example));
}

TEST(Safety, OutputsMayBeDevicesAndMayNotBeTheSame) {
  const TemporaryFolder folder;
  write_file(folder / "m.toml", kSafeModel);
  write_file(folder / "r.csv", ramp_record());
  const std::string simulate =
      "simulate " + (folder / "m.toml").string() + " --input " + (folder / "r.csv").string();
  EXPECT_EQ(run_bodesmith(simulate + " -o /dev/null").status, 0);
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  EXPECT_EQ(run_bodesmith(simulate + " -o /dev/full").status, 2);
  const std::string same = (folder / "y.csv").string();
  const ProgramResult twice = run_bodesmith(simulate + " -o " + same + " --loops " + same);
  EXPECT_EQ(twice.status, 2);
  EXPECT_FALSE(fs::exists(same));
  // A summary that nobody can read is no result.
  const ProgramResult full = run_bodesmith(simulate + " -o " + same + " >/dev/full");
  EXPECT_EQ(full.status, 2);
  EXPECT_EQ(line_count(full.err), 1) << full.err;
}

TEST(Safety, AFileThatGrowsTooLongIsAFailedWrite) {
  const TemporaryFolder folder;
  write_file(folder / "m.toml", kSafeModel);
  const std::string simulate = std::string(BODESMITH_PROGRAM) + " simulate " + (folder / "m.toml").string() +
                               " --reference sine --duration-s 100 -o " + (folder / "y.csv").string();
  const ProgramResult result = run_shell("ulimit -f 8; " + simulate);
  EXPECT_EQ(result.status, 2) << result.err;
  int entries = 0;
  for ([[maybe_unused]] const auto& entry : fs::directory_iterator(folder.path())) ++entries;
  EXPECT_EQ(entries, 1) << "a temporary file was left behind";
}

TEST(Safety, TwoRunsIntoOneFolderAtOnceLeaveWholeFiles) {
  const TemporaryFolder folder;
  write_file(folder / "m.toml", kSafeModel);
  write_file(folder / "r.csv", ramp_record());
  const std::string simulate = std::string(BODESMITH_PROGRAM) + " simulate " + (folder / "m.toml").string() +
                               " --input " + (folder / "r.csv").string() + " -o ";
  const std::string out = (folder / "out/y.csv").string();
  const ProgramResult both = run_shell("(" + simulate + out + ") & P=$!; " + simulate + out +
                                       " && wait $P && " + simulate + (folder / "alone.csv").string());
  EXPECT_EQ(both.status, 0) << both.err;
  EXPECT_EQ(read_file(out), read_file(folder / "alone.csv"));
  int entries = 0;
  for ([[maybe_unused]] const auto& entry : fs::directory_iterator(folder / "out")) ++entries;
  EXPECT_EQ(entries, 1) << "a temporary file was left behind";
}

TEST(Safety, NumbersBeyondDoublesAreRefusedNotWritten) {
  const TemporaryFolder folder;
  std::string text = "time_s,u,y\n";
  for (int i = 0; i < 60; ++i)
    text +=
        std::to_string(0.01 * i) + "," + std::to_string(i % 20) + "e300," + std::to_string(i % 17) + "e300\n";
  write_file(folder / "r.csv", text);
  for (const char* model : {"linear", "prandtl_ishlinskii"}) {
    const ProgramResult result = run_bodesmith("identify " + (folder / "r.csv").string() + " --model " +
                                               model + " -o " + (folder / "m.toml").string());
    if (result.status == 0) {
      const std::string written = read_file(folder / "m.toml");
      EXPECT_EQ(written.find("nan"), std::string::npos) << written;
      EXPECT_EQ(written.find("inf"), std::string::npos) << written;
    } else {
      EXPECT_EQ(result.status, 2) << result.err;
      EXPECT_EQ(line_count(result.err), 1) << result.err;
    }
  }
}

TEST(Safety, AStoppedSearchHasAVerdictOfItsOwn) {
  gap::SearchResult result;
  EXPECT_EQ(gap::verdict_of(result), gap::Verdict::nothing_missing);
  result.stopped = true;
  EXPECT_EQ(to_string(gap::verdict_of(result)), "interrupted");
}

}  // namespace
}  // namespace bodesmith
