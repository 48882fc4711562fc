#include <gtest/gtest.h>

#include "base/files.hpp"
#include "run_program.hpp"

namespace bodesmith {
namespace {

constexpr const char* kModel = R"(schema = "bodesmith.model/1"
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
  write_file(folder / "m.toml", kModel);
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
  std::string text = kModel;
  text.replace(text.find("0.3546, "), 8, "");
  ProgramResult result = run(text);
  EXPECT_EQ(result.status, 2);
  EXPECT_NE(result.err.find("m.toml:5"), std::string::npos) << result.err;
  text = kModel;
  text.replace(text.find("ascending"), 9, "rising");
  result = run(text);
  EXPECT_EQ(result.status, 2);
  EXPECT_NE(result.err.find("m.toml:7"), std::string::npos) << result.err;
  text = kModel;
  text.replace(text.find("polynomial_hysteresis"), 21, "resonator");
  result = run(text);
  EXPECT_EQ(result.status, 2);
  EXPECT_NE(result.err.find("m.toml:6"), std::string::npos) << result.err;
  EXPECT_FALSE(std::filesystem::exists(folder / "drive.csv"));
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
  EXPECT_NE(result.err.find("more than the model can reach"), std::string::npos) << result.err;
}

}  // namespace
}  // namespace bodesmith
