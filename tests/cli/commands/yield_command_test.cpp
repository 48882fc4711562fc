#include <gtest/gtest.h>

#include "base/documents/document.hpp"
#include "base/files.hpp"
#include "run_program.hpp"

namespace bodesmith {
namespace {

const char* const kYieldSections = R"({"schema":"bodesmith.sections/1","gain":1.0,"sections":[
{"gain":0.918,"zeros_rad_s":[[-48.79,0],[-14.8,0]],"poles_rad_s":[[-47.49,0],[-13.99,0]]},
{"gain":1.885,"zeros_rad_s":[[-107.6,0],[-63.68,0]],"poles_rad_s":[[-126.4,0],[-102.2,0]]}]})";

/// Without the line that says how long it took.
std::string without_timing(const std::string& text) {
  std::string out;
  size_t at = 0;
  while (at < text.size()) {
    const size_t end = std::min(text.find('\n', at), text.size() - 1);
    const std::string line = text.substr(at, end - at + 1);
    if (line.find("compute") == std::string::npos) out += line;
    at = end + 1;
  }
  return out;
}

struct Job {
  TemporaryFolder folder;
  Job() { write_file(folder / "sections.json", kYieldSections); }
  std::string arguments(const std::string& more, const std::string& out) const {
    return "yield " + (folder / "sections.json").string() + " " + more + " -o " + (folder / out).string();
  }
  std::string result(const std::string& out) const { return without_timing(read_file(folder / out)); }
};

TEST(YieldCommand, SameBytesForThreadsAndAgain) {
  const Job job;
  const std::string more = "--samples 20000 --count 10 --limit-db 0.5 --distribution gaussian";
  ASSERT_EQ(run_bodesmith(job.arguments(more + " --threads 1", "a.json")).status, 0);
  ASSERT_EQ(run_bodesmith(job.arguments(more + " --threads 3", "b.json")).status, 0);
  EXPECT_EQ(job.result("a.json"), job.result("b.json"));
  const Node node = parse_json(read_file(job.folder / "a.json"), "a.json");
  node.expect_schema("yield");
  const Node design = node.at("designs")[0];
  EXPECT_GT(design.at("worst_db").at("p95").number(), 0.05);
  EXPECT_GT(design.at("to_buy").size(), 3u);
}

TEST(YieldCommand, SameBytesUnderMpi) {
  if (run_shell("mpirun --version").status != 0) GTEST_SKIP() << "mpirun is not installed";
  const Job job;
  const std::string more = "--samples 140000 --count 8";
  ASSERT_EQ(run_bodesmith(job.arguments(more, "alone.json")).status, 0);
  const ProgramResult run = run_shell(std::string("OMPI_MCA_btl_vader_single_copy_mechanism=none mpirun ") +
                                      "--allow-run-as-root --oversubscribe -n 3 " + BODESMITH_PROGRAM + " " +
                                      job.arguments(more, "mpi.json"));
  if (run.err.find("built without MPI") != std::string::npos) GTEST_SKIP() << "built without MPI";
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(job.result("mpi.json"), job.result("alone.json"));
}

TEST(YieldCommand, ARunKilledHalfWayIsResumedToTheSameBytes) {
  const Job job;
  const std::string more = "--samples 1400000 --count 12 --threads 1";
  ASSERT_EQ(run_bodesmith(job.arguments(more, "clean.json")).status, 0);
  const std::string checkpoint = (job.folder / "killed.json.checkpoint1").string();
  // Killed as soon as a checkpoint stands.
  const ProgramResult killed = run_shell(
      std::string(BODESMITH_PROGRAM) + " " + job.arguments(more, "killed.json") + " & P=$!; while [ ! -e " +
      checkpoint + " ] && kill -0 $P 2>/dev/null; do sleep 0.02; done; kill -9 $P; wait $P; exit 0");
  EXPECT_EQ(killed.status, 0);
  if (!std::filesystem::exists(checkpoint)) GTEST_SKIP() << "finished before its first checkpoint";
  EXPECT_FALSE(std::filesystem::exists(job.folder / "killed.json"));
  const ProgramResult again = run_bodesmith(job.arguments(more, "killed.json"));
  ASSERT_EQ(again.status, 0) << again.err;
  std::string resumed = job.result("killed.json");
  EXPECT_EQ(resumed, job.result("clean.json"));
  EXPECT_FALSE(std::filesystem::exists(checkpoint));
}

TEST(YieldCommand, ComparesDesignsAndKeepsTheLimit) {
  const Job job;
  const std::string file = (job.folder / "sections.json").string();
  const ProgramResult run =
      run_bodesmith("yield " + file + " " + file +
                    " --samples 5000 --count 5 --limit-db 0.01 --min-yield-percent 99 --json");
  EXPECT_EQ(run.status, 1) << run.err;
  EXPECT_EQ(parse_json(run.out, "stdout").at("designs").size(), 2u);
  // What to buy is said where something on the list is good enough.
  const auto said = [&](const std::string& limit) {
    return run_bodesmith("yield " + file + " --samples 100 --count 5 --limit-db " + limit).out;
  };
  EXPECT_NE(said("3").find("to keep 95 % within 3 dB, buy "), std::string::npos);
  EXPECT_NE(said("1e-6").find("no tolerance on the list keeps 95 % of the circuits within 1e-06 dB"),
            std::string::npos);
}

TEST(YieldCommand, BadInputIsOneLine) {
  const Job job;
  const std::string file = (job.folder / "sections.json").string();
  write_file(job.folder / "plan.json", R"({"schema":"bodesmith.fpaa_plan/1","chips":[]})");
  for (const std::string& arguments :
       {std::string("yield"), "yield " + file + " --samples 0", "yield " + file + " --distribution cauchy",
        "yield " + file + " --resistor-percent -1", "yield " + file + " --count 0",
        "yield " + file + " --from-hz 5 --to-hz 1", "yield " + (job.folder / "plan.json").string(),
        "yield " + file + " --min-yield-percent 5"}) {
    const ProgramResult run = run_bodesmith(arguments);
    EXPECT_EQ(run.status, 2) << arguments << run.err;
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << arguments << run.err;
  }
}

// A notch and an elliptic stop band are next to 0 at frequencies of the grid: these are left out and named.
TEST(YieldCommand, ResponsesWithZerosOnTheGridAreAnswered) {
  const TemporaryFolder folder;
  const std::string sections = (folder / "e.json").string(), out = (folder / "y.json").string();
  ASSERT_EQ(
      run_bodesmith(
          "design lowpass --family elliptic --order 4 --corner-hz 1000 --ripple-db 0.5 --stop-db 40 -o " +
          sections)
          .status,
      0);
  const ProgramResult run = run_bodesmith("yield " + sections + " --samples 2000 -o " + out);
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_NE(run.out.find("where the response is below -60 dB of its largest"), std::string::npos) << run.out;
  const Node json = parse_json(read_file(out), out);
  const std::vector<double> left_out = json.at("left_out_hz").numbers();
  EXPECT_GE(left_out.size(), 1u);
  EXPECT_NEAR(left_out.back(), 3861.4, 1.0);
  // Finer than the 60 of a response that does not turn.
  EXPECT_GE(json.at("designs")[0].at("frequency_hz").numbers().size(), 70u);
  const ProgramResult only =
      run_bodesmith("yield " + sections + " --samples 2000 --count 1 --from-hz 3861.4 -o " + out);
  EXPECT_EQ(only.status, 0) << only.err;
}

}  // namespace
}  // namespace bodesmith
