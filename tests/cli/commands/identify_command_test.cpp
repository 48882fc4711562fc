#include <gtest/gtest.h>

#include <cmath>

#include "base/documents/json.hpp"
#include "base/files.hpp"
#include "hysteresis/model_type.hpp"
#include "run_program.hpp"
#include "signal/csv.hpp"
#include "texts.hpp"

namespace bodesmith {
namespace {

/// A record of a play bank: the truth is known.
void write_record(const std::filesystem::path& path, double modulation) {
  hysteresis::Parameters values;
  values.set("r", {0.0, 0.2, 0.4, 0.6}).set("w", {1.0, 0.2, 0.3, 0.1}).set("offset", 3.0);
  const auto op = make_operator(hysteresis::make_model("prandtl_ishlinskii", values));
  std::vector<double> t, u, y;
  for (int i = 0; i < 3000; ++i) {
    t.push_back(i * 1e-3);
    const double envelope = i < 500 ? 1.0 : 1.0 - modulation * (0.5 - 0.5 * std::cos(0.007 * (i - 500)));
    u.push_back(envelope * (1.0 - std::cos(0.05 * i)));
    y.push_back(i == 0 ? op->reset(u.back()) : op->step(u.back(), 1e-3));
  }
  CsvWriter csv;
  csv.add("time_s", t);
  csv.add("u", u);
  csv.add("y", y);
  write_file(path, csv.text());
}

TEST(Identify, WritesAModelThatSimulatesAndCompensates) {
  const TemporaryFolder folder;
  write_record(folder / "train.csv", 0.5);
  write_record(folder / "test.csv", 0.9);
  const std::string model = (folder / "model.toml").string();
  const ProgramResult result =
      run_bodesmith("identify " + (folder / "train.csv").string() + " --model prandtl_ishlinskii --holdout " +
                    (folder / "test.csv").string() + " --json -o " + model);
  ASSERT_EQ(result.status, 0) << result.err;
  const Json summary = parsed(result.out);
  EXPECT_EQ(summary["schema"], "bodesmith.identification/1");
  EXPECT_LT(summary["training"]["rms_percent_of_range"], 1e-3);
  EXPECT_LT(summary["holdout"]["rms_percent_of_range"], 1e-2);
  EXPECT_EQ(summary["inputs"].size(), 2u);
  EXPECT_GE(summary["timing_s"]["compute"], 0.0);
  // What diagnose may refit, and what the model was fitted to.
  EXPECT_NE(read_file(model).find("free = ["), std::string::npos);
  EXPECT_NE(read_file(model).find("[trained]"), std::string::npos);
  // The block stands in a contract's model.toml and simulates to the same output.
  const ProgramResult simulated =
      run_bodesmith("simulate " + model + " --input " + (folder / "train.csv").string() + " -o " +
                    (folder / "y.csv").string());
  ASSERT_EQ(simulated.status, 0) << simulated.err;
  const Csv truth = Csv::parse(read_file(folder / "train.csv"), "train");
  const Csv got = Csv::parse(read_file(folder / "y.csv"), "y");
  double worst = 0.0;
  for (std::size_t i = 0; i < truth.rows(); ++i)
    worst = std::max(worst, std::abs(truth.column("y")[i] - got.column("y")[i]));
  EXPECT_LT(worst, 1e-3);
  // And its inverse tracks.
  CsvWriter reference;
  std::vector<double> t, r;
  for (int i = 0; i < 1000; ++i) {
    t.push_back(i * 1e-3);
    r.push_back(3.5 + 0.4 * std::sin(0.01 * i));
  }
  reference.add("time_s", t);
  reference.add("r", r);
  write_file(folder / "r.csv", reference.text());
  const ProgramResult drive =
      run_bodesmith("compensate " + model + " --reference " + (folder / "r.csv").string() + " --json -o " +
                    (folder / "drive.csv").string());
  ASSERT_EQ(drive.status, 0) << drive.err;
  EXPECT_LT(parsed(drive.out)["predicted_error"]["rms_percent_of_range"], 1e-9);
  const Csv written = Csv::parse(read_file(folder / "drive.csv"), "drive");
  EXPECT_EQ(written.names(), (std::vector<std::string>{"time_s", "r", "u"}));
  EXPECT_EQ(written.column("r")[10], r[10]);
}

TEST(Identify, LimitMissedIsStatusOneAndTheModelIsStillWritten) {
  const TemporaryFolder folder;
  write_record(folder / "train.csv", 0.5);
  const ProgramResult result =
      run_bodesmith("identify " + (folder / "train.csv").string() +
                    " --model linear --max-error-percent 0.1 -o " + (folder / "m.toml").string());
  EXPECT_EQ(result.status, 1);
  EXPECT_NE(result.out.find("NOT met"), std::string::npos);
  EXPECT_TRUE(std::filesystem::exists(folder / "m.toml"));
}

TEST(Identify, BadUsageSaysWhatIsExpected) {
  const TemporaryFolder folder;
  write_record(folder / "train.csv", 0.5);
  const std::string train = (folder / "train.csv").string();
  const std::string out = " -o " + (folder / "m.toml").string();
  for (const char* bad :
       {"", " --model wiggle", " --model linear --delay soon", " --model linear --skip-s 100",
        " --model linear --method other", " --model linear --size -3"}) {
    const ProgramResult result = run_bodesmith("identify " + train + bad + out);
    EXPECT_EQ(result.status, 2) << bad;
    EXPECT_NE(result.err.find("expected"), std::string::npos) << bad << ": " << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  }
  write_file(folder / "still.csv", "time_s,u,y\n0,1,1\n1,1,2\n2,1,3\n");
  const ProgramResult still =
      run_bodesmith("identify " + (folder / "still.csv").string() + " --model bouc_wen" + out);
  EXPECT_EQ(still.status, 2);
  EXPECT_NE(still.err.find("still.csv"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder / "m.toml"));
}

TEST(Identify, BothMethodsInOneTable) {
  const TemporaryFolder folder;
  write_record(folder / "train.csv", 0.5);
  const ProgramResult result =
      run_bodesmith("identify " + (folder / "train.csv").string() +
                    " --model krasnoselskii_pokrovskii --size 12 --effort 0.2 --method both --json -o " +
                    (folder / "m.toml").string());
  ASSERT_EQ(result.status, 0) << result.err;
  const Json summary = parsed(result.out);
  ASSERT_EQ(summary["models"].size(), 2u);
  EXPECT_EQ(summary["models"][0]["model"], "krasnoselskii_pokrovskii (paper)");
  EXPECT_GT(summary["models"][0]["training"]["rms"], summary["models"][1]["training"]["rms"]);
  EXPECT_EQ(summary["chosen"], "krasnoselskii_pokrovskii (best)");
}

TEST(Identify, RealPiezoRecordLadder) {
  const std::string data = std::string(BODESMITH_SOURCE_DIR) + "/../shared/data/";
  if (!std::filesystem::exists(data + "picma_train.csv")) GTEST_SKIP() << "the measured records are not here";
  const TemporaryFolder folder;
  const auto holdout = [&](const std::string& model) {
    const ProgramResult result = run_bodesmith("identify " + data + "picma_train.csv --holdout " + data +
                                               "picma_holdout.csv --skip-s 1 --model " + model +
                                               " --json -o " + (folder / "m.toml").string());
    EXPECT_EQ(result.status, 0) << result.err;
    return parsed(result.out)["holdout"];
  };
  const Json linear = holdout("linear");
  const Json bank = holdout("prandtl_ishlinskii");
  const Json with_delay = holdout("prandtl_ishlinskii --delay find");
  EXPECT_NEAR(linear["rms"], 2.55, 0.1);
  EXPECT_LT(bank["rms"], 1.0);
  EXPECT_LT(with_delay["rms"], 0.75);
  EXPECT_LT(with_delay["rms_free_offset"], 0.41);
}

}  // namespace
}  // namespace bodesmith
