#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

#include "base/documents/document.hpp"
#include "base/files.hpp"
#include "base/text.hpp"
#include "browser_check.hpp"
#include "run_program.hpp"

namespace {

using namespace bodesmith;

/// A static stage y = 2 u, cut off at +1.5, with white noise of 0.01; made here, not by the program.
std::string clipped_record(bool triangle, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0.0, 0.01);
  std::string text = "time_s,u,y\n";
  for (int i = 0; i < 3000; ++i) {
    const double t = 1e-3 * i;
    const double phase = 3.0 * t - std::floor(3.0 * t);
    const double u = triangle ? (phase < 0.5 ? 4 * phase - 1 : 3 - 4 * phase)
                              : 0.6 * std::sin(11.0 * t) + 0.4 * std::sin(29.0 * t);
    text += number_text(t) + "," + number_text(u) + "," +
            number_text(std::min(2.0 * u, 1.5) + normal(random)) + "\n";
  }
  return text;
}

constexpr const char* kModel =
    "schema = \"bodesmith.model/1\"\n[[block]]\ntype = \"gain\"\ngain = 1.9\noffset = 0.0\nfree = "
    "[\"gain\"]\n";

TEST(DiagnoseCommand, NamesASaturationAndItsModelRunsInSimulate) {
  const TemporaryFolder folder;
  write_file(folder / "model.toml", kModel);
  write_file(folder / "train.csv", clipped_record(false, 1));
  write_file(folder / "holdout.csv", clipped_record(true, 2));
  const std::string at = folder.path().string();
  const auto run = run_bodesmith("diagnose " + at + "/model.toml --data " + at + "/train.csv --holdout " +
                                 at + "/holdout.csv -o " + at + "/out");
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_NE(run.out.find("saturation"), std::string::npos);
  Provenance from;
  const auto diagnosis = read_document(folder / "out/diagnosis.json", from);
  diagnosis.expect_schema("diagnosis");
  EXPECT_EQ(diagnosis.at("verdict").string(), "explained");
  ASSERT_EQ(diagnosis.at("steps").size(), 1U);
  EXPECT_EQ(diagnosis.at("steps")[0].at("effect").string(), "saturation");
  EXPECT_NEAR(diagnosis.at("gap").at("final").at("holdout_rms").number(), 0.01, 0.002);
  EXPECT_GT(diagnosis.at("timing_s").at("compute").number(), 0.0);
  const auto again =
      run_bodesmith("simulate " + at + "/out/model.toml --input " + at + "/holdout.csv -o " + at + "/y.csv");
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_NE(read_file(folder / "out/report.html").find("<svg"), std::string::npos);
  if (const std::string why = no_browser(); !why.empty()) GTEST_SKIP() << "the page was not opened: " << why;
  const ProgramResult page = drive_page("check_pages.py", at + "/out/report.html");
  EXPECT_EQ(page.status, 0) << page.out << page.err;
}

TEST(DiagnoseCommand, RefusesBadInputWithoutWritingAnything) {
  const TemporaryFolder folder;
  write_file(folder / "model.toml", kModel);
  write_file(folder / "short.csv", "time_s,u,y\n0,0,0\n1,1,1\n");
  write_file(folder / "response.csv", "frequency_hz,magnitude_db,phase_deg\n1,0,0\n2,0,0\n");
  const std::string at = folder.path().string();
  for (const std::string& arguments :
       {at + "/model.toml -o " + at + "/out", at + "/model.toml --data " + at + "/none.csv -o " + at + "/out",
        at + "/model.toml --data " + at + "/short.csv -o " + at + "/out",
        at + "/model.toml --data " + at + "/short.csv --max-seconds 0 -o " + at + "/out",
        at + "/model.toml --data " + at + "/short.csv --holdout " + at + "/response.csv -o " + at + "/out"}) {
    const auto run = run_bodesmith("diagnose " + arguments);
    EXPECT_EQ(run.status, 2) << arguments;
    EXPECT_EQ(run.err.find("bodesmith"), 0U) << run.err;
    EXPECT_FALSE(std::filesystem::exists(folder / "out"));
  }
}

}  // namespace
