// A user's own netlist in the commands that take circuits.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "base/documents/document.hpp"
#include "base/files.hpp"
#include "run_program.hpp"

namespace bodesmith {
namespace {

constexpr const char* kOwn = R"(* two poles
.subckt TWO X Y
R1 x m 10k
R2 m y 47k
C2 m y 330pF
E1 y 0 0 m {a}
.param a=1meg
.ends
)";

std::vector<double> numbers_of(const std::string& csv) {
  std::vector<double> out;
  for (std::size_t at = csv.find('\n') + 1; at < csv.size(); at = csv.find_first_of(",\n", at) + 1)
    out.push_back(std::stod(csv.substr(at)));
  return out;
}

TEST(OwnNetlist, ItsResponseIsThatOfNgspice) {
  if (run_shell("ngspice --version").status != 0) GTEST_SKIP() << "ngspice is not installed";
  const TemporaryFolder folder;
  write_file(folder / "two.sub", kOwn);
  const std::string bode = std::string(BODESMITH_PROGRAM) + " bode " + (folder / "two.sub").string() +
                           " --from-hz 10 --to-hz 1e6 --count 9";
  const ProgramResult by_ngspice = run_shell(bode),
                      by_itself = run_shell("BODESMITH_NGSPICE=/nowhere " + bode);
  ASSERT_EQ(by_ngspice.status, 0) << by_ngspice.err;
  ASSERT_EQ(by_itself.status, 0) << by_itself.err;
  const std::vector<double> a = numbers_of(by_ngspice.out), b = numbers_of(by_itself.out);
  ASSERT_EQ(a.size(), 27u);
  ASSERT_EQ(b.size(), 27u);
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], 1e-6 * (1.0 + std::abs(a[i])));
}

/// The parts are the same, drawn by the same numbers: by the stages' equations and by the netlist.
TEST(OwnNetlist, ItsYieldIsThatOfTheCircuitThatItIs) {
  const TemporaryFolder folder;
  const std::string at = folder.path().string();
  ASSERT_EQ(
      run_bodesmith("design lowpass --family butterworth --order 3 --corner-hz 1e3 -o " + at + "/s.json")
          .status,
      0);
  ASSERT_EQ(run_bodesmith("spice " + at + "/s.json --opamp ideal --series exact -o " + at + "/spice").status,
            0);
  const auto yield = [&](const std::string& file) {
    const ProgramResult run =
        run_bodesmith("yield " + at + "/spice/" + file +
                      " --samples 2000 --from-hz 10 --to-hz 1e4 --count 12 -o " + at + "/y.json");
    EXPECT_EQ(run.status, 0) << run.err;
    EXPECT_EQ(run.out.find("3 poles, ") != std::string::npos, file == "circuit.json") << run.out;
    const Node design = parse_json(read_file(folder / "y.json"), "y.json").at("designs")[0];
    return std::vector<double>{design.at("worst_db").at("p95").number(),
                               design.at("worst_deg").at("p95").number(),
                               design.at("worst_db").at("max").number()};
  };
  const std::vector<double> by_stages = yield("circuit.json"), by_netlist = yield("compensator.sub");
  for (std::size_t i = 0; i < by_stages.size(); ++i)
    EXPECT_NEAR(by_netlist[i], by_stages[i], 2e-3 * by_stages[i]) << i;
}

TEST(OwnNetlist, ItsWrongPartIsNamed) {
  const TemporaryFolder folder;
  const std::string at = folder.path().string();
  const std::string text = kOwn;
  write_file(folder / "two.sub", text);
  write_file(folder / "built.sub", std::string(text).replace(text.find("330pF"), 5, "400pF"));
  ASSERT_EQ(run_shell("BODESMITH_NGSPICE=/nowhere " BODESMITH_PROGRAM " bode " + at +
                      "/built.sub --from-hz 100 --to-hz 1e6 --count 60 -o " + at + "/m.csv")
                .status,
            0);
  const ProgramResult run = run_bodesmith("diagnose --circuit " + at + "/two.sub --data " + at +
                                          "/m.csv --noise-db .01 --noise-deg .1 -o " + at + "/out");
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(run.out, testing::HasSubstr("C2 is 400 pF instead of 330 pF"));
}

TEST(OwnNetlist, WhatIsNotReadIsOneLine) {
  const TemporaryFolder folder;
  write_file(folder / "own.sub", ".subckt t in out\nR1 in out 1k\nL1 out 0 1m\n.ends\n");
  write_file(folder / "bare.sub", ".subckt t in out\nR1 in out 1k\n.ends\n");
  for (const char* name : {"own.sub", "bare.sub"}) {
    const ProgramResult run =
        run_bodesmith("yield " + (folder / name).string() + " -o " + (folder / "y.json").string());
    EXPECT_EQ(run.status, 2);
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    EXPECT_THAT(run.err, testing::HasSubstr(name));
    EXPECT_FALSE(std::filesystem::exists(folder / "y.json"));
  }
}

}  // namespace
}  // namespace bodesmith
