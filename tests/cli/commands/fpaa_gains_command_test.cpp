#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/documents/document.hpp"
#include "run_program.hpp"

namespace bodesmith {
namespace {

using ::testing::HasSubstr;

TEST(FpaaGains, WritesTableHostAndStreams) {
  const TemporaryFolder folder;
  const std::string dir = folder.path().string();
  write_file(folder / "d.json", R"({"schema": "bodesmith.disturbance/1", "ascending": [0.3, -0.5, 0.2],
    "descending": [-0.2, 0.1, 0.1],
    "rate": {"frequency_hz": [1, 100], "ascending": [1, 1], "descending": [1, 1.17]}})");
  const std::string command = "fpaa gains " + dir + "/d.json -o " + dir + "/gains ";
  auto result = run_bodesmith(command + "--descending 2:3.7/3.6 --json");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("with a gain of"));
  const Node json = parse_json(result.out, "out");
  EXPECT_NEAR(json.at("sets")[0].at("gains")[0].at("realised").number(), 1.0, 1e-12);
  EXPECT_GT(json.at("update_s").number(), 0.002);
  for (const char* file : {"gains.json", "gains.csv", "gains.md", "gain_host.c", "gain_host.py",
                           "streams/set000_address2.ahf", "packets/set000.bin"}) {
    EXPECT_TRUE(std::filesystem::exists(folder / "gains" / file)) << file;
  }
  result = run_bodesmith("fpaa send " + dir + "/gains/packets/set000.bin --dry-run");
  EXPECT_THAT(result.out, HasSubstr("update to Address1 2"));

  result = run_bodesmith(command);
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, HasSubstr("--descending"));
  result = run_bodesmith(command + "--descending FPAA1.Gain");
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, HasSubstr("ApiCode.c"));
}

}  // namespace
}  // namespace bodesmith
