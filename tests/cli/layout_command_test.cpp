#include <gtest/gtest.h>

#include "base/document.hpp"
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
  write_file(folder / "tiny.json",
             R"({"schema":"bodesmith.disturbance/1","ascending":[1,1e-9,0],"descending":[0,0,0]})");
  const std::string out = (folder / "layout").string();
  for (const char* name : {"broken.json", "tiny.json", "none.json"}) {
    const ProgramResult run = run_bodesmith("layout " + (folder / name).string() + " -o " + out);
    EXPECT_EQ(run.status, 2) << run.err;
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    EXPECT_FALSE(std::filesystem::exists(folder / "layout"));
  }
}

}  // namespace
}  // namespace bodesmith
