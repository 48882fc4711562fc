// bode's loops and time responses, and export, as a user calls them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "base/documents/json.hpp"
#include "base/files.hpp"
#include "run_program.hpp"
#include "signal/csv.hpp"
#include "temporary_folder.hpp"
#include "texts.hpp"

namespace bodesmith {
namespace {
using testing::HasSubstr;

/// gain/(1 + s/1000)
std::string lag_json(double gain) {
  return R"({"schema": "bodesmith.sections/1", "gain": )" + std::to_string(gain) +
         R"(, "sections": [{"gain": 1000.0, "zeros_rad_s": [], "poles_rad_s": [[-1000.0, 0.0]]}]})";
}

TEST(BodeLoops, MarginsOfASeriesAreTheClosedForms) {
  const TemporaryFolder folder;
  const std::string at = folder.path().string();
  write_file(folder / "a.json", lag_json(4.0));
  write_file(folder / "b.json", lag_json(1.0));
  write_file(folder / "c.json", lag_json(1.0));
  const ProgramResult run =
      run_bodesmith("bode --series --margins --group-delay --nyquist --nichols --json " + at + "/a.json " +
                    at + "/b.json " + at + "/c.json -o " + at + "/out.csv --time-response " + at +
                    "/t.csv --nyquist-svg " + at + "/n.svg --svg " + at + "/bode.svg");
  ASSERT_EQ(run.status, 0) << run.err;
  // The loop alone, round -1; the factors are in the Bode plot.
  const std::string nyquist = read_file(folder / "n.svg");
  EXPECT_THAT(nyquist, HasSubstr("gain 1"));
  EXPECT_THAT(nyquist, HasSubstr(">series<"));
  EXPECT_THAT(nyquist, testing::Not(HasSubstr(">a<")));
  EXPECT_THAT(read_file(folder / "bode.svg"), HasSubstr("Group delay"));
  const Json summary = parsed(run.out);
  const Json& series = summary["responses"].back();
  EXPECT_EQ(series["name"], "series");
  const Json& margins = series["margins"];
  const double x = std::sqrt(std::pow(4.0, 2.0 / 3.0) - 1.0);
  EXPECT_NEAR(margins["gain_crossings"][0]["phase_margin_deg"].get<double>(),
              180.0 - 3.0 * std::atan(x) * 180.0 / std::numbers::pi, 1e-8);
  EXPECT_NEAR(margins["phase_crossings"][0]["gain_margin_db"].get<double>(), 20.0 * std::log10(2.0), 1e-8);
  EXPECT_EQ(margins["closed_loop_stable"], true);
  EXPECT_FALSE(summary["responses"][0].contains("margins"));
  Provenance ignored;
  const Csv table = Csv::parse(read_file(folder / "out.csv"), "out.csv");
  const auto& f = table.column("frequency_hz");
  for (std::size_t i = 0; i < f.size(); i += 20) {
    const double w = 2.0 * std::numbers::pi * f[i] / 1000.0;
    EXPECT_NEAR(table.column("series_group_delay_s")[i], 3e-3 / (1.0 + w * w), 1e-12);
    const std::complex<double> l = 4.0 / std::pow(std::complex<double>(1.0, w), 3.0);
    EXPECT_NEAR(table.column("series_re")[i], l.real(), 1e-12);
    EXPECT_NEAR(table.column("series_closed_magnitude_db")[i], 20.0 * std::log10(std::abs(l / (1.0 + l))),
                1e-9);
  }
  const Csv time = Csv::parse(read_file(folder / "t.csv"), "t.csv");
  EXPECT_NEAR(time.column("a_step")[100], 4.0 * (1.0 - std::exp(-1000.0 * time.column("time_s")[100])),
              1e-12);
  EXPECT_THAT(run.err, HasSubstr("within 2 %"));
  EXPECT_THAT(read_file(folder / "n.svg"), HasSubstr("<svg"));
}

TEST(ExportCommand, WritesByTheEndingAndSaysWhatItDid) {
  const TemporaryFolder folder;
  const std::string at = folder.path().string();
  write_file(folder / "a.json", lag_json(4.0));
  const ProgramResult c = run_bodesmith("export " + at + "/a.json --sample-hz 48000 -o " + at + "/a.c");
  ASSERT_EQ(c.status, 0) << c.err;
  EXPECT_THAT(c.out, HasSubstr("1 biquads by tustin at 48 kHz: off by"));
  EXPECT_THAT(c.out, HasSubstr("matched would be off by"));
  // Out to Touchstone, back through `bode` and `export` to this program's CSV.
  ASSERT_EQ(run_bodesmith("export " + at + "/a.json -o " + at + "/a.s2p --from-hz 10 --to-hz 1000 --count 3")
                .status,
            0);
  ASSERT_EQ(run_bodesmith("export " + at + "/a.s2p:s21 -o " + at + "/a.csv").status, 0);
  const Csv csv = Csv::parse(read_file(folder / "a.csv"), "a.csv");
  ASSERT_EQ(csv.rows(), 3u);
  EXPECT_NEAR(csv.column("frequency_hz")[1], 100.0, 1e-9);
  EXPECT_NEAR(csv.column("phase_deg")[1], -std::atan(0.2 * std::numbers::pi) * 180.0 / std::numbers::pi,
              1e-9);
  const ProgramResult bode = run_bodesmith("bode --margins " + at + "/a.s2p");
  EXPECT_EQ(bode.status, 0);
  EXPECT_THAT(bode.out, HasSubstr("a as an open loop:"));
  const ProgramResult bad = run_bodesmith("export " + at + "/a.s2p -o " + at + "/a.py");
  EXPECT_EQ(bad.status, 2);
  EXPECT_THAT(bad.err, HasSubstr("needs pole-zero sections"));
}

}  // namespace
}  // namespace bodesmith
