#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/documents/json.hpp"
#include "base/files.hpp"
#include "run_program.hpp"
#include "signal/csv.hpp"
#include "signal/statistics.hpp"
#include "texts.hpp"

namespace bodesmith {
namespace {

constexpr const char* kCompensatedModel = R"(schema = "bodesmith.model/1"
[[block]]
type = "gain"
gain = 0.1
[[block]]
type = "polynomial_hysteresis"
ascending = [0.3546, -0.6433, 0.2887]
descending = [-0.2398, 0.0838, 0.156]
[[block]]
type = "gain"
gain = 6.92
)";

constexpr const char* kReference = "time_s,r\n0,0\n0.1,1\n0.2,3\n0.3,5\n0.4,6.92\n0.5,4\n0.6,2\n0.7,0\n";

TEST(Compensate, PolynomialBranchesAreInverted) {
  const TemporaryFolder folder;
  write_file(folder / "m.toml", kCompensatedModel);
  write_file(folder / "r.csv", kReference);
  const ProgramResult result =
      run_bodesmith("compensate " + (folder / "m.toml").string() + " --reference " +
                    (folder / "r.csv").string() + " -o " + (folder / "drive.csv").string());
  ASSERT_EQ(result.status, 0) << result.err;
  const std::string csv = read_file(folder / "drive.csv");
  EXPECT_EQ(csv.substr(0, csv.find('\n')), "time_s,r,u");
}

TEST(Compensate, NamesFileAndLineOfWhatIsWrong) {
  const TemporaryFolder folder;
  write_file(folder / "r.csv", kReference);
  const auto run = [&](std::string text) {
    write_file(folder / "m.toml", std::move(text));
    return run_bodesmith("compensate " + (folder / "m.toml").string() + " --reference " +
                         (folder / "r.csv").string() + " -o " + (folder / "drive.csv").string());
  };
  std::string text = kCompensatedModel;
  text.replace(text.find("0.3546, "), 8, "");
  ProgramResult result = run(text);
  EXPECT_EQ(result.status, 2);
  EXPECT_NE(result.err.find("m.toml:5"), std::string::npos) << result.err;
  text = kCompensatedModel;
  text.replace(text.find("ascending"), 9, "rising");
  result = run(text);
  EXPECT_EQ(result.status, 2);
  EXPECT_NE(result.err.find("m.toml:7"), std::string::npos) << result.err;
  text = kCompensatedModel;
  text.replace(text.find("polynomial_hysteresis"), 21, "no_such_thing");
  result = run(text);
  EXPECT_EQ(result.status, 2);
  EXPECT_NE(result.err.find("m.toml:6"), std::string::npos) << result.err;
  EXPECT_FALSE(std::filesystem::exists(folder / "drive.csv"));
  // Squares of what is beyond 1e50 would be infinite in the figures.
  write_file(folder / "r.csv", "time_s,r\n0,0\n0.1,1e200\n0.2,0\n0.3,0.5\n");
  result = run(kCompensatedModel);
  EXPECT_EQ(result.status, 2);
  EXPECT_NE(result.err.find("1e+200"), std::string::npos) << result.err;
}

TEST(Compensate, OutOfReachIsSaidAndLimitIsStatusOne) {
  const TemporaryFolder folder;
  write_file(folder / "m.toml", R"(schema = "bodesmith.model/1"
[[block]]
type = "preisach"
u_min = 0.0
u_max = 1.0
w = [0.5, 0.2, 0.5]
)");
  write_file(folder / "r.csv", kReference);
  const ProgramResult result = run_bodesmith("compensate " + (folder / "m.toml").string() + " --reference " +
                                             (folder / "r.csv").string() + " --max-error-percent 1 -o " +
                                             (folder / "drive.csv").string());
  EXPECT_EQ(result.status, 1);
  EXPECT_NE(result.err.find("exceed what the model can reach"), std::string::npos) << result.err;
}

std::string waves() {
  std::string out = "time_s,r\n";
  for (int i = 0; i < 900; ++i)
    out += fmt::format("{},{}\n", 0.005 * i, 0.5 - 0.3 * std::cos(0.03 * i) - 0.1 * std::cos(0.071 * i));
  return out;
}

/// What a reader of both files finds: y of `simulated` less r of `drive`, from row `first` on.
ErrorFigures error_between(const std::filesystem::path& drive, const std::filesystem::path& simulated,
                           std::size_t first) {
  Provenance from;
  return error_figures(Csv::read(simulated, from).column("y"), Csv::read(drive, from).column("r"), first);
}

TEST(Compensate, TheErrorStatedIsThatOfSimulateOnTheDrive) {
  const TemporaryFolder folder;
  write_file(folder / "m.toml", R"(schema = "bodesmith.model/1"
[[block]]
type = "lowpass"
corner_hz = 9.0
[[block]]
type = "prandtl_ishlinskii"
r = [0.0, 0.1, 0.3]
w = [1.0, 0.2, 0.15]
[[block]]
type = "resonator"
natural_frequency_hz = 12.0
damping_ratio = 0.1
cubic = 0.2
[[block]]
type = "bouc_wen"
k = 1.0
A = 0.5
beta = 1.3
gamma = 0.9
[[block]]
type = "delay"
delay_s = 0.0123
)");
  write_file(folder / "r.csv", waves());
  const std::string drive = (folder / "drive.csv").string();
  for (const std::string start : {"equilibrium", "zero"}) {
    const ProgramResult found =
        run_bodesmith("compensate " + (folder / "m.toml").string() + " --reference " +
                      (folder / "r.csv").string() + " --json --upper 1.5 --start " + start + " -o " + drive);
    ASSERT_EQ(found.status, 0) << found.err;
    const Json json = parsed(found.out);
    ASSERT_EQ(run_bodesmith("simulate " + (folder / "m.toml").string() + " --input " + drive + " --start " +
                            start + " -o " + (folder / "y.csv").string())
                  .status,
              0);
    EXPECT_EQ(error_between(drive, folder / "y.csv", 0).rms,
              json["predicted_error_whole"]["rms"].get<double>());
    const double from_s = json["predicted_error"]["from_s"].get<double>();
    const auto first = static_cast<std::size_t>(std::lround(from_s / 0.005));
    EXPECT_GE(first, 1u);
    EXPECT_EQ(error_between(drive, folder / "y.csv", first).rms,
              json["predicted_error"]["rms"].get<double>());
    EXPECT_LT(json["predicted_error"]["rms_percent_of_range"].get<double>(), 1.0);
  }
}

TEST(Compensate, AReferenceThatIsMadeRunsOverNineTenthsOfTheRecords) {
  const TemporaryFolder folder;
  write_file(folder / "m.toml", R"(schema = "bodesmith.model/1"
[[block]]
type = "gain"
gain = 2.0
offset = 1.0
[trained]
input_lower = 0.0
input_upper = 10.0
input_max_rate_per_s = 1e4
input_from_hz = 0.1
input_to_hz = 1e4
output_lower = 1.0
output_upper = 21.0
training_rms = 0.03
training_percent_of_range = 0.15
holdout_rms = 0.04
)");
  const std::string drive = (folder / "u.csv").string();
  const auto ask = [&](const std::string& more) {
    return run_bodesmith("compensate " + (folder / "m.toml").string() +
                         " --reference sine --frequency-hz 2 --json " + more + " -o " + drive);
  };
  const ProgramResult run = ask("");
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_NE(run.err.find("the reference runs from 2 to 20, nine tenths"), std::string::npos) << run.err;
  Provenance from;
  const Csv made = Csv::read(drive, from);
  EXPECT_NEAR(std::ranges::max(made.column("r")), 20.0, 1e-3);
  EXPECT_NEAR(std::ranges::min(made.column("r")), 2.0, 1e-3);
  double fastest = 0.0;
  for (std::size_t i = 0; i < made.rows(); ++i) {
    EXPECT_NEAR(made.column("u")[i], 0.5 * (made.column("r")[i] - 1.0), 1e-9);
    if (i > 0)
      fastest = std::max(fastest, std::abs(made.column("u")[i] - made.column("u")[i - 1]) /
                                      (made.column("time_s")[i] - made.column("time_s")[i - 1]));
  }
  const Json json = parsed(run.out);
  EXPECT_NEAR(json["drive"]["upper"].get<double>(), 9.5, 1e-3);
  EXPECT_NEAR(json["drive"]["max_rate_per_s"].get<double>(), fastest, 1e-6 * fastest);
  // Of an exact inverse what is left is what the model missed on held-out records, of 18 from end to end.
  EXPECT_NEAR(json["expected_error"]["rms"].get<double>(), 0.04, 1e-9);
  EXPECT_NEAR(json["expected_error"]["rms_percent_of_range"].get<double>(), 4.0 / 18.0, 1e-4);
  // The last of three periods counts, or all from --skip-s on.
  EXPECT_NEAR(json["predicted_error"]["from_s"].get<double>(), 1.0, 2e-3);
  EXPECT_NEAR(parsed(ask("--skip-s 0.4").out)["predicted_error"]["from_s"].get<double>(), 0.4, 2e-3);
  EXPECT_EQ(ask("--amplitude 1 --offset 5").err.find("nine tenths"), std::string::npos);
  // A file that is not there is no kind of reference.
  const ProgramResult missing =
      run_bodesmith("compensate " + (folder / "m.toml").string() + " --reference sines -o " + drive);
  EXPECT_EQ(missing.status, 2);
  EXPECT_NE(missing.err.find("sines"), std::string::npos) << missing.err;
  EXPECT_EQ(missing.err.find("expected one of"), std::string::npos) << missing.err;
}

TEST(Compensate, APiezoModelSaysWhatItWasTrainedOnAndWhatToExpect) {
  const std::filesystem::path data = std::filesystem::path(BODESMITH_SOURCE_DIR) / "../shared/data";
  if (!std::filesystem::exists(data / "picma_train.csv")) GTEST_SKIP() << "no ../shared/data";
  const TemporaryFolder folder;
  const std::string model = (folder / "m.toml").string();
  const ProgramResult fitted = run_bodesmith("identify " + (data / "picma_train.csv").string() +
                                             " --model prandtl_ishlinskii --holdout " +
                                             (data / "picma_holdout.csv").string() + " --json -o " + model);
  ASSERT_EQ(fitted.status, 0) << fitted.err;
  const double missed = parsed(fitted.out)["holdout"]["rms"].get<double>();
  Provenance from;
  const Csv held_out = Csv::read(data / "picma_holdout.csv", from);
  CsvWriter reference;
  reference.add("time_s", held_out.column("time_s"));
  reference.add("r", held_out.column("y"));
  write_file(folder / "r.csv", reference.text());
  const auto ask = [&](const std::string& options) {
    return run_bodesmith("compensate " + model + " --reference " + (folder / "r.csv").string() + " --json " +
                         options + " -o " + (folder / "drive.csv").string());
  };
  const ProgramResult found = ask("");
  ASSERT_EQ(found.status, 0) << found.err;
  const Json json = parsed(found.out);
  // The inverse's own error is nothing beside the model's, and what to expect is about that.
  EXPECT_LT(json["predicted_error"]["rms"].get<double>(), 1e-3 * missed);
  EXPECT_NEAR(json["expected_error"]["rms"].get<double>(), missed, 1e-3 * missed);
  EXPECT_NE(found.err.find("beyond what the model was fitted to"), std::string::npos) << found.err;
  // Beyond the stroke: said, and a limit keeps the drive where the model knows the stage.
  write_file(folder / "r.csv", "time_s,r\n0,-120\n0.1,-100\n0.2,-60\n0.3,-20\n0.4,-60\n0.5,-120\n");
  const ProgramResult far = ask("--upper 3.6 --lower 0");
  ASSERT_EQ(far.status, 0) << far.err;
  EXPECT_NE(far.err.find("the reference goes up to"), std::string::npos) << far.err;
  EXPECT_GT(parsed(far.out)["out_of_reach"].get<int>(), 0);
  const Csv drive = Csv::read(folder / "drive.csv", from);
  for (const double u : drive.column("u")) EXPECT_LE(u, 3.6);
}

}  // namespace
}  // namespace bodesmith
