#include "simulate/sweep.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.hpp"
#include "base/files.hpp"
#include "chain/registry.hpp"
#include "signal/csv.hpp"
#include "temporary_folder.hpp"

namespace bodesmith::simulate {
namespace {

using chain::Chain;
using chain::make_block;

SweepOptions options() {
  SweepOptions o;
  o.kind = "sine";
  o.frequencies = {Hertz{1.0}, Hertz{10.0}, Hertz{40.0}};
  o.amplitudes = {0.5, 2.0};
  o.offset = 0.0;
  o.samples_per_period = 400;
  return o;
}

TEST(Sweep, MeasuresTheResponseOfALag) {
  const Chain chain{{make_block("lowpass").set("corner_hz", 10.0)}};
  auto o = options();
  o.simulation.start = Start::zero;
  o.periods = 12;
  const auto rows = run_sweep(chain, o);
  ASSERT_EQ(rows.size(), 6u);
  for (const auto& row : rows) {
    const double r = row.frequency.value / 10.0;
    EXPECT_NEAR(row.gain_db, -10.0 * std::log10(1.0 + r * r), 2e-3);
    EXPECT_NEAR(row.phase_deg, -std::atan(r) * 180.0 / 3.14159265358979, 0.02);
    EXPECT_LT(row.distortion_percent, 0.02);
  }
  EXPECT_EQ(rows[1].amplitude, 2.0);
  EXPECT_EQ(rows[2].frequency, Hertz{10.0});
}

TEST(Sweep, HysteresisHasItsHeight) {
  // Play of width w under a triangle of range 1: a loop of height w, the output's range 1 - w.
  const Chain chain{{make_block("backlash").set("width", 0.2)}};
  auto o = options();
  o.kind = "triangle";
  o.amplitudes = {0.5};
  o.offset.reset();
  for (const auto& row : run_sweep(chain, o)) EXPECT_NEAR(row.loop_height_percent, 100.0 * 0.2 / 0.8, 0.5);
}

TEST(Sweep, TablesOfLoopsAndSpectraAreThoseOfItsRows) {
  // A quadratic curve: of a sine of 1 about 0 half of the constant and of the second harmonic, at every frequency.
  const Chain chain{{make_block("polynomial").set("coefficients", std::vector<double>{0.0, 1.0, 0.5})}};
  auto o = options();
  o.amplitudes = {1.0};
  o.keep_periods = true;
  const auto rows = run_sweep(chain, o);
  const Csv spectra = Csv::parse(sweep_spectra_csv(rows), "spectra.csv");
  ASSERT_EQ(spectra.rows(), 3u * 201u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(spectra.column("frequency_hz")[201 * i], rows[i].frequency.value);
    const double wanted[] = {0.25, 1.0, 0.25, 0.0};
    for (std::size_t k = 0; k < 4; ++k) {
      EXPECT_EQ(spectra.column("harmonic")[201 * i + k], static_cast<double>(k));
      EXPECT_NEAR(spectra.column("y_amplitude")[201 * i + k], wanted[k], 1e-9);
      EXPECT_NEAR(spectra.column("u_amplitude")[201 * i + k], k == 1 ? 1.0 : 0.0, 1e-9);
    }
  }
  const Csv loops = Csv::parse(sweep_loops_csv(rows), "loops.csv");
  ASSERT_GT(loops.rows(), 250u);
  for (std::size_t i = 0; i < loops.rows();
       ++i) {  // no memory: both branches are the curve, between samples straight
    const double u = loops.column("u")[i];
    EXPECT_NEAR(loops.column("ascending")[i], u + 0.5 * u * u, 1e-4);
    EXPECT_NEAR(loops.column("descending")[i], u + 0.5 * u * u, 1e-4);
  }
}

TEST(Sweep, RowsDoNotDependOnThreadsAndResume) {
  const Chain chain{{make_block("polynomial").set("coefficients", std::vector<double>{0.0, 1.0, 0.2}),
                     make_block("lowpass").set("corner_hz", 30.0)}};
  auto o = options();
  o.threads = 1;
  const std::string key = sweep_key("abc", o);
  const std::string one = sweep_csv(run_sweep(chain, o), key);
  o.threads = 3;
  const auto rows = run_sweep(chain, o);
  EXPECT_EQ(sweep_csv(rows, key), one);
  EXPECT_EQ(sweep_key("abc", o), key);
  const TemporaryFolder folder;
  write_file(folder / "part.csv", sweep_csv({rows.begin(), rows.begin() + 4}, key));
  auto known = read_sweep_csv(folder / "part.csv", key);
  ASSERT_EQ(known.size(), 4u);
  known[1].rms_percent = 123.0;  // shows that it is taken over, not worked out again
  const auto resumed = run_sweep(chain, o, known);
  EXPECT_EQ(resumed[1].rms_percent, 123.0);
  EXPECT_EQ(resumed[5].rms_percent, rows[5].rms_percent);
  EXPECT_TRUE(read_sweep_csv(folder / "part.csv", sweep_key("other", o)).empty());
  EXPECT_TRUE(read_sweep_csv(folder / "none.csv", key).empty());
  o.kind = "chirp";
  EXPECT_THROW(run_sweep(chain, o), InputError);
}

}  // namespace
}  // namespace bodesmith::simulate
