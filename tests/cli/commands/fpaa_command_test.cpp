#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <complex>

#include "base/documents/document.hpp"
#include "base/units.hpp"
#include "fpaa/plan/plan.hpp"
#include "fpaa/plan/switched_board.hpp"
#include "run_program.hpp"

namespace bodesmith {
namespace {

using ::testing::HasSubstr;

constexpr const char* kFpaaSections = R"({"schema": "bodesmith.sections/1", "gain": 1.0, "sections": [
  {"gain": 0.918, "zeros_rad_s": [[-48.79, 0], [-14.8, 0]], "poles_rad_s": [[-47.49, 0], [-13.99, 0]]},
  {"gain": 1.885, "zeros_rad_s": [[-107.6, 0], [-63.68, 0]], "poles_rad_s": [[-126.4, 0], [-102.2, 0]]}]})";

/// A project in the form of the vendor's generator, all of chip 1.
std::string project_for(const fpaa::Plan& plan) {
  std::string out = "const an_Byte an_apiAddress1[1] = { 0x01 };\n";
  out += "const an_Byte an_FPAA1_PrimaryConfigInfo[] = { 0xD5, 0xB7, 0x20, 0x01, 0x00, 0x01, 0xC1 };\n";
  int byte[5] = {7, 7, 7, 7, 7};
  for (const fpaa::PlacedCam& cam : plan.chips[0].cams) {
    out += "extern const an_apiCapacitor an_FPAA1_" + cam.name + "_Capacitor[4] = {\n";
    for (const fpaa::Capacitor& c : cam.capacitors) {
      out += " /* " + c.name + " */ { " + std::to_string(2 * cam.cab + 3) + ", " +
             std::to_string(byte[cam.cab]--) + ", },\n";
    }
    out += "};\n";
  }
  return out;
}

TEST(FpaaCommand, PlanStreamsVerifySend) {
  const TemporaryFolder folder;
  write_file(folder / "s.json", kFpaaSections);
  const std::string dir = folder.path().string();
  auto result = run_bodesmith("fpaa " + dir + "/s.json -o " + dir + "/plan --clock-hz 2000 --json");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(parse_json(result.out, "out").at("clock_hz").number(), 2000.0);
  Provenance from;
  const fpaa::Plan plan = fpaa::Plan::read(folder / "plan/plan.json", from);
  EXPECT_GE(plan.cams().size(), 4u);
  for (const char* file : {"build_sheet.md", "build_sheet.html", "board.svg", "zrna.py"}) {
    EXPECT_TRUE(std::filesystem::exists(folder / "plan" / file)) << file;
  }
  const Node json = read_document(folder / "plan/plan.json", from);
  EXPECT_GT(json.at("timing_s").at("compute").number(), 0.0);
  EXPECT_EQ(json.at("inputs")[0].at("path").string(), dir + "/s.json");
  EXPECT_GT(json.at("total").at("mismatch_p95_percent").number(), 0.0);

  write_file(folder / "ApiCode.c", project_for(plan));
  const std::string api = " --api " + dir + "/ApiCode.c";
  result = run_bodesmith("fpaa streams " + dir + "/plan/plan.json" + api + " -o " + dir + "/streams");
  ASSERT_EQ(result.status, 0) << result.err;
  const std::string verify = "fpaa verify " + dir + "/plan/plan.json" + api + " ";
  for (const char* file : {"update_chip1.ahf", "update_streams.c", "packets.bin"}) {
    result = run_bodesmith(verify + dir + "/streams/" + file);
    EXPECT_EQ(result.status, 0) << file << result.out << result.err;
  }
  std::string ahf = read_file(folder / "streams/update_chip1.ahf");
  ahf.replace(ahf.size() - 9, 2, "FF");
  write_file(folder / "broken.ahf", ahf);
  result = run_bodesmith(verify + dir + "/broken.ahf");
  EXPECT_NE(result.status, 0);
  EXPECT_THAT(result.out + result.err, HasSubstr("broken.ahf: "));

  result = run_bodesmith("fpaa send " + dir + "/streams/packets.bin --dry-run");
  EXPECT_EQ(result.status, 0);
  EXPECT_THAT(result.out, HasSubstr("update to Address1 1"));
  result = run_bodesmith("fpaa send " + dir + "/streams/packets.bin --port " + dir + "/none");
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, HasSubstr("cannot be opened"));
}

// One spread: what the plan says of its boards, those that `yield` draws, and what `diagnose` takes for a good one.
// A board whose gain is 2 % too large everywhere gets other capacitors; where nothing is off, none.
TEST(FpaaCommand, TrimTakesAMeasuredErrorAway) {
  const TemporaryFolder folder;
  write_file(folder / "s.json", kFpaaSections);
  const std::string dir = folder.path().string();
  ASSERT_EQ(run_bodesmith("fpaa " + dir + "/s.json -o " + dir + "/plan --clock-hz 2000").status, 0);
  Provenance from;
  const fpaa::SwitchedBoard board(fpaa::Plan::read(folder / "plan/plan.json", from));
  std::string csv = "frequency_hz,gain,phase_deg\n";
  for (const double hz : {1.0, 3.0, 8.0, 15.0, 25.0}) {
    const std::complex<double> h = 1.02 * board.gain(Hertz{hz}.rad_s());
    csv += fmt::format("{},{},{}\n", hz, std::abs(h), to_degrees(std::arg(h)));
  }
  write_file(folder / "measured.csv", csv);
  const std::string trim = "fpaa trim " + dir + "/plan/plan.json --measured " + dir +
                           "/measured.csv --measurement-percent 0.01 --samples 20 --json -o " + dir;
  auto result = run_bodesmith(trim + "/trimmed");
  ASSERT_EQ(result.status, 0) << result.err;
  const Node json = parse_json(result.out, "out");
  EXPECT_NEAR(json.at("before").at("median_percent").number(), 2.0, 0.2);
  EXPECT_LT(json.at("after").at("median_percent").number(), 0.7);
  const fpaa::SwitchedBoard after(fpaa::Plan::read(folder / "trimmed/plan.json", from));
  const RadPerSecond w = Hertz{8.0}.rad_s();
  EXPECT_NEAR(std::abs(after.gain(w) / board.gain(w)), 1.0 / 1.02, 0.01);
  EXPECT_TRUE(std::filesystem::exists(folder / "trimmed/build_sheet.md"));
  EXPECT_EQ(run_bodesmith("fpaa trim " + dir + "/plan/plan.json -o " + dir + "/none").status, 2);
  write_file(folder / "measured.csv", "frequency_hz,gain,phase_deg\n");
  EXPECT_EQ(run_bodesmith(trim + "/none").status, 2);
}

TEST(FpaaCommand, APlanStatesTheSpreadOfItsCapacitors) {
  const TemporaryFolder folder;
  const std::string dir = folder.path().string();
  const std::string plan = dir + "/plan/plan.json";
  write_file(folder / "s.json", kFpaaSections);
  auto result =
      run_bodesmith("fpaa " + dir + "/s.json -o " + dir +
                    "/plan --clock-hz 2000 --unit-capacitor-percent 2 --systematic-units 0.25 --json");
  ASSERT_EQ(result.status, 0) << result.err;
  const double moved = parse_json(result.out, "stdout").at("total").at("mismatch_p95_percent").number();
  const auto drawn = [&](const std::string& more) {
    result = run_bodesmith("yield " + plan + " --samples 500 --json" + more);
    EXPECT_EQ(result.status, 0) << result.err;
    const Node node = parse_json(result.out, "stdout");
    return std::pair(node.at("unit_capacitor_percent").number(),
                     node.at("designs")[0].at("worst_percent").at("p95").number());
  };
  const auto [percent, kept] = drawn("");
  EXPECT_EQ(percent, 2.0);
  EXPECT_NEAR(kept, moved, 0.06 * moved);
  const auto [asked, finer] = drawn(" --unit-capacitor-percent 0.5 --systematic-units 0");
  EXPECT_EQ(asked, 0.5);
  EXPECT_LT(finer, 0.4 * kept);

  ASSERT_EQ(run_bodesmith("bode " + plan + " --from-hz 2 --to-hz 20 -o " + dir + "/good.csv").status, 0);
  result = run_bodesmith("diagnose --plan " + plan + " --data " + dir + "/good.csv --systematic-units 0 -o " +
                         dir + "/faults");
  ASSERT_EQ(result.status, 0) << result.err;
  Provenance from;
  const Node told = read_document(folder / "faults/faults.json", from);
  EXPECT_EQ(told.at("verdict").string(), "nothing_wrong");
  EXPECT_EQ(told.at("tolerances").at("unit_capacitor_percent").number(), 2.0);
  EXPECT_EQ(told.at("tolerances").at("systematic_units").number(), 0.0);
}

TEST(FpaaCommand, WholeController) {
  const TemporaryFolder folder;
  const std::string dir = folder.path().string();
  write_file(folder / "s.json", kFpaaSections);
  ASSERT_EQ(run_bodesmith("fpaa " + dir + "/s.json -o " + dir + "/plan --clock-hz 2000").status, 0);
  // Two parabolas; a whole disturbance is in docs/jobs/board.md.
  write_file(folder / "d.json", R"({"schema": "bodesmith.disturbance/1",
  "ascending": [0.3, -0.3, 0], "descending": [-0.2, 0.2, 0]})");
  auto result = run_bodesmith("fpaa controller " + dir + "/d.json --track-hz 100 --descending " + dir +
                              "/plan/plan.json -o " + dir + "/c --json");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(parse_json(result.out, "out").at("variants").size(), 3u);
  const std::string table = read_file(folder / "c/lookup_descending.csv");
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 257);
  result = run_bodesmith("fpaa controller " + dir + "/d.json -o " + dir + "/d --polynomial magic");
  EXPECT_EQ(result.status, 2);
}

TEST(FpaaCommand, BadInputIsOneLineAndLeavesNothing) {
  const TemporaryFolder folder;
  const std::string dir = folder.path().string();
  write_file(folder / "bad.json", "{\"schema\": \"bodesmith.sections/1\",\n \"sections\": [{}]}");
  auto result = run_bodesmith("fpaa " + dir + "/bad.json -o " + dir + "/out");
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, HasSubstr("bad.json:2: "));
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1);
  EXPECT_FALSE(std::filesystem::exists(folder / "out"));
  write_file(folder / "s.json", kFpaaSections);
  result = run_bodesmith("fpaa " + dir + "/s.json -o " + dir + "/out --clock-hz 1234");
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, HasSubstr("the nearest is"));
  result =
      run_bodesmith("fpaa " + dir + "/s.json -o " + dir + "/out --clock-hz 2000 --max-error-percent 1e-9");
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.out, HasSubstr("NOT met"));
  EXPECT_EQ(run_bodesmith("fpaa --help").status, 0);
  EXPECT_EQ(run_bodesmith("fpaa check --help").status, 0);
}

}  // namespace
}  // namespace bodesmith
