#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/documents/document.hpp"
#include "base/provenance.hpp"
#include "lti/sections.hpp"
#include "run_program.hpp"

namespace bodesmith {
namespace {

TEST(DesignCommand, WritesSectionsThatTheOtherCommandsRead) {
  const TemporaryFolder folder;
  const std::string out = (folder / "s.json").string();
  const auto result = run_bodesmith(
      "design bandpass --family elliptic --order 3 --from-hz 100 --to-hz 200 --ripple-db 1 --stop-db 40 --json -o " +
      out);
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(parse_json(result.out, "stdout").at("poles").number(), 6.0);
  Provenance from;
  const Sections sections = Sections::read(out, from);
  for (const double edge : {100.0, 200.0}) {
    EXPECT_NEAR(to_decibel(std::abs(sections.response(Hertz{edge}.rad_s()))), -1.0, 1e-9);
  }
  EXPECT_EQ(run_bodesmith("bode " + out + " -o " + (folder / "b.csv").string()).status, 0);
}

TEST(DesignCommand, FindsTheLeastOrderOfAMask) {
  const TemporaryFolder folder;
  const std::string out = (folder / "s.json").string();
  const auto result = run_bodesmith(
      "design highpass --family chebyshev2 --pass-hz 1000 --stop-hz 500 --ripple-db 0.5 --stop-db 40 -o " +
      out);
  ASSERT_EQ(result.status, 0) << result.err;
  Provenance from;
  const Sections sections = Sections::read(out, from);
  EXPECT_GE(to_decibel(std::abs(sections.response(Hertz{1000}.rad_s()))), -0.5 - 1e-9);
  EXPECT_LE(to_decibel(std::abs(sections.response(Hertz{500}.rad_s()))), -40.0 + 1e-9);
}

TEST(DesignCommand, BadInputIsOneLine) {
  const TemporaryFolder folder;
  const std::string to = " -o " + (folder / "s.json").string();
  for (const std::string arguments :
       {"lowpas --order 2 --corner-hz 5", "lowpass --order 2", "lowpass --corner-hz 5",
        "bandpass --order 2 --from-hz 5", "bandpass --order 2 --from-hz 5 --to-hz 4",
        "lowpass --order 99 --corner-hz 5", "lowpass --order 2 --corner-hz nan",
        "lowpass --family bessl --order 2 --corner-hz 5", "lowpass --pass-hz 5 --stop-hz 4",
        "peaking --corner-hz 5", "lowpass --family linkwitz-riley --order 3 --corner-hz 5",
        "lowpass --order 2 --corner-hz 1e-320", "bandpass --pass-band-hz 5 --stop-band-hz 4 9",
        "delay --delay-s 1e-30", "delay"}) {
    const auto result = run_bodesmith("design " + arguments + to);
    EXPECT_EQ(result.status, 2) << arguments;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  }
}

}  // namespace
}  // namespace bodesmith
