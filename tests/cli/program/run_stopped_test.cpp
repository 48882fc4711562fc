// A run that is stopped between its parts leaves a folder that says so; a clock that asks for forever is refused.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "base/files.hpp"
#include "run_program.hpp"
#include "texts.hpp"

namespace bodesmith {
namespace {
namespace fs = std::filesystem;

TEST(RunStopped, TheFolderSaysThatItIsUnfinished) {
  const TemporaryFolder folder;
  const std::string out = (folder / "out").string();
  const std::string mark = out + "/UNFINISHED.txt";
  // Of the bench's project the design's files stand after half of the time; seven frequencies make that seconds.
  const fs::path examples = BODESMITH_SOURCE_DIR "/examples";
  std::string project =
      replaced(read_file(examples / "bench/project.toml"), "\\.\\./", examples.string() + "/");
  project = replaced(project, "frequency_hz = \\[1, 100\\]", "frequency_hz = [1, 10, 20, 40, 60, 80, 100]");
  write_file(folder / "project.toml", project);
  const ProgramResult result =
      run_shell(fmt::format("BODESMITH_NGSPICE=/nowhere {} run {} -o {} & p=$!; "
                            "while [ ! -e {} ] && kill -0 $p; do sleep .02; done; kill -INT $p; wait $p",
                            BODESMITH_PROGRAM, (folder / "project.toml").string(), out, mark));
  EXPECT_EQ(result.status, 130) << result.err;
  EXPECT_TRUE(fs::exists(mark));
  EXPECT_TRUE(fs::exists(out + "/cascade.json"));
  EXPECT_FALSE(fs::exists(out + "/report.html"));
}

TEST(Unbounded, ClocksAndFrequenciesBelowWhatADoubleKeepsAreRefusedInOneLine) {
  const TemporaryFolder folder;
  write_file(folder / "u.csv", "time_s,u\n0,0\n0.001,1\n0.002,0\n");
  const auto answer = [&](const std::string& block) {
    write_file(folder / "m.toml", "schema = \"bodesmith.model/1\"\n[[block]]\n" + block);
    return run_bodesmith(fmt::format("simulate {} --input {} -o {}", (folder / "m.toml").string(),
                                     (folder / "u.csv").string(), (folder / "y.csv").string()));
  };
  for (const std::string block :
       {"type = \"lowpass\"\ncorner_hz = 1e-320\n", "type = \"sample_hold\"\nclock_hz = 1e-310\n",
        "type = \"sample_hold\"\nclock_hz = 1e14\n"}) {
    const ProgramResult result = answer(block);
    EXPECT_EQ(result.status, 2) << block << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  }
  write_file(folder / "p.csv", "frequency_hz,gain\n1e-315,1\n10,2\n100,3\n");
  const ProgramResult fit =
      run_bodesmith(fmt::format("fit {} -o {}", (folder / "p.csv").string(), (folder / "c.json").string()));
  EXPECT_EQ(fit.status, 2) << fit.err;
  EXPECT_NE(fit.err.find("p.csv:2:"), std::string::npos) << fit.err;
}

}  // namespace
}  // namespace bodesmith
