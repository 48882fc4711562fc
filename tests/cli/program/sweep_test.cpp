// `run --sweep`: a folder for each variant and one table, by however many processes, and resumed.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "base/documents/document.hpp"
#include "run_program.hpp"

namespace bodesmith {
namespace {

namespace fs = std::filesystem;

/// A low pass without board, so that a variant takes a few hundredths of a second.
void write_project(const fs::path& folder) {
  write_file(folder / "s.json",
             R"({"schema":"bodesmith.sections/1","gain":1,"sections":[{"gain":1e4,"zeros_rad_s":[],)"
             R"("poles_rad_s":[[-1e4,0]]}]})");
  write_file(folder / "p.toml",
             "schema = \"bodesmith.project/1\"\n[target]\nsections = \"s.json\"\n[hardware.circuit]\n"
             "resistors = \"E96\"\n[limits]\ncircuit_db = 0.5\n");
  write_file(
      folder / "v.toml",
      "schema = \"bodesmith.variants/1\"\n[[variant]]\nname = \"plain\"\n[[variant]]\nname = \"strict\"\n"
      "set.limits.circuit_db = 1e-9\n[grid]\n\"hardware.circuit.resistors\" = [\"E24\", \"exact\"]\n");
}

std::string sweep(const fs::path& folder, const std::string& more) {
  return fmt::format("run {0}/p.toml --sweep {0}/v.toml -o {0}/{1}", folder.string(), more);
}

Node read_json(const fs::path& file) {
  Provenance from;
  return read_document(file, from);
}

TEST(Sweep, EveryVariantHasItsFolderAndItsRow) {
  const TemporaryFolder folder;
  write_project(folder.path());
  const ProgramResult result = run_bodesmith(sweep(folder.path(), "out"));
  ASSERT_EQ(result.status, 1) << result.err;  // one misses its limit
  const Node json = read_json(folder / "out/sweep.json");
  const std::vector<std::string> names = {"plain", "strict", "resistors=E24", "resistors=exact"};
  ASSERT_EQ(json.at("variants").size(), names.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    const Node one = json.at("variants")[i];
    EXPECT_EQ(one.at("name").string(), names[i]);
    EXPECT_EQ(one.at("status").string(), i == 1 ? "limit_missed" : "done");
    // The table's figures are those of the variant's own report.
    const Node run = read_json(folder / "out" / names[i] / "run.json");
    EXPECT_EQ(one.at("figures").at("circuit_db").number(),
              run.at("circuit").at("error").at("max_magnitude_db").number());
  }
  EXPECT_NE(json.at("variants")[3].at("figures").at("circuit_db").number(),
            json.at("variants")[2].at("figures").at("circuit_db").number());
  const std::string csv = read_file(folder / "out/sweep.csv");
  EXPECT_EQ(csv.find("variant,limits.circuit_db,hardware.circuit.resistors,status,poles,"), 0U) << csv;
}

TEST(Sweep, ResumingRunsOnlyWhatChanged) {
  const TemporaryFolder folder;
  write_project(folder.path());
  ASSERT_EQ(run_bodesmith(sweep(folder.path(), "out")).status, 1);
  const auto made = fs::last_write_time(folder / "out/plain/run.json");
  write_file(folder / "out/strict/variant.json",
             "{\"schema\": \"bodesmith.variant/1\", \"changes\": \"others\"}");
  ASSERT_EQ(run_bodesmith(sweep(folder.path(), "out --resume")).status, 1);
  Node json = read_json(folder / "out/sweep.json");
  EXPECT_TRUE(json.at("variants")[0].at("kept").boolean());
  EXPECT_FALSE(json.at("variants")[1].at("kept").boolean());
  EXPECT_EQ(fs::last_write_time(folder / "out/plain/run.json"), made);
  // Another input file: nothing of the old sweep holds.
  write_file(folder / "s.json",
             R"({"schema":"bodesmith.sections/1","gain":1,"sections":[{"gain":2e4,"zeros_rad_s":[],)"
             R"("poles_rad_s":[[-2e4,0]]}]})");
  ASSERT_EQ(run_bodesmith(sweep(folder.path(), "out --resume")).status, 1);
  json = read_json(folder / "out/sweep.json");
  EXPECT_FALSE(json.at("variants")[0].at("kept").boolean());
}

TEST(Sweep, AnyNumberOfProcessesMakesTheSameTable) {
  if (run_shell("mpirun --version").status != 0) GTEST_SKIP() << "mpirun is not installed";
  const TemporaryFolder folder;
  write_project(folder.path());
  ASSERT_EQ(run_bodesmith(sweep(folder.path(), "one")).status, 1);
  const ProgramResult shared = run_shell(
      "OMPI_MCA_btl_vader_single_copy_mechanism=none mpirun --allow-run-as-root --oversubscribe -n 2 " +
      std::string(BODESMITH_PROGRAM) + " " + sweep(folder.path(), "two"));
  ASSERT_EQ(shared.status, 1) << shared.err;
  const Node one = read_json(folder / "one/sweep.json"), two = read_json(folder / "two/sweep.json");
  ASSERT_EQ(one.at("variants").size(), two.at("variants").size());
  for (std::size_t i = 0; i < one.at("variants").size(); ++i) {
    const Node a = one.at("variants")[i], b = two.at("variants")[i];
    EXPECT_EQ(a.at("name").string(), b.at("name").string());
    for (const auto& [key, value] : a.at("figures").members())
      EXPECT_EQ(value.number(), b.at("figures").at(key).number()) << key;
  }
}

TEST(Sweep, ASlipInAVariantIsSaidBeforeAnythingRuns) {
  const TemporaryFolder folder;
  write_project(folder.path());
  write_file(folder / "v.toml",
             "schema = \"bodesmith.variants/1\"\n[[variant]]\nname = \"good\"\n[[variant]]\nname = \"bad\"\n"
             "set.limits.circuit_db = -3\n");
  const ProgramResult result = run_bodesmith(sweep(folder.path(), "out"));
  EXPECT_EQ(result.status, 2);
  EXPECT_NE(result.err.find("v.toml:6: 'limits.circuit_db' is -3"), std::string::npos) << result.err;
  EXPECT_FALSE(fs::exists(folder / "out"));
}

TEST(Sweep, ADesignThatCannotBeMadeIsARow) {
  const TemporaryFolder folder;
  write_project(folder.path());
  write_file(folder / "v.toml",
             "schema = \"bodesmith.variants/1\"\n[[variant]]\nname = \"good\"\n[[variant]]\nname = \"none\"\n"
             "set.target.sections = \"slow.json\"\n");
  write_file(folder / "slow.json",
             R"({"schema":"bodesmith.sections/1","gain":1,"sections":[{"gain":1e-6,"zeros_rad_s":[],)"
             R"("poles_rad_s":[[-1e-6,0]]}]})");
  const ProgramResult result = run_bodesmith(sweep(folder.path(), "out"));
  EXPECT_EQ(result.status, 1) << result.err;
  const Node json = read_json(folder / "out/sweep.json");
  EXPECT_EQ(json.at("variants")[0].at("status").string(), "done");
  EXPECT_EQ(json.at("variants")[1].at("status").string(), "refused");
  EXPECT_NE(json.at("variants")[1].at("message").text().find("p.toml"), std::string::npos);
}

}  // namespace
}  // namespace bodesmith
