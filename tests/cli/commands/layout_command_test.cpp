#include <gtest/gtest.h>

#include "base/documents/document.hpp"
#include "base/files.hpp"
#include "run_program.hpp"

namespace bodesmith {
namespace {

TEST(LayoutCommand, WritesLayoutNetlistAndDrawing) {
  const TemporaryFolder folder;
  const std::string out = (folder / "layout").string();
  const ProgramResult run = run_bodesmith(
      "layout " BODESMITH_SOURCE_DIR "/examples/nanopositioner/disturbance.json --json -o " + out);
  ASSERT_EQ(run.status, 0) << run.err;
  const Node summary = parse_json(run.out, "stdout");
  summary.expect_schema("layout");
  EXPECT_EQ(summary.at("multipliers").size(), 2u);
  EXPECT_LT(summary.at("error").at("max_error_percent").number(), 0.05);
  EXPECT_NE(read_file(folder / "layout" / "disturbance.sub").find(".subckt disturbance x branch out"),
            std::string::npos);
  EXPECT_EQ(read_file(folder / "layout" / "layout.svg").rfind("<svg", 0), 0u);
}

TEST(LayoutCommand, BadInputIsOneLineAndWritesNothing) {
  const TemporaryFolder folder;
  write_file(folder / "broken.json",
             R"({"schema":"bodesmith.disturbance/1","ascending":[1,2],"descending":[0,0,0]})");
  write_file(folder / "large.json",
             R"({"schema":"bodesmith.disturbance/1","ascending":[300,0,0],"descending":[0,0,0]})");
  const std::string out = (folder / "layout").string();
  for (const char* name : {"broken.json", "large.json", "none.json"}) {
    const ProgramResult run = run_bodesmith("layout " + (folder / name).string() + " -o " + out);
    EXPECT_EQ(run.status, 2) << run.err;
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    EXPECT_FALSE(std::filesystem::exists(folder / "layout"));
  }
}

TEST(LayoutCommand, BranchesSchemesAndAmplitudeGains) {
  const TemporaryFolder folder;
  write_file(folder / "three.json",
             R"({"schema":"bodesmith.disturbance/1","amplitude":{"alpha":[0.5,1]},"branches":[
{"coefficients":[0.3,-0.2,0.1,-0.1,0.05],"amplitude":[0.4,1]},{"coefficients":[-0.2,0.2]},{"name":"rest","coefficients":[0.1]}]})");
  const std::string out = (folder / "layout").string();
  const ProgramResult run = run_bodesmith("layout " + (folder / "three.json").string() +
                                          " --scheme horner --switch-gap-s 40e-9 --json -o " + out);
  ASSERT_EQ(run.status, 0) << run.err;
  const Node summary = parse_json(run.out, "stdout");
  EXPECT_EQ(summary.at("multipliers").size(), 5u);
  EXPECT_EQ(summary.at("switch").at("break_before_make_s").number(), 40e-9);
  // Of the three gains one varies.
  EXPECT_EQ(summary.at("amplitude").at("gain_multipliers").size(), 1u);
  EXPECT_NE(
      read_file(folder / "layout" / "disturbance.sub").find(".subckt disturbance x branch select1 out\n"),
      std::string::npos);
  EXPECT_NE(read_file(folder / "layout" / "disturbance_amplitude.sub")
                .find(".subckt disturbance_amplitude x branch select1 amplitude out\n"),
            std::string::npos);
  EXPECT_NE(read_file(folder / "layout" / "parts.csv").find("R1_5,"), std::string::npos);
}

TEST(LayoutCommand, BadBranchesNameTheirLine) {
  const TemporaryFolder folder;
  const std::string head = "{\"schema\":\"bodesmith.disturbance/1\",\n\"branches\":";
  const std::pair<const char*, const char*> bad[] = {
      {"[]}", ":2: "},
      {"[{\"coefficients\":[1,2,3,4,5,6,7,8]}]}", ":2: "},
      {"[{\"coefficients\":[0.1],\n\"amplitude\":[1,2]}]}", ":3: "},
      {"[{\"coefficients\":[0.1],\n\"coefficient\":[1]}]}", ":3: "}};
  for (const auto& [text, line] : bad) {
    write_file(folder / "bad.json", head + text);
    const ProgramResult run =
        run_bodesmith("layout " + (folder / "bad.json").string() + " -o " + (folder / "out").string());
    EXPECT_EQ(run.status, 2) << text;
    EXPECT_NE(run.err.find(line), std::string::npos) << run.err;
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
  }
}

}  // namespace
}  // namespace bodesmith
