// Sections stand where models do, and several of them where one does.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "base/documents/document.hpp"
#include "base/files.hpp"
#include "run_program.hpp"
#include "signal/csv.hpp"
#include "signal/time_record.hpp"
#include "temporary_folder.hpp"

namespace bodesmith {
namespace {

struct SectionsAsModels : ::testing::Test {
  void SetUp() override {
    write("low.json",
          "\"gain\": 1, \"sections\": [{\"gain\": 100, \"zeros_rad_s\": [], \"poles_rad_s\": [[-50, 0]]}]");
    write(
        "lead.json",
        "\"gain\": 1, \"sections\": [{\"gain\": 4, \"zeros_rad_s\": [[-500, 0]], \"poles_rad_s\": [[-2000, 0]]}]");
  }
  void write(const std::string& name, const std::string& body) const {
    write_file(folder / name, "{\"schema\": \"bodesmith.sections/1\", " + body + "}");
  }
  std::string file(const std::string& name) const { return " '" + (folder / name).string() + "'"; }
  ProgramResult run(const std::string& arguments) const {
    ProgramResult out = run_bodesmith(arguments);
    EXPECT_EQ(out.status, 0) << arguments << "\n" << out.err;
    return out;
  }
  Csv table(const std::string& name) const { return Csv::parse(read_file(folder / name), name); }
  TemporaryFolder folder;
};

TEST_F(SectionsAsModels, AStepThroughALagIsAnExponential) {
  std::string csv = "time_s,u\n";
  for (int i = 0; i <= 200; ++i) csv += std::to_string(1e-3 * i) + ",1\n";
  write_file(folder / "u.csv", csv);
  run("simulate" + file("low.json") + " --input" + file("u.csv") + " -o" + file("y.csv"));
  Provenance from;
  const TimeRecord y = TimeRecord::read_csv(folder / "y.csv", from, true);
  for (std::size_t i = 0; i < y.size(); ++i)
    EXPECT_NEAR(y.y[i], 2.0 * (1.0 - std::exp(-50.0 * y.time_s(i))), 1e-9);
}

TEST_F(SectionsAsModels, AWrongGainIsNamedFromARecord) {
  write("weak.json",
        "\"gain\": 0.8, \"sections\": [{\"gain\": 100, \"zeros_rad_s\": [], \"poles_rad_s\": [[-50, 0]]}]");
  std::string csv = "time_s,u\n";
  for (int i = 0; i < 2000; ++i)
    csv +=
        std::to_string(1e-3 * i) + "," + std::to_string(std::sin(0.02 * i) + 0.3 * std::sin(0.13 * i)) + "\n";
  write_file(folder / "u.csv", csv);
  run("simulate" + file("low.json") + " --input" + file("u.csv") + " -o" + file("record.csv"));
  run("diagnose" + file("weak.json") + " --data" + file("record.csv") + " -o" + file("gap"));
  const Node found = read_document(folder / "gap/diagnosis.json", *std::make_unique<Provenance>());
  ASSERT_GE(found.at("steps").size(), 1u);
  EXPECT_EQ(found.at("steps")[0].at("effect").string(), "gain_error");
}

TEST_F(SectionsAsModels, SeveralFilesAreOneCircuitWhichBodeReads) {
  run("spice" + file("low.json") + file("lead.json") + " -o" + file("circuit"));
  run("bode" + file("low.json") + file("lead.json") + file("circuit/circuit.json") +
      " --series --from-hz 1 --to-hz 300 -o" + file("parts.csv"));
  const Csv parts = table("parts.csv");
  const auto low = parts.column("low_magnitude_db");
  const auto lead = parts.column("lead_magnitude_db");
  const auto built = parts.column("circuit_magnitude_db");
  ASSERT_EQ(low.size(), built.size());
  for (std::size_t i = 0; i < low.size(); ++i) EXPECT_NEAR(built[i], low[i] + lead[i], 0.2);
}

TEST_F(SectionsAsModels, OneYieldOfTwoFilesInSeries) {
  const ProgramResult done =
      run("yield" + file("low.json") + file("lead.json") + " --in-series --samples 500 --json");
  EXPECT_EQ(parse_json(done.out, "summary").at("designs").size(), 1u);
  EXPECT_EQ(parse_json(done.out, "summary").at("designs")[0].at("poles").number(), 2.0);
}

TEST_F(SectionsAsModels, APlanOfTwoFilesHasBothTheirPoles) {
  run("fpaa" + file("low.json") + file("lead.json") + " -o" + file("board"));
  run("bode" + file("board/plan.json") + file("low.json") + file("lead.json") +
      " --from-hz 1 --to-hz 100 -o" + file("board.csv"));
  const Csv both = table("board.csv");
  const auto plan = both.column("plan_magnitude_db");
  const auto low = both.column("low_magnitude_db");
  const auto lead = both.column("lead_magnitude_db");
  for (std::size_t i = 0; i < plan.size(); ++i) EXPECT_NEAR(plan[i], low[i] + lead[i], 0.5);
}

}  // namespace
}  // namespace bodesmith
