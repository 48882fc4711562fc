// bode against closed forms of H = g/(1 + s/1000) and of a measured delay.
#include <fmt/format.h>
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
using testing::Not;

constexpr double kCorner = 1000.0 / (2.0 * std::numbers::pi);
constexpr double kEmpty = 1e300;

class BodeCommand : public testing::Test {
 protected:
  BodeCommand() {
    lag("a.json", 4.0, 1000.0);
    lag("b.json", 2.0, 50000.0);
    std::string rows = "frequency_hz,magnitude_db,phase_deg\n", gains = "frequency_hz,gain\n";
    for (int i = 0; i <= 20; ++i) {
      const double f = 10.0 * std::pow(10.0, i / 20.0);
      rows += fmt::format("{:.15g},{:.15g},{:.15g}\n", f, 6.0 - 10.0 * std::log10(f), -360.0 * f * 1e-3);
      gains += fmt::format("{:.15g},{:.15g}\n", f, f);
    }
    write_file(folder_ / "m.csv", rows);
    write_file(folder_ / "gains.csv", gains);
  }
  void lag(const std::string& name, double gain, double pole) const {
    write_file(folder_ / name, fmt::format(R"({{"schema": "bodesmith.sections/1", "gain": {}, "sections":
 [{{"gain": {}, "zeros_rad_s": [], "poles_rad_s": [[-{}, 0]]}}]}})",
                                           gain, pole, pole));
  }
  std::string at(const std::string& name) const { return (folder_ / name).string(); }
  Json summary(const std::string& arguments) const {
    const ProgramResult run = run_shell("cd " + folder_.path().string() + " && " BODESMITH_PROGRAM " bode " +
                                        arguments + " --json -o out.csv");
    EXPECT_EQ(run.status, 0) << run.err;
    return parsed(run.out);
  }
  std::string said(const std::string& arguments) const {
    const ProgramResult run =
        run_shell("cd " + folder_.path().string() + " && " BODESMITH_PROGRAM " bode " + arguments);
    EXPECT_EQ(run.status, 0) << run.err;
    return replaced(run.out + run.err, "\\s+", " ");
  }
  /// Empty cells are kEmpty.
  Csv table(const std::string& name = "out.csv") const {
    return Csv::parse(replaced(read_file(folder_ / name), ",(?=,|\n)", ",1e300"), name);
  }

 private:
  TemporaryFolder folder_;
};

TEST_F(BodeCommand, TheGridIsADecadeBeyondAllCornersOrWhatIsAsked) {
  const Json both = summary("b.json a.json --count 31");
  EXPECT_EQ(both["count"], 31);
  EXPECT_NEAR(both["band_hz"][0].get<double>(), kCorner / 10.0, 1e-9);
  EXPECT_NEAR(both["band_hz"][1].get<double>(), 500.0 * kCorner, 1e-6);
  const Csv csv = table();
  const auto& f = csv.column("frequency_hz");
  ASSERT_EQ(f.size(), 31u);
  for (std::size_t i = 0; i < f.size(); ++i) {
    EXPECT_NEAR(f[i] / (kCorner / 10.0 * std::pow(5000.0, static_cast<double>(i) / 30.0)), 1.0, 1e-12);
    EXPECT_NEAR(csv.column("a_magnitude_db")[i], 20.0 * std::log10(4.0 / std::hypot(1.0, f[i] / kCorner)),
                1e-9);
    EXPECT_NEAR(csv.column("b_phase_deg")[i], -std::atan(f[i] / kCorner / 50.0) * 180.0 / std::numbers::pi,
                1e-9);
  }
  EXPECT_DOUBLE_EQ(both["responses"][1]["highest_db"].get<double>(), csv.column("a_magnitude_db").front());
  EXPECT_DOUBLE_EQ(both["responses"][1]["lowest_db"].get<double>(), csv.column("a_magnitude_db").back());
  EXPECT_NEAR(summary("a.json --from-hz 100")["band_hz"][1].get<double>(), 10.0 * kCorner, 1e-6);
  EXPECT_EQ(summary("a.json --from-hz 100 --to-hz 100")["count"], 1);
  EXPECT_EQ(summary("a.json --to-hz 20 --count 1")["band_hz"][1],
            summary("a.json --to-hz 20 --count 1")["band_hz"][0]);
  EXPECT_EQ(run_bodesmith("bode " + at("a.json") + " --from-hz 100 --to-hz 99").status, 2);
}

TEST_F(BodeCommand, AMeasuredResponseHasItsOwnGridItsRangeAndItsDelay) {
  EXPECT_EQ(summary("a.json m.csv --group-delay")["count"], 21);
  Csv csv = table();
  for (std::size_t i = 1; i < 20; ++i) {
    EXPECT_NEAR(csv.column("m_group_delay_s")[i], 1e-3, 1e-12);
    const double x = csv.column("frequency_hz")[i] / kCorner;
    EXPECT_NEAR(csv.column("a_group_delay_s")[i], 1e-3 / (1.0 + x * x), 1e-12);
  }
  EXPECT_EQ(csv.column("m_group_delay_s")[0], kEmpty);
  EXPECT_EQ(csv.column("m_group_delay_s")[20], kEmpty);
  // Between its points in log frequency; beyond them nothing, which no extreme counts.
  const Json wide = summary("m.csv a.json --from-hz 1 --to-hz 1000 --count 121");
  csv = table();
  for (std::size_t i = 0; i < 121; ++i) {
    const double f = csv.column("frequency_hz")[i], db = csv.column("m_magnitude_db")[i];
    // Its own ends may round to either side.
    if (i == 40 || i == 80) continue;
    EXPECT_NEAR(db, i < 40 || i > 80 ? kEmpty : 6.0 - 10.0 * std::log10(f), 1e-9) << f;
  }
  EXPECT_NEAR(wide["responses"][0]["highest_db"].get<double>(), -4.0, 0.3);
  EXPECT_NEAR(wide["responses"][0]["lowest_db"].get<double>(), -14.0, 0.3);
}

TEST_F(BodeCommand, ASeriesAddsDecibelsAndDegrees) {
  summary("a.json m.csv a.json --series --nyquist --nichols --from-hz 20 --to-hz 80 --count 9");
  const Csv csv = table();
  for (std::size_t i = 0; i < 9; ++i) {
    const double db = csv.column("series_magnitude_db")[i], deg = csv.column("series_phase_deg")[i];
    EXPECT_NEAR(db, 2.0 * csv.column("a_magnitude_db")[i] + csv.column("m_magnitude_db")[i], 1e-9);
    EXPECT_NEAR(deg, 2.0 * csv.column("a_2_phase_deg")[i] + csv.column("m_phase_deg")[i], 1e-9);
    const std::complex<double> h = std::polar(std::pow(10.0, db / 20.0), deg * std::numbers::pi / 180.0);
    EXPECT_NEAR(csv.column("series_im")[i], h.imag(), 1e-12);
    EXPECT_NEAR(csv.column("series_re")[i], h.real(), 1e-12);
    EXPECT_NEAR(csv.column("series_closed_magnitude_db")[i], 20.0 * std::log10(std::abs(h / (1.0 + h))),
                1e-9);
    EXPECT_NEAR(csv.column("series_closed_phase_deg")[i], std::arg(h / (1.0 + h)) * 180.0 / std::numbers::pi,
                1e-9);
  }
  EXPECT_THAT(said("gains.csv a.json --series --margins --from-hz 10 --to-hz 100"),
              HasSubstr("series: no phase, no margins"));
  EXPECT_EQ(run_bodesmith("bode --series " + at("a.json")).status, 2);
}

// Of what is known by its values alone: (1/(1 + s/1000))^8 below 1 MHz, turning by two turns between neighbouring points.
TEST_F(BodeCommand, ThePhaseTurnsWhateverTheGrid) {
  const std::string lag = R"({"lambda_s": 0.001, "x": 1e-9, "beta": -8})";
  write_file(at("c.json"), R"({"schema": "bodesmith.cascade/1", "gain": 1.0, "terms": [)" + lag + "]}");
  summary("c.json --from-hz 0.01 --to-hz 1e6 --count 3");
  for (std::size_t i = 0; i < 3; ++i) {
    const double wanted =
        -8.0 * std::atan(table().column("frequency_hz")[i] / kCorner) * 180.0 / std::numbers::pi;
    EXPECT_NEAR(table().column("c_phase_deg")[i], wanted, 0.01);
  }
}

TEST_F(BodeCommand, MarginsAreSaidWhereThereAreSome) {
  EXPECT_THAT(
      said("a.json --margins"),
      HasSubstr(
          "phase margin 104.5° at 616.4 Hz (delay margin 470.8 µs), its phase does not cross -180° here"));
  EXPECT_THAT(said("a.json --margins --to-hz 100"), HasSubstr("its gain does not cross 1 here"));
  // 4 dB - 10 lg f with a delay of 1 ms: |L| = 1 at 3.98 Hz, below the record; -180° at 500 Hz, above it. Six times as large: once.
  std::string rows = "frequency_hz,magnitude_db,phase_deg\n";
  for (int i = 0; i <= 90; ++i)
    rows += fmt::format("{},{:.15g},{:.15g}\n", 10 + i, 20.0 * std::log10(40.0 / (10 + i)),
                        -360.0 * (10 + i) * 8e-3);
  write_file(at("late.csv"), rows);
  const Json late = summary("late.csv --margins");
  const Json& margins = late["responses"][0]["margins"];
  EXPECT_NEAR(margins["gain_crossings"][0]["frequency_hz"].get<double>(), 40.0, 1e-6);
  EXPECT_NEAR(margins["gain_crossings"][0]["phase_margin_deg"].get<double>(), 180.0 - 360.0 * 0.32, 1e-3);
  EXPECT_NEAR(margins["phase_crossings"][0]["frequency_hz"].get<double>(), 62.5, 5e-3);
  EXPECT_NEAR(margins["phase_crossings"][0]["gain_margin_db"].get<double>(), 20.0 * std::log10(62.5 / 40.0),
              1e-3);
  EXPECT_THAT(said("late.csv --margins"), Not(HasSubstr("crossings of the gain")));
}

TEST_F(BodeCommand, StepsAndImpulsesAreTheClosedForms) {
  const std::string text =
      said("b.json a.json m.csv --from-hz 10 --to-hz 100 -o o.csv --time-response t.csv --samples 11");
  EXPECT_THAT(text, HasSubstr("m holds no sections: no time response"));
  // ln 9 and ln 50 time constants.
  EXPECT_THAT(
      text, HasSubstr("a: step to 4, rise 2.197 ms (10 to 90 %), overshoot 0 %, within 2 % after 3.912 ms"));
  const Csv csv = table("t.csv");
  ASSERT_EQ(csv.rows(), 11u);
  for (std::size_t i = 0; i < 11; ++i) {
    // Seven time constants of a, the slowest.
    const double t = csv.column("time_s")[i];
    EXPECT_NEAR(t, 7e-4 * static_cast<double>(i), 1e-12);
    EXPECT_NEAR(csv.column("a_step")[i], 4.0 - 4.0 * std::exp(-1e3 * t), 1e-12);
    EXPECT_NEAR(csv.column("b_impulse_per_s")[i], 1e5 * std::exp(-5e4 * t), 1e-6);
  }
  EXPECT_NE(run_bodesmith("bode " + at("m.csv") + " --time-response " + at("t.csv")).status, 0);
  said("a.json -o o.csv --time-response t.csv --duration-s 0.5 --samples 6");
  EXPECT_NEAR(table("t.csv").column("time_s")[1], 0.1, 1e-15);
}

TEST_F(BodeCommand, PicturesShowWhatTheyAreAskedFor) {
  said("a.json b.json m.csv -o o.csv --svg p.svg --nyquist-svg n.svg --nichols-svg i.svg");
  const std::string bode = read_file(at("p.svg")), nyquist = read_file(at("n.svg"));
  EXPECT_THAT(bode, HasSubstr("Difference from a"));
  EXPECT_THAT(bode, Not(HasSubstr("Group delay")));
  EXPECT_THAT(nyquist, HasSubstr(">a<"));
  EXPECT_THAT(read_file(at("i.svg")), HasSubstr("open-loop phase in degrees"));
  // The difference from a measured one, and of one alone, is none.
  for (const char* files : {"m.csv a.json", "a.json"}) {
    said(std::string(files) + " -o o.csv --svg p.svg");
    EXPECT_THAT(read_file(at("p.svg")), Not(HasSubstr("Difference"))) << files;
  }
  EXPECT_THAT(said("gains.csv -o o.csv --svg p.svg"), HasSubstr("gains has no phase_deg: magnitude only"));
  EXPECT_THAT(read_file(at("p.svg")), Not(HasSubstr("Phase")));
  EXPECT_THAT(bode, HasSubstr("Phase"));
}

}  // namespace
}  // namespace bodesmith
