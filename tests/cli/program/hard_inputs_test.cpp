// Inputs that once crashed, hung, or were answered wrongly without a word.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "base/documents/json.hpp"
#include "base/files.hpp"
#include "run_program.hpp"
#include "signal/bode_points.hpp"
#include "signal/csv.hpp"
#include "temporary_folder.hpp"
#include "texts.hpp"

namespace bodesmith {
namespace {
using testing::HasSubstr;
using testing::Not;

/// gain/(1 + s/1000)^2 exp(-s delay)
std::string lags(double gain, double delay_s) {
  return fmt::format(R"({{"schema": "bodesmith.sections/1", "gain": {}, "delay_s": {},
 "sections": [{{"gain": 1e6, "zeros_rad_s": [], "poles_rad_s": [[-1000.0, 0.0], [-1000.0, 0.0]]}}]}})",
                     gain, delay_s);
}

class HardInputs : public testing::Test {
 protected:
  std::string at(const std::string& name) const { return (folder_ / name).string(); }
  void write(const std::string& name, const std::string& text) const { write_file(folder_ / name, text); }
  /// One line and status 2.
  std::string refusal(const std::string& arguments) const {
    const ProgramResult run = run_bodesmith(arguments);
    EXPECT_EQ(run.status, 2) << arguments << run.err;
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    return run.err;
  }

 private:
  TemporaryFolder folder_;
};

TEST_F(HardInputs, EveryReaderOfSectionsHasTheirDelay) {
  static constexpr double kDelay = 0.01;
  write("a.json", lags(5.0, kDelay));
  const auto wanted = [](double hz) {
    const std::complex<double> s(0.0, 2.0 * std::numbers::pi * hz);
    return 5.0 / ((1.0 + s / 1e3) * (1.0 + s / 1e3)) * std::exp(-s * kDelay);
  };
  // On three frequencies far apart: the phase falls by many turns between them.
  ASSERT_EQ(run_bodesmith("bode " + at("a.json") +
                          " --nyquist --group-delay --from-hz 10 --to-hz 1000 --count 3 -o " + at("bode.csv"))
                .status,
            0);
  const Csv bode = Csv::parse(read_file(at("bode.csv")), "bode.csv");
  for (std::size_t i = 0; i < 3; ++i) {
    const double f = bode.column("frequency_hz")[i];
    EXPECT_NEAR(
        bode.column("a_phase_deg")[i],
        -2.0 * std::atan(2.0 * std::numbers::pi * f / 1e3) * 180.0 / std::numbers::pi - 360.0 * f * kDelay,
        1e-8);
    EXPECT_NEAR(bode.column("a_re")[i], wanted(f).real(), 1e-9);
    EXPECT_GT(bode.column("a_group_delay_s")[i], kDelay);
  }
  for (const char* name : {"out.frd", "out.csv", "out.s2p", "out.mat"}) {
    ASSERT_EQ(run_bodesmith("export " + at("a.json") + " --from-hz 10 --to-hz 1000 --count 5 -o " + at(name))
                  .status,
              0);
    Provenance from;
    const FrequencyRecord record = FrequencyRecord::read_csv(at(name), from);
    ASSERT_EQ(record.frequency.size(), 5u) << name;
    for (std::size_t i = 0; i < 5; ++i)
      EXPECT_LT(std::abs(record.response[i] - wanted(record.frequency[i].value)), 1e-9) << name;
  }
  // |L| = 1 at w = 2000/s, where the lags turn by 126.9 degrees and the delay by 1146.
  const ProgramResult margins = run_bodesmith("bode --margins --json " + at("a.json"));
  const Json said = parsed(margins.out)["responses"][0]["margins"];
  EXPECT_NEAR(said["gain_crossings"][0]["phase_margin_deg"].get<double>(),
              std::remainder(
                  180.0 - 2.0 * std::atan(2.0) * 180.0 / std::numbers::pi - 3600.0 / std::numbers::pi, 360.0),
              1e-6);
  EXPECT_EQ(said["closed_loop_stable"], false);
}

TEST_F(HardInputs, DocumentsThatNestWithoutEnd) {
  std::string key = "a";
  for (int i = 0; i < 70000; ++i) key += ".a";
  write("deep.toml", "\n" + key + " = 1\n");
  EXPECT_THAT(refusal("simulate " + at("deep.toml") + " --input x.csv -o " + at("y.csv")),
              HasSubstr("deep.toml:2: has a key of more than 200 parts"));
  write("table.toml", "[" + key + "]\nx = 1\n");
  EXPECT_THAT(refusal("run " + at("table.toml") + " -o " + at("out")), HasSubstr("table.toml:1: has a key"));
  write("big.json", R"({"schema": "bodesmith.sections/1", "gain": 1e999})");
  const std::string said = refusal("bode " + at("big.json"));
  EXPECT_THAT(said, HasSubstr("number overflow"));
  EXPECT_THAT(said, Not(HasSubstr("json.exception")));
}

TEST_F(HardInputs, AbsurdNumbersAreAnswered) {
  const auto pid = [&](const std::string& kd, const std::string& lambda) {
    write("pid.toml", "schema = \"bodesmith.fractional/1\"\n[pid]\nkp = 1.0\nki = 2.0\nlambda = " + lambda +
                          "\nkd = " + kd + "\nmu = 0.8\n");
  };
  pid("1e300", "0.9");
  const ProgramResult steep = run_bodesmith("approximate " + at("pid.toml") +
                                            " --from-hz 0.1 --to-hz 1000 --order 4 -o " + at("s.json"));
  EXPECT_EQ(steep.status, 0) << steep.err;
  EXPECT_THAT(steep.out, HasSubstr("stable by the argument principle"));
  pid("1.0", "4e9");
  EXPECT_THAT(refusal("bode " + at("pid.toml")),
              HasSubstr("pid.toml:5: 'pid.lambda' is 4000000000, expected a power of at most 100"));
  write("steep.json",
        R"({"schema": "bodesmith.cascade/1", "terms": [{"lambda_s": 0.001, "x": 0.1, "beta": 1e308}]})");
  EXPECT_THAT(refusal("approximate " + at("steep.json") + " -o " + at("s.json")),
              HasSubstr("more than double precision can hold"));
  write("a.json", lags(1.0, 0.0));
  EXPECT_THAT(refusal("yield " + at("a.json") + " --threads -1"), HasSubstr("--threads"));
  EXPECT_THAT(refusal("yield " + at("a.json") + " --samples -1"),
              HasSubstr("--samples is -1, expected a whole number not below 0"));
  EXPECT_THAT(refusal("yield " + at("a.json") + " --temperature-low-c -274"), HasSubstr("absolute zero"));
  EXPECT_THAT(refusal("approximate " BODESMITH_SOURCE_DIR
                      "/examples/papers/printed_cascade.json --method pade --over-band -o " +
                      at("s.json")),
              HasSubstr("--over-band does nothing with what is asked for here"));
  EXPECT_THAT(refusal("fpaa " + at("a.json") + " --opamp-gain 100 -o " + at("board")),
              HasSubstr("--opamp-gain does nothing"));
  EXPECT_THAT(refusal("yield " + at("a.json") + " --resistor-ppm 50"),
              HasSubstr("--resistor-ppm does nothing"));
  EXPECT_THAT(refusal("fpaa " + at("a.json") + " --min-clock-hz 1e9 -o " + at("board")),
              HasSubstr("at clocks of 1e+09 Hz and more"));
  EXPECT_THAT(refusal("fit " BODESMITH_SOURCE_DIR
                      "/examples/nanopositioner/gains.csv --direct --order 2 --least-damping 2 -o " +
                      at("s.json")),
              HasSubstr("--least-damping is above 1"));
  EXPECT_THAT(refusal("fpaa " + at("a.json") + " --switch-ohm 1e12 -o " + at("board")),
              HasSubstr("does not settle"));
  write("loop.json", R"({"schema": "bodesmith.disturbance/1",
 "ascending": [0.3, -0.3, 1e308], "descending": [0.2, -0.2, 0]})");
  EXPECT_THAT(refusal("controller " + at("loop.json") + " -o " + at("c")),
              HasSubstr("loop.json:2: 'ascending[2]' is 1e+308, expected at most 1e6"));
  write("slow.json", R"({"schema": "bodesmith.disturbance/1", "ascending": [0.3, -0.3, 0],
 "descending": [0.2, -0.2, 0], "rate": {"frequency_hz": [1e-308, 10], "ascending": [1, 1], "descending": [1, 1.1]}})");
  EXPECT_THAT(refusal("controller " + at("slow.json") + " -o " + at("c")),
              HasSubstr("is not within 1e-6 to 1e9"));
  EXPECT_THAT(refusal("controller " BODESMITH_SOURCE_DIR
                      "/examples/nanopositioner/disturbance.json --amplitude 4e9 -o " +
                      at("c")),
              HasSubstr("expected 1e-06 to 1"));
  EXPECT_THAT(refusal("design lowpass --family elliptic --order 4 --corner-hz 1000 --stop-db 1e308 -o " +
                      at("s.json")),
              HasSubstr("expected 1e-09 to 1000"));
  write("m.toml", "schema = \"bodesmith.model/1\"\n[[block]]\ntype = \"gain\"\ngain = 1.0\n");
  write("u.csv", "time_s,u\n0,0\n0.001,1\n0.002,0\n");
  EXPECT_THAT(refusal("simulate " + at("m.toml") + " --input " + at("u.csv") + " --spectra " + at("s.csv") +
                      " --fundamental-hz 1e300 -o " + at("y.csv")),
              HasSubstr("not below half the sampling rate"));
  write("gains.csv", "frequency_hz,gain\n1,1\n10,2\n100,1\n");
  EXPECT_THAT(refusal("fit " + at("gains.csv") + " --lower=abc -o " + at("c.json")),
              HasSubstr("--lower is for another kind of work: 'With --direct'"));
  EXPECT_THAT(refusal("tune " + at("a.json") + " --bandwidth-hz 1e308 -o " + at("c.json")),
              HasSubstr("--bandwidth-hz is 1e+308, expected 1e-6 to 1e9 Hz"));
  EXPECT_THAT(refusal("fpaa " + at("a.json") + " --unit-capacitance-f 1e308 -o " + at("board")),
              HasSubstr("expected 1e-18 to 1e-6 F"));
  EXPECT_THAT(refusal("simulate " + at("m.toml") + " --reference sine --steps 5 -o " + at("y.csv")),
              HasSubstr("--steps does nothing with what is asked for here"));
  EXPECT_THAT(refusal("simulate " + at("m.toml") + " --reference sine --duration-s 1e308 -o " + at("y.csv")),
              HasSubstr("a reference of 1e+308 s in steps of 0.001 s, expected 2 to 50 million samples"));
}

TEST_F(HardInputs, OutputsReplaceNoInputAndStandTogether) {
  const std::string include = "R9 in out 1k\nC9 out 0 1u\n";
  write("part.inc", include);
  write("top.sub", ".subckt compensator in out\n.include part.inc\n.ends\n");
  EXPECT_THAT(refusal("bode " + at("top.sub") + " -o " + at("part.inc")), HasSubstr("it is an input"));
  EXPECT_EQ(read_file(at("part.inc")), include);
  write("self.sub", ".subckt compensator in out\nR1 in out 1k\n.include self.sub\n.ends\n");
  EXPECT_THAT(refusal("bode " + at("self.sub")),
              HasSubstr("self.sub:3: includes self.sub, which includes this"));
  write("a.json", lags(1.0, 0.0));
  EXPECT_THAT(refusal("bode " + at("a.json") + " -o " + at("first.csv") + " --svg /dev/full"),
              HasSubstr("/dev/full: cannot be written"));
  EXPECT_FALSE(std::filesystem::exists(at("first.csv")));
  EXPECT_THAT(refusal("new " + at("made") + " --kind filter --kd 1"), HasSubstr("--kd does nothing"));
  EXPECT_FALSE(std::filesystem::exists(at("made")));
  // While another process writes into a folder nobody else does.
  std::filesystem::create_directory(at("out"));
  const ProgramResult second = run_shell("flock " + at("out") + " " + BODESMITH_PROGRAM + " spice " +
                                         at("a.json") + " -o " + at("out"));
  EXPECT_EQ(second.status, 2);
  EXPECT_THAT(second.err, HasSubstr("is being written by another run"));
  ASSERT_EQ(run_shell("mkfifo " + at("pipe")).status, 0);
  EXPECT_THAT(refusal("bode " + at("pipe")), HasSubstr("is a pipe into which nobody writes"));
  write("gains.csv", "frequency_hz,gain\n1,1\n10,2\n100,1\n");
  const ProgramResult slow = run_shell("(sleep 0.2; cat " + at("gains.csv") + " >" + at("pipe") + ") & " +
                                       BODESMITH_PROGRAM + " fit " + at("pipe") + " -o " + at("c.json"));
  EXPECT_EQ(slow.status, 0) << slow.err;
}

/// What is refused writes nothing, whichever option names its files.
TEST_F(HardInputs, WhatIsRefusedLeavesNoFileOfAnyOption) {
  std::string timed = "time_s,u,y\n", bare = "u,y\n";
  for (int i = 0; i < 400; ++i) {
    const double x = i % 100 < 50 ? i % 100 / 50.0 : 2.0 - i % 100 / 50.0;
    const std::string row = fmt::format("{},{}\n", x, x + (i % 100 < 50 ? 0.3 : -0.2) * x * (1.0 - x));
    timed += fmt::format("{},{}", i * 0.01, row);
    bare += row;
  }
  write("loop.csv", timed);
  write("bare.csv", bare);
  write("a.json", lags(1.0, 0.0));
  const auto stage = [&](const std::string& record) {
    return "identify " + at(record) + " --disturbance " + at("d.json");
  };
  for (const std::string& command :
       {stage("loop.csv") + " --skip-s 1", stage("loop.csv") + " --max-error-percent -1",
        "bode " + at("a.json") + " --svg " + at("b.svg") + " --samples 7",
        "bode " + at("a.json") + " -o " + at("b.csv") + " --nyquist-svg ''"}) {
    refusal(command);
    for (const char* name : {"d.json", "b.svg", "b.csv"})
      EXPECT_FALSE(std::filesystem::exists(at(name))) << command << ": " << name;
  }
  EXPECT_THAT(refusal("bode " + at("a.json") + " --nyquist-svg ''"), HasSubstr("--nyquist-svg is empty"));
  EXPECT_EQ(run_bodesmith(stage("bare.csv") + " --sample-hz 100").status, 0);
}

/// Zeros on the axis: judged where there is a response. (A band stop once never ended.)
TEST_F(HardInputs, FiltersWithZerosOnTheAxisAreBuilt) {
  for (const char* design :
       {"lowpass --family elliptic --order 3 --corner-hz 1000 --ripple-db 0.5 --stop-db 40",
        "bandstop --order 2 --from-hz 45 --to-hz 55"}) {
    ASSERT_EQ(run_bodesmith(std::string("design ") + design + " -o " + at("f.json")).status, 0);
    const ProgramResult spice = run_bodesmith("spice " + at("f.json") + " -o " + at("hw"));
    // On the flanks of a deep notch parts of a series may be off by more than the usual limit, which is said.
    EXPECT_LE(spice.status, 1) << design << spice.err;
    EXPECT_THAT(spice.out, Not(HasSubstr("inf"))) << design;
    EXPECT_THAT(spice.out, Not(HasSubstr("nan"))) << design;
    const ProgramResult yield = run_bodesmith("yield " + at("f.json") + " --samples 1000");
    EXPECT_EQ(yield.status, 0) << design << yield.err;
    EXPECT_THAT(yield.out, HasSubstr("below -60 dB of its largest")) << design;
  }
}

}  // namespace
}  // namespace bodesmith
