// What is written for other programs: read back by this program's readers, run by a C compiler and by ngspice.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <sstream>

#include "base/error.hpp"
#include "base/files.hpp"
#include "exchange/writer.hpp"
#include "kept_text.hpp"
#include "lti/frequency_grid.hpp"
#include "lti/steep_flanks.hpp"
#include "run_program.hpp"
#include "temporary_folder.hpp"

namespace bodesmith::exchange {
namespace {

using Complex = std::complex<double>;
using testing::HasSubstr;

/// A damped pair beside a real pole and zero: corners of 100 Hz and 1 kHz.
Sections two_sections() {
  Sections out;
  out.gain = 2.0;
  const double a = 2.0 * std::numbers::pi * 100.0;
  const double b = 2.0 * std::numbers::pi * 1000.0;
  out.sections.push_back({3.0, {-3.0 * a}, {-a}});
  out.sections.push_back({b * b, {}, {std::polar(b, 2.0), std::polar(b, -2.0)}});
  return out;
}

Exportable designed() {
  Exportable out;
  out.source = "sections.json";
  out.name = "sections";
  out.sections = two_sections();
  FrequencyRecord record;
  record.frequency = log_grid({Hertz{10.0}, Hertz{1e4}}, 25);
  for (const Hertz f : record.frequency) record.response.push_back(out.sections->response(f.rad_s()));
  out.response = record;
  return out;
}

Exportable recorded() {
  Exportable out;
  out.source = "drive.csv";
  out.name = "drive";
  TimeRecord record;
  record.start_s = -0.5;
  record.step_s = 1.0 / 128.0;
  for (int i = 0; i < 64; ++i) {
    record.u.push_back(std::sin(0.3 * i));
    record.y.push_back(std::cos(0.3 * i) / 3.0);
  }
  out.record = record;
  return out;
}

std::filesystem::path written(const TemporaryFolder& folder, const std::string& name,
                              const Exportable& from) {
  write_file(folder / name, writer_for(name).write(from, {}).content);
  return folder / name;
}

TEST(Export, ResponsesReadBack) {
  const TemporaryFolder folder;
  const Exportable from = designed();
  for (const char* name : {"a.s2p", "a.frd", "a.csv", "a.mat"}) {
    Provenance ignored;
    const FrequencyRecord back = FrequencyRecord::read_csv(written(folder, name, from), ignored);
    ASSERT_EQ(back.frequency.size(), 25u) << name;
    for (std::size_t i = 0; i < 25; ++i) {
      EXPECT_DOUBLE_EQ(back.frequency[i].value, from.response->frequency[i].value) << name;
      EXPECT_LT(std::abs(back.response[i] / from.response->response[i] - 1.0), 1e-14) << name;
    }
  }
}

TEST(Export, RecordsReadBack) {
  const TemporaryFolder folder;
  const Exportable from = recorded();
  for (const char* name : {"a.csv", "a.mat"}) {
    Provenance ignored;
    const TimeRecord back = TimeRecord::read_csv(written(folder, name, from), ignored, true);
    EXPECT_EQ(back.u, from.record->u) << name;
    EXPECT_EQ(back.y, from.record->y) << name;
    EXPECT_EQ(back.start_s, -0.5);
    EXPECT_EQ(back.step_s, 1.0 / 128.0);
  }
  Provenance ignored;
  const TimeRecord points = TimeRecord::read_csv(written(folder, "a.pwl", from), ignored);
  EXPECT_EQ(points.u, from.record->u);
  EXPECT_EQ(points.start_s, 0.0);  // moved: sources begin at 0
}

TEST(Export, TheSameInputGivesTheSameBytes) {
  EXPECT_EQ(writer_for("a.mat").write(designed(), {}).content,
            writer_for("b.mat").write(designed(), {}).content);
}

TEST(Export, LevelStretchesNeedTheirEndsOnly) {
  Exportable from = recorded();
  from.record->u.assign(64, 1.0);
  from.record->u[40] = 2.0;
  const std::string text = writer_for("a.pwl").write(from, {}).content;
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 5);
  EXPECT_THAT(text, HasSubstr("0.3125 2.0\n"));
}

TEST(Export, RefusesWhatAFormatCannotHold) {
  const auto refusal = [](const char* name, const Exportable& from) {
    try {
      writer_for(name).write(from, {});
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  EXPECT_THAT(refusal("a.py", recorded()),
              HasSubstr("drive.csv: is a time record, but python-control needs pole-zero"));
  EXPECT_THAT(refusal("a.pwl", designed()), HasSubstr("but pwl needs a time record"));
  EXPECT_THAT(refusal("a.s2p", recorded()), HasSubstr("needs a complex frequency response"));
  EXPECT_THAT(refusal("a.c", designed()), HasSubstr("sampling rate"));
  EXPECT_THROW(writer_for("a.docx"), InputError);
  Exportable one = recorded();
  one.record->y.clear();
  ExportOptions second;
  second.output_signal = true;
  EXPECT_NO_THROW(writer_for("a.pwl").write(one, {}));
  EXPECT_THROW(writer_for("a.pwl").write(one, second), InputError);
}

DigitalFilter digital(Discretisation method, double sample_hz, std::optional<Hertz> prewarp = {}) {
  DiscretiseOptions options;
  options.method = method;
  options.sample_hz = sample_hz;
  options.prewarp = prewarp;
  return discretise(two_sections(), options);
}

TEST(Discretise, TustinIsTheWarpedAxis) {
  // s = K (z - 1)/(z + 1): the digital filter at f is the analog one at K tan(w T/2).
  const DigitalFilter one = digital(Discretisation::tustin, 8000.0, Hertz{1000.0});
  EXPECT_LT(std::abs(one.response(Hertz{1000.0}) / two_sections().response(Hertz{1000.0}.rad_s()) - 1.0),
            1e-13);
  const double k = Hertz{1000.0}.rad_s().value / std::tan(std::numbers::pi / 8.0);
  for (const double f : {50.0, 400.0, 3000.0}) {
    const RadPerSecond warped{k * std::tan(std::numbers::pi * f / 8000.0)};
    EXPECT_LT(std::abs(one.response(Hertz{f}) / two_sections().response(warped) - 1.0), 1e-12) << f;
  }
}

TEST(Discretise, MatchedHasThePolesAndTheGainAtDc) {
  const DigitalFilter filter = digital(Discretisation::matched, 8000.0);
  EXPECT_NEAR(filter.biquads[0].a1, -std::exp(-2.0 * std::numbers::pi * 100.0 / 8000.0), 1e-15);
  EXPECT_NEAR(filter.biquads[1].a2, std::exp(2.0 * std::cos(2.0) * 2.0 * std::numbers::pi * 1000.0 / 8000.0),
              1e-15);
  EXPECT_NEAR(filter.response(Hertz{0.0}).real() / two_sections().dc_gain(), 1.0, 1e-13);
}

/// Each section meets the analog one where its gain is: Tustin at its poles' geometric mean, or, where that lies beyond .9 of half the
/// rate, at DC with K = 2/T; matched at DC, where it has no gain there at its highest pole, and everywhere at `prewarp`.
TEST(Discretise, EverySectionIsExactWhereItSays) {
  constexpr double kRate = 8000.0;
  struct Case {
    Section section;
    Discretisation method;
    std::optional<Hertz> prewarp;
    double analog_hz, digital_hz;
  };
  const auto w = [](double hz) { return Hertz{hz}.rad_s().value; };
  const double warped = kRate / std::numbers::pi * std::tan(std::numbers::pi * 700.0 / kRate);
  const Section lag{1.0, {}, {-w(100.0)}}, pair{1.0, {}, {-w(200.0), -w(800.0)}},
      high{1.0, {0.0}, {-w(300.0)}}, fast{1.0, {}, {-w(3700.0)}}, integrator{1.0, {}, {0.0}},
      slow_high{1.0, {0.0}, {-w(0.1)}}, quick_high{1.0, {0.0}, {-w(3000.0)}};
  constexpr auto kTustin = Discretisation::tustin, kMatched = Discretisation::matched;
  for (const auto& [section, method, prewarp, analog_hz, digital_hz] :
       std::initializer_list<Case>{{lag, kTustin, {}, 100.0, 100.0},
                                   {pair, kTustin, {}, 400.0, 400.0},
                                   {fast, kTustin, {}, warped, 700.0},
                                   {integrator, kTustin, {}, warped, 700.0},
                                   {pair, kTustin, Hertz{700.0}, 700.0, 700.0},
                                   {pair, kMatched, {}, 0.0, 0.0},
                                   {high, kMatched, {}, 300.0, 300.0},
                                   {slow_high, kMatched, {}, 0.8, 0.8},
                                   {quick_high, kMatched, {}, 1000.0, 1000.0},
                                   {integrator, kMatched, {}, 0.8, 0.8},
                                   {high, kMatched, Hertz{700.0}, 700.0, 700.0}}) {
    Sections all;
    all.sections = {section};
    DiscretiseOptions options;
    options.method = method;
    options.sample_hz = kRate;
    options.prewarp = prewarp;
    const Complex got = discretise(all, options).response(Hertz{digital_hz}),
                  wanted = section.response(Hertz{analog_hz}.rad_s());
    EXPECT_NEAR(std::abs(got / wanted), 1.0, 1e-9) << to_string(method) << " " << analog_hz;
    if (method == kTustin) {
      EXPECT_LT(std::abs(got / wanted - 1.0), 1e-9) << analog_hz;
    }
  }
}

TEST(Discretise, OneBitBehindThePointIsTheLeastAndWithoutCornersTheBandIsTheRates) {
  Sections one;
  one.sections = {{500.0, {}, {-500.0}}};
  DiscretiseOptions options;
  options.sample_hz = 500.0;
  options.fixed_bits = 2;  // no coefficient reaches 1
  EXPECT_EQ(discretise(one, options).fraction_bits, 1);
  options.fixed_bits = 1;
  EXPECT_THROW(discretise(one, options), InputError);
  one.sections.clear();
  options.fixed_bits = 0;
  const DigitalFilter flat = discretise(one, options);
  EXPECT_DOUBLE_EQ(flat.error.band.to.value, 225.0);
  EXPECT_DOUBLE_EQ(flat.error.band.from.value, 0.225);
}

TEST(Discretise, ARootBeyondAllNumbersIsRefusedAndOnlyWhereItIsOne) {
  // exp(1e9/8000) is none; Tustin's (k + 1e9)/(k - 1e9) is about -1.
  Exportable far = designed();
  far.sections->sections[0].zeros = {1e9};
  DiscretiseOptions options;
  options.sample_hz = 8000.0;
  EXPECT_NO_THROW(discretise(*far.sections, options));
  ExportOptions wanted;
  wanted.discretise = options;
  EXPECT_THAT(
      testing::PrintToString(writer_for("a.c").write(far, wanted).said),
      HasSubstr(
          "matched would not do: section 1 has a root that matched at 8000 Hz takes beyond all numbers"));
  options.method = Discretisation::matched;
  options.fixed_bits = 18;  // rounded, no number becomes one
  EXPECT_THROW(discretise(*far.sections, options), InputError);
}

TEST(Discretise, TheErrorToldIsTheLargestThereIs) {
  for (const Discretisation method : {Discretisation::tustin, Discretisation::matched}) {
    const DigitalFilter filter = digital(method, 8000.0);
    EXPECT_DOUBLE_EQ(filter.error.band.from.value, 10.0);
    EXPECT_DOUBLE_EQ(filter.error.band.to.value, 3600.0);
    double decibel = 0.0;
    for (const Hertz f : log_grid(filter.error.band, 1000)) {
      const Complex ratio = filter.response(f) / two_sections().response(f.rad_s());
      decibel = std::max(decibel, std::abs(to_decibel(std::abs(ratio))));
    }
    EXPECT_NEAR(filter.error.max_magnitude_db, decibel, 1e-9);
    EXPECT_GT(decibel, 0.1);
    // A delay is none of the filter's errors.
    Sections late = two_sections();
    late.delay_s = 2e-3;
    DiscretiseOptions options;
    options.method = method;
    options.sample_hz = 8000.0;
    EXPECT_NEAR(discretise(late, options).error.max_phase_deg, filter.error.max_phase_deg, 1e-9);
    // Ten times the rate: about a hundredth of the error within a fixed band.
    const double fine = std::abs(digital(method, 80000.0).response(Hertz{300.0}) /
                                     two_sections().response(Hertz{300.0}.rad_s()) -
                                 1.0);
    EXPECT_LT(fine, 2e-2);
  }
  EXPECT_THROW(digital(Discretisation::tustin, 150.0), InputError);
  EXPECT_THROW(digital(Discretisation::tustin, 8000.0, Hertz{4000.0}), InputError);
}

/// A shifted notch is tens of decibels off at its own frequency: who reads the smaller figure is told what it means.
TEST(Export, ErrorsToldAsShiftsSaySo) {
  Exportable from = designed();
  from.sections->sections.push_back({1.0,
                                     {Complex(0.0, 6000.0), Complex(0.0, -6000.0)},
                                     {Complex(-3000.0, 5000.0), Complex(-3000.0, -5000.0)}});
  ExportOptions options;
  options.discretise.sample_hz = 48000.0;
  const auto tells = [&](const char* name) {
    const Written out = writer_for(name).write(from, options);
    return out.content.find(kFlanksText) != std::string::npos &&
           std::ranges::count(out.said, std::string(kFlanksText)) == 1;
  };
  EXPECT_TRUE(tells("f.c"));
  EXPECT_TRUE(tells("f.vh"));
  from.sections->sections.back().zeros.clear();
  EXPECT_FALSE(tells("f.c"));
}

TEST(Export, TheCFileFiltersAsItsBiquadsSay) {
  if (run_shell("command -v cc").status != 0) GTEST_SKIP() << "no C compiler";
  const TemporaryFolder folder;
  for (const bool single : {false, true}) {
    ExportOptions options;
    options.discretise.sample_hz = 8000.0;
    options.discretise.single_precision = single;
    write_file(folder / "filter.c", writer_for("filter.c").write(designed(), options).content);
    write_file(
        folder / "main.c",
        "#include <stdio.h>\n#include \"filter.c\"\nint main(void) {\n  sections_state s = { 0 };\n  int i;\n"
        "  for (i = 0; i < 2000; ++i) printf(\"%.17g\\n\", (double)sections_step(&s, i == 0));\n  return 0;\n}\n");
    const std::string at = folder.path().string();
    const ProgramResult run = run_shell("cc -std=c99 -Wall -Wextra -Werror -o " + at + "/filter " + at +
                                        "/main.c && " + at + "/filter");
    ASSERT_EQ(run.status, 0) << run.err;
    const DigitalFilter filter = discretise(two_sections(), options.discretise);
    // The transform of the impulse response is the filter's response.
    for (const double f : {30.0, 300.0, 2500.0}) {
      std::istringstream samples(run.out);
      Complex sum = 0.0;
      double h = 0.0;
      for (int i = 0; samples >> h; ++i) sum += h * std::polar(1.0, -2.0 * std::numbers::pi * f / 8000.0 * i);
      EXPECT_LT(std::abs(sum / filter.response(Hertz{f}) - 1.0), single ? 1e-5 : 1e-12) << f;
    }
  }
}

TEST(Export, FixedPointIsTheNearestAndItsErrorIsTold) {
  ExportOptions options;
  options.discretise.sample_hz = 100e3;
  DiscretiseOptions rounded = options.discretise;
  const DigitalFilter exact = discretise(two_sections(), rounded);
  double before = 1e9;
  for (const int bits : {16, 20, 24, 32}) {
    rounded.fixed_bits = bits;
    const DigitalFilter filter = discretise(two_sections(), rounded);
    EXPECT_EQ(filter.gain, 1.0);
    for (std::size_t i = 0; i < filter.biquads.size(); ++i) {
      const double step = std::ldexp(1.0, -filter.fraction_bits);
      EXPECT_NEAR(filter.biquads[i].a1, exact.biquads[i].a1, 0.5 * step);
      EXPECT_EQ(std::remainder(filter.biquads[i].a2, step), 0.0);
      EXPECT_LT(std::abs(std::ldexp(filter.biquads[i].a1, filter.fraction_bits)), std::ldexp(1.0, bits - 1));
    }
    EXPECT_LE(filter.error.max_complex_percent, before * 1.001);
    before = filter.error.max_complex_percent;
  }
  EXPECT_NEAR(before, exact.error.max_complex_percent, 1e-3 * exact.error.max_complex_percent);
  // Eq. 25: two biquads are ten products, 40 MHz and one multiplier 4 million samples a second.
  options.bits = 18;
  const Written written = writers().get("verilog-biquads").write(designed(), options);
  EXPECT_THAT(written.content,
              HasSubstr("10 products a sample: 1 multiplier at 40 MHz gives 4 M samples a second"));
  EXPECT_THAT(written.content, HasSubstr("localparam signed [17:0] sections_a2_2 ="));
  options.bits = 4;
  EXPECT_THROW(writers().get("verilog-biquads").write(designed(), options), InputError);
}

TEST(Export, NgspiceFollowsTheSource) {
  if (run_shell("command -v ngspice").status != 0) GTEST_SKIP() << "no ngspice";
  const TemporaryFolder folder;
  const Exportable from = recorded();
  written(folder, "drive.inc", from);
  const std::string at = folder.path().string();
  write_file(folder / "deck.cir", "* source\n.include " + at +
                                      "/drive.inc\nR1 drive 0 1k\n.control\ntran 1m 0.49\nwrite " + at +
                                      "/out.raw v(drive)\nquit\n.endc\n.end\n");
  run_shell("ngspice -b " + at + "/deck.cir");
  Provenance ignored;
  const TimeRecord got = TimeRecord::read_csv(folder / "out.raw", ignored);
  for (std::size_t i = 0; i < got.size(); i += 10) {
    const double place = got.time_s(i) / from.record->step_s;
    const auto k = std::min(static_cast<std::size_t>(place), from.record->size() - 2);
    const double t = place - static_cast<double>(k);
    EXPECT_NEAR(got.u[i], (1.0 - t) * from.record->u[k] + t * from.record->u[k + 1], 3e-3);
  }
}

/// A model of one block, as scripts rebuild it.
Exportable with_chain() {
  Exportable out = designed();
  out.source = "model.toml";
  out.chain = {{"lag", {{-2.0, 1.0, 0.0, -3.0}, {0.0, 3.0}, {1.0, 0.5}, {}, 0.25, 0.0}, 1e-3}};
  return out;
}

/// All that is written of what hangs on no last bits; a compiler, ngspice and Python's and Octave's own tests take these files.
TEST(Export, EveryFormatIsTheTextThatWasKept) {
  std::string all;
  const auto add = [&](const char* name, const Exportable& from, const ExportOptions& options) {
    const Written made = writer_for(name).write(from, options);
    all += std::string("==== ") + name + " of " + from.source + "\n" + made.content;
    for (const std::string& said : made.said) all += "-- " + said + "\n";
  };
  ExportOptions options;
  options.discretise.sample_hz = 8000.0;
  Exportable late = designed();
  late.sections->delay_s = 1.5e-3;
  add("a.c", late, options);
  options.discretise.prewarp = Hertz{500.0};
  options.discretise.single_precision = options.output_signal = true;
  options.multipliers = 2;
  options.clock_hz = 30e3;
  add("a.c", designed(), options);
  add("a.vh", designed(), options);
  Exportable record = recorded();
  record.record->u.resize(5);
  record.record->y = {1.0, -3.0, -3.0, -3.0, 2.0};
  add("a.inc", record, options);
  add("a.py", late, {});
  add("a.py", with_chain(), {});
  Exportable flat = designed();
  flat.sections->sections.clear();
  add("a.m", flat, {});
  expect_kept("exchange/kept_writers.txt", all);
}

}  // namespace
}  // namespace bodesmith::exchange
