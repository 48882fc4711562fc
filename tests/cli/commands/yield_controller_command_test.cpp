#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/documents/document.hpp"
#include "run_program.hpp"

namespace bodesmith {
namespace {

using ::testing::HasSubstr;

constexpr const char* kSeedLoops = R"({"schema": "bodesmith.disturbance/1",
  "ascending": [0.3546, -0.6433, 0.2887], "descending": [-0.2398, 0.0838, 0.156],
  "rate": {"frequency_hz": [1, 100], "ascending": [1, 1], "descending": [1, 1.17]}})";

TEST(YieldController, WritesSpreadTrimsAndStability) {
  const TemporaryFolder folder;
  const std::string dir = folder.path().string();
  write_file(folder / "d.json", kSeedLoops);
  const std::string command = "yield controller " + dir + "/d.json --draws 60 --track 1 100 -o " + dir;
  auto result = run_bodesmith(command + "/out --json --no-ngspice");
  ASSERT_EQ(result.status, 0) << result.err;
  const Node json = parse_json(result.out, "out");
  EXPECT_EQ(json.at("errors_of_parts").at("at").size(), 2u);
  EXPECT_GT(json.at("stability").at("phase_margin_deg").number(), 45.0);
  EXPECT_LT(json.at("trim").at("after").at("p95_percent").number(),
            json.at("trim").at("before").at("p95_percent").number());
  EXPECT_THAT(read_file(folder / "out/trim.md"), HasSubstr("1. **"));
  EXPECT_THAT(read_file(folder / "out/draws.csv"),
              HasSubstr("draw,error_1_hz_percent,error_100_hz_percent\n0,"));
  const std::string once = read_file(folder / "out/draws.csv");
  result = run_bodesmith(command + "/out --no-ngspice --threads 2");
  EXPECT_EQ(read_file(folder / "out/draws.csv"), once);
  EXPECT_THAT(result.out, HasSubstr("of the variance"));
  result = run_bodesmith(command + "/out --no-ngspice --max-p95-percent 1e-6");
  EXPECT_EQ(result.status, 1);
}

/// What holds the stroke droops in every copy: it is in the nominal figure, and told.
TEST(YieldController, CountsWhatTheHoldsOfTheStrokeAreOff) {
  const TemporaryFolder folder;
  const std::string dir = folder.path().string();
  const std::string loops = kSeedLoops;
  write_file(
      folder / "d.json",
      loops.substr(0, loops.rfind('}')) +
          R"(, "amplitude": {"alpha": [0.2, 0.6, 1], "ascending": [0.1, 0.5, 1], "descending": [0.12, 0.55, 1]}})");
  const std::string command =
      "yield controller " + dir + "/d.json --draws 60 --track 1 --trims 0 --no-ngspice -o " + dir;
  const auto with = run_bodesmith(command + "/with --json");
  const auto without = run_bodesmith(command + "/without --json --full-stroke");
  ASSERT_EQ(with.status, 0) << with.err;
  ASSERT_EQ(without.status, 0) << without.err;
  const Node held = parse_json(with.out, "out").at("errors_of_parts");
  const Node full = parse_json(without.out, "out").at("errors_of_parts");
  const double low = held.at("held_stroke_low_percent").number();
  EXPECT_GT(low, 0.005);
  EXPECT_LT(low, 0.3);
  EXPECT_EQ(full.at("held_stroke_low_percent").kind(), Node::Kind::null);
  // The generator's d by as much, and less than twice: its slope over the stroke.
  const double more = held.at("worst_frequency").at("nominal_percent").number() -
                      full.at("worst_frequency").at("nominal_percent").number();
  EXPECT_GT(more, 0.02 * low);
  EXPECT_LT(more, 2.0 * low);
  EXPECT_THAT(run_bodesmith(command + "/text").out, HasSubstr("what holds the stroke is low by"));
}

TEST(YieldController, SaysWhatIsWrong) {
  const TemporaryFolder folder;
  const std::string dir = folder.path().string();
  write_file(folder / "d.json", kSeedLoops);
  const std::string command = "yield controller " + dir + "/d.json -o " + dir + "/out --no-ngspice ";
  for (const auto& [options, word] :
       {std::pair{"--error nothing=1", "resistor_percent"},
        std::pair{"--error resistor_percent=-1", "0 or more"}, std::pair{"--track 0", "1e-6 to 1e9 Hz"},
        std::pair{"--draws 1", "--draws"}, std::pair{"--form round", "self-fed"}}) {
    const auto result = run_bodesmith(command + options);
    EXPECT_EQ(result.status, 2) << options;
    EXPECT_THAT(result.err, HasSubstr(word)) << options;
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "out"));
}

}  // namespace
}  // namespace bodesmith
