#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "base/document.hpp"
#include "base/provenance.hpp"
#include "lti/cascade.hpp"
#include "lti/sections.hpp"
#include "run_program.hpp"

namespace bodesmith {
namespace {

const std::string kGains = std::string(BODESMITH_SOURCE_DIR) + "/examples/nanopositioner/gains.csv";

TEST(ApproximateCommand, FromPointsToSections) {
  const TemporaryFolder folder;
  const std::string cascade = (folder / "cascade.json").string();
  const std::string sections = (folder / "sections.json").string();
  ASSERT_EQ(run_bodesmith("fit " + kGains + " -o " + cascade).status, 0);
  const auto result = run_bodesmith("approximate " + cascade + " --max-error-db 0.01 --json -o " + sections);
  ASSERT_EQ(result.status, 0) << result.err;
  const Node summary = parse_json(result.out, "stdout");
  EXPECT_TRUE(summary.has("timing_s"));
  Provenance from;
  const Sections made = Sections::read(sections, from);
  const Cascade wanted = Cascade::read(cascade, from);
  EXPECT_LE(made.error->everywhere_max_magnitude_db, 0.01);
  for (const double f : {1.0, 10.0, 33.0, 100.0, 1e4}) {
    EXPECT_NEAR(to_decibel(std::abs(made.response(Hertz{f}.rad_s()))), wanted.magnitude_db(Hertz{f}.rad_s()),
                0.01);
  }
}

TEST(ApproximateCommand, ExitStatusSaysWhenALimitIsMissed) {
  const TemporaryFolder folder;
  const std::string cascade = (folder / "cascade.json").string();
  write_file(cascade, R"({"schema":"bodesmith.cascade/1","terms":[{"lambda_s":1,"x":1e-6,"beta":0.5}]})");
  const std::string to = " -o " + (folder / "s.json").string();
  const auto missed = run_bodesmith("approximate " + cascade + " --max-error-db 1e-9 --max-order 3" + to);
  EXPECT_EQ(missed.status, 1) << missed.err;
  EXPECT_NE(missed.out.find("NOT met"), std::string::npos);
  EXPECT_TRUE(std::filesystem::exists(folder / "s.json"));
}

TEST(ApproximateCommand, BadUsageIsOneLine) {
  const TemporaryFolder folder;
  const std::string cascade = (folder / "cascade.json").string();
  write_file(cascade, R"({"schema":"bodesmith.cascade/1","terms":[{"lambda_s":1,"x":0.1,"beta":0.5}]})");
  const std::string to = " -o " + (folder / "s.json").string();
  for (const std::string& options :
       {std::string("--method remez"), std::string("--order 0"), std::string("--order 3 --max-error-db 1"),
        std::string("--max-error-db -1"), std::string("--method carlson --order 3"),
        std::string("--order two")}) {
    const auto result = run_bodesmith("approximate " + cascade + " " + options + to);
    EXPECT_EQ(result.status, 2) << options;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_FALSE(std::filesystem::exists(folder / "s.json"));
  }
}

TEST(ApproximateCommand, EveryMethodWrites) {
  const TemporaryFolder folder;
  const std::string cascade = (folder / "cascade.json").string();
  write_file(cascade,
             R"({"schema":"bodesmith.cascade/1","gain":2,"terms":[{"lambda_s":0.1,"x":0.1,"beta":-0.5}]})");
  for (const char* method :
       {"oustaloup", "refined-oustaloup", "matsuda", "carlson", "pade", "charef", "minimax"}) {
    const std::string out = (folder / (std::string(method) + ".json")).string();
    const auto result =
        run_bodesmith("approximate " + cascade + " --order 4 --method " + method + " -o " + out);
    EXPECT_EQ(result.status, 0) << method << result.err;
    Provenance from;
    EXPECT_EQ(Sections::read(out, from).pole_count(), 4);
  }
}

}  // namespace
}  // namespace bodesmith
