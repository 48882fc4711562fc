// fpaa --stream, disassemble and verify from the command line.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "base/documents/document.hpp"
#include "base/files.hpp"
#include "run_program.hpp"

namespace bodesmith {
namespace {

using ::testing::HasSubstr;

constexpr const char* kStreamSections = R"({"schema": "bodesmith.sections/1", "gain": 1.0, "sections": [
  {"gain": 0.918, "zeros_rad_s": [[-4879, 0], [-1480, 0]], "poles_rad_s": [[-4749, 0], [-1399, 0]]}]})";

TEST(FpaaStreamCommand, PlanToBytesToNetlistAndBack) {
  const TemporaryFolder folder;
  const std::string dir = folder.path().string();
  write_file(folder / "s.json", kStreamSections);
  auto result = run_bodesmith("fpaa " + dir + "/s.json -o " + dir + "/out --clock-hz 125000 --stream");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("not tried on silicon"));
  EXPECT_THAT(result.out, HasSubstr("First power-on"));
  Provenance from;
  const Node plan = read_document(folder / "out/plan.json", from);
  EXPECT_EQ(plan.at("chips")[0].at("pins").at("in1").string(), "IO1");
  EXPECT_EQ(plan.at("chips")[0].at("pins").at("out1").string(), "IO3");
  EXPECT_LT(plan.at("stream").at("largest_difference_percent").number(), 1e-7);
  for (const char* file : {"chip1.ahf", "primary.c", "packets.bin"}) {
    const std::string stream = dir + "/out/stream/" + file;
    result = run_bodesmith("fpaa disassemble " + stream + " -o " + dir + "/netlist.json");
    ASSERT_EQ(result.status, 0) << file << result.err;
    const Node netlist = read_document(folder / "netlist.json", from);
    EXPECT_EQ(netlist.at("schema").string(), "bodesmith.fpaa_netlist/1");
    EXPECT_TRUE(netlist.at("streams")[0].at("re_encodes").boolean());
    EXPECT_EQ(netlist.at("stages").size(), plan.at("chips")[0].at("cams").size());
    EXPECT_EQ(netlist.at("chips")[0].at("problems").size(), 0u);
    EXPECT_EQ(run_bodesmith("fpaa verify " + dir + "/out/plan.json " + stream).status, 0);
    EXPECT_EQ(run_bodesmith("fpaa verify " + dir + "/s.json " + stream + " --max-error-percent 3").status, 0);
    EXPECT_EQ(run_bodesmith("fpaa verify " + dir + "/s.json " + stream + " --max-error-percent 1e-6").status,
              1);
  }
}

TEST(FpaaStreamCommand, WrongStreamsAreOneLineWithTheByte) {
  const TemporaryFolder folder;
  const std::string dir = folder.path().string();
  write_file(folder / "s.json", kStreamSections);
  ASSERT_EQ(run_bodesmith("fpaa " + dir + "/s.json -o " + dir + "/out --clock-hz 125000 --stream").status, 0);
  const std::string ahf = read_file(folder / "out/stream/chip1.ahf");
  const auto changed = [&](std::size_t byte, const char* to) {
    std::string text = ahf;
    text.replace(3 * byte, 2, to);
    write_file(folder / "bad.ahf", text);
    return run_bodesmith("fpaa disassemble " + dir + "/bad.ahf");
  };
  // Device id, check byte of the first block, a digit.
  for (const auto& [byte, to, words] : {std::tuple{std::size_t{6}, "01", "byte 6: is 01, expected B7"},
                                        std::tuple{std::size_t{47}, "2B", "byte 47: is 2B, expected 2A"},
                                        std::tuple{std::size_t{20}, "GG", "bad.ahf:21: "}}) {
    const auto result = changed(byte, to);
    EXPECT_EQ(result.status, 2);
    EXPECT_THAT(result.err, HasSubstr(words));
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1);
  }
  write_file(folder / "bad.ahf", ahf.substr(0, 900));
  auto result = run_bodesmith("fpaa disassemble " + dir + "/bad.ahf");
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, HasSubstr("byte 300: the stream ends"));
  result = run_bodesmith("fpaa " + dir + "/s.json -o " + dir +
                         "/x --clock-hz 125000 --stream --pin chip1.out7=IO3");
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, HasSubstr("no pin of the plan"));
  EXPECT_FALSE(std::filesystem::exists(folder / "x"));
}

}  // namespace
}  // namespace bodesmith
