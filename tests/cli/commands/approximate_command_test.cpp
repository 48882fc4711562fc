#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <filesystem>

#include "base/documents/document.hpp"
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
  // Of what is written: pairs that were left out count.
  write_file(cascade, R"({"schema":"bodesmith.cascade/1","terms":[{"lambda_s":1,"x":0.1,"beta":0.5},
                            {"lambda_s":0.12,"x":5,"beta":0.4}]})");
  const auto merged = run_bodesmith("approximate " + cascade + " --max-error-db 1e-4 --merge-db 0.1" + to);
  EXPECT_EQ(merged.status, 1) << merged.out;
  EXPECT_NE(merged.out.find("NOT met"), std::string::npos);
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

TEST(ApproximateCommand, ArrangedSectionsAreTheSameProduct) {
  const TemporaryFolder folder;
  const std::string cascade = (folder / "cascade.json").string();
  ASSERT_EQ(run_bodesmith("fit " + kGains + " -o " + cascade).status, 0);
  Provenance from;
  const auto make = [&](const std::string& options) {
    const std::string out = (folder / "s.json").string();
    EXPECT_EQ(
        run_bodesmith("approximate " + cascade + " --max-error-db 0.05 " + options + " -o " + out).status, 0);
    return Sections::read(out, from);
  };
  const Sections plain = make("");
  const Sections arranged = make("--arrange");
  for (const double f : {0.1, 5.0, 44.0, 1e3}) {
    EXPECT_NEAR(std::abs(plain.response(Hertz{f}.rad_s()) / arranged.response(Hertz{f}.rad_s()) - 1.0), 0.0,
                1e-9);
  }
}

TEST(ApproximateCommand, FractionalPid) {
  const TemporaryFolder folder;
  const std::string pid = std::string(BODESMITH_SOURCE_DIR) + "/examples/fractional_pid/pid.toml";
  const std::string out = (folder / "s.json").string();
  const auto result =
      run_bodesmith("approximate " + pid + " --from-hz 0.1 --to-hz 1000 --order 6 --json -o " + out);
  ASSERT_EQ(result.status, 0) << result.err;
  const Node summary = parse_json(result.out, "stdout");
  EXPECT_TRUE(summary.at("stability").at("stable").boolean());
  Provenance from;
  const Sections made = Sections::read(out, from);
  for (const double f : {0.1, 1.0, 30.0, 1000.0}) {
    const std::complex<double> s(0.0, 2.0 * M_PI * f);
    const auto wanted = 1.2 + 30.0 * std::pow(s, -0.9) + 0.004 * std::pow(s, 0.7);
    const auto ratio = made.response(Hertz{f}.rad_s()) / wanted;
    EXPECT_NEAR(to_decibel(std::abs(ratio)), 0.0, 0.06) << f;
    EXPECT_NEAR(to_degrees(std::arg(ratio)), 0.0, 0.4) << f;
  }
  EXPECT_EQ(run_bodesmith("approximate " + pid + " --order 6 -o " + out).status, 2);
  write_file(folder / "u.toml",
             "schema = 'bodesmith.fractional/1'\nnumerator = [{coefficient = 1, power = 0}]\n"
             "denominator = [{coefficient = 1, power = 0.5}, {coefficient = -1, power = 0}]\n");
  const auto unstable =
      run_bodesmith("approximate " + (folder / "u.toml").string() + " --from-hz 1 --to-hz 10 -o " + out);
  EXPECT_EQ(unstable.status, 2);
  EXPECT_NE(unstable.err.find("unstable"), std::string::npos);
}

}  // namespace
}  // namespace bodesmith
