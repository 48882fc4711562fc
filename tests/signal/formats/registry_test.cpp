// Files of instruments and simulators. All samples hold one low-pass of 1 kHz (tests/signal/formats/README.md).
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <set>

#include "base/error.hpp"
#include "base/files.hpp"
#include "kept_text.hpp"
#include "signal/bode_points.hpp"
#include "signal/csv.hpp"
#include "signal/time_record.hpp"
#include "temporary_folder.hpp"

namespace bodesmith {
namespace {
namespace fs = std::filesystem;
using testing::HasSubstr;
using Complex = std::complex<double>;

fs::path sample(const std::string& name) {
  return fs::path(BODESMITH_SOURCE_DIR) / "tests/signal/formats" / name;
}

Complex low_pass(Hertz f) {
  return 1.0 / Complex(1.0, f.value / 1000.0);
}

struct ResponseSample {
  std::string name;  ///< with a choice
  double scale;      ///< of the low-pass
  double tolerance;  ///< of |got/wanted - 1|, after the printed digits
  std::string said;
};

class ForeignResponse : public testing::TestWithParam<ResponseSample> {};

TEST_P(ForeignResponse, IsTheLowPass) {
  const ResponseSample& given = GetParam();
  Provenance from;
  const FrequencyRecord record = FrequencyRecord::read_csv(sample(given.name), from);
  ASSERT_EQ(record.frequency.size(), 17u);
  EXPECT_NEAR(record.frequency.front().value, 10.0, 1e-6);
  EXPECT_NEAR(record.frequency.back().value, 1e5, 1e-2);
  for (std::size_t i = 0; i < 17; ++i) {
    const Complex wanted = given.scale * low_pass(record.frequency[i]);
    EXPECT_LT(std::abs(record.response[i] / wanted - 1.0), given.tolerance)
        << record.frequency[i].value << " Hz";
  }
  EXPECT_THAT(from.inputs.at(0).read_as, HasSubstr(given.said));
  EXPECT_EQ(from.inputs.at(0).path, sample(given.name.substr(0, given.name.find(':'))).string());
}

INSTANTIATE_TEST_SUITE_P(
    Formats, ForeignResponse,
    testing::Values(
        ResponseSample{"waveforms_network.csv", 1.0, 1e-8,
                       "Digilent WaveForms CSV: channel 2 relative to channel 1"},
        ResponseSample{"waveforms_network_khz.csv", 1.0, 1e-8, "channel 2 less channel 1 in dB"},
        // Latin-1, but what is said of it goes into JSON.
        ResponseSample{"bode100.csv", 1.0, 1e-8, "Phase (\u00b0)"},
        ResponseSample{"bode100_settings.csv", 1.0, 1e-8, "Bode 100 CSV"},
        ResponseSample{"rew.txt", 1e4, 1e-4, "REW text"},
        ResponseSample{"speaker.frd", 1.0, 1e-4, "plain table without headings"},
        ResponseSample{"impedance.zma", 8.0, 1e-4, "0 dB is 1 ohm"},
        ResponseSample{"ma.s2p", 1.0, 1e-8, "S21 of 2 ports; magnitude and angle; frequency from MHz; noise"},
        ResponseSample{"ri.s2p", 1.0, 1e-8, "Touchstone 1: S21"},
        ResponseSample{"ri.s2p:s11", 0.5, 1e-8, "Touchstone 1: S11"},
        ResponseSample{"db.s1p", 1.0, 1e-8, "S11 of 1 port; dB and angle"},
        ResponseSample{"z.s1p", 1.0, 1e-8, "normalised to 50 ohm, undone"},
        ResponseSample{"version2.s2p", 1.0, 1e-8, "Touchstone 2: S21"},
        ResponseSample{"version2.s2p:S1,1", 0.5, 1e-8, "Touchstone 2: S11"},
        ResponseSample{"four.s4p", 1.0, 1e-8, "S21 of 4 ports"},
        ResponseSample{"ltspice_polar.txt", 1.0, 1e-12, "LTspice text: V(out)"},
        ResponseSample{"ltspice_steps.txt", 2.0, 1e-12, "run 1 of 2"},
        ResponseSample{"ltspice_steps.txt:v(out)/v(in)@2", 1.0, 1e-12, "V(out)/V(in); run 2 of 2"},
        ResponseSample{"ltspice_ac.raw", 1.0, 1e-12, "LTspice raw file: V(out)"},
        ResponseSample{"ngspice_ac_binary.raw", 1.0, 1e-9, "SPICE raw file: v(out)"},
        ResponseSample{"ngspice_ac_binary.raw:v(out)/v(in)", 1.0, 1e-9, "v(out)/v(in)"},
        ResponseSample{"ngspice_ac_ascii.raw:out", 1.0, 1e-9, "SPICE raw file: v(out)"},
        ResponseSample{"response.mat", 1.0, 1e-12, "MATLAB 5 file: frequency f; response H"},
        ResponseSample{"bode.mat", 1.0, 1e-12, "frequency from rad/s"},
        ResponseSample{"plain_comma.csv", 1.0, 1e-6, "decimal commas"},
        ResponseSample{"bare.zma", 8.0, 1e-4, "a .zma file: ohms"},
        ResponseSample{"hfss.csv", 1.0, 1e-8, "frequency from kHz"},
        ResponseSample{"hfss.csv:dB(S(2,1))", 1.0, 1e-8, "'dB(S(2,1)) []' and 'cang_deg(S(2,1)) [deg]'"},
        ResponseSample{"keysight_fra.csv", 1.0, 1e-8, "'Gain (dB)' and 'Phase (°)'"},
        ResponseSample{"fra4picoscope.csv", 1.0, 1e-8, "from its logarithm to base 10"},
        ResponseSample{"moku.csv", 1.0, 1e-8, "'Math (Ch B / Ch A) Magnitude (dB)'"},
        ResponseSample{"moku.csv:Channel B Magnitude/Channel A Magnitude", 1.0, 1e-8,
                       "over 'Channel A Magnitude"},
        ResponseSample{"bare_reference.s2p", 1.0, 1e-8,
                       "S21 of 2 ports; real and imaginary part; frequency from kHz"},
        ResponseSample{"eis.txt", 1.0, 1e-8, "'Zre' and 'Zim'"},
        ResponseSample{"biologic.txt", 1.0, 1e-8, "'-Im(Z)/Ohm'"},
        ResponseSample{"pna.csv", 1.0, 1e-8, "'S21(REAL)' and 'S21(IMAG)'"},
        ResponseSample{"pna.csv:s21", 1.0, 1e-8, "'S21(REAL)'"},
        ResponseSample{"empty_cells.csv", 1.0, 1e-8, "1 rows with empty cells left out"},
        ResponseSample{"dbv_ohm.txt", 1.0, 1e-8, "taken as dB, some being 0 or less"},
        ResponseSample{"network.cti", 1.0, 1e-8, "CITI file: S21"},
        ResponseSample{"network.cti:S[1,1]", 0.5, 1e-8, "CITI file: S11"},
        ResponseSample{"utf16.csv", 1.0, 1e-8, "table with headings"},
        ResponseSample{"other_names.mat:ff,resp", 1.0, 1e-12, "frequency ff; response resp"}));

TEST(ForeignPoints, ATableWithoutHeadingsIsGainsWhereTheyCanBeNothingElse) {
  Provenance from;
  const BodePoints points = BodePoints::read_csv(sample("plain.txt"), from);
  ASSERT_EQ(points.points.size(), 17u);
  EXPECT_NEAR(points.points[8].gain, std::abs(low_pass(Hertz{1000.0})), 1e-9);
  EXPECT_EQ(points.points[8].line, 9);
  EXPECT_THAT(from.inputs[0].read_as, HasSubstr("linear gains"));
}

struct RecordSample {
  std::string name;
  std::size_t samples;
  double start_s;
  double step_s;
  double tolerance;
};
class ForeignRecord : public testing::TestWithParam<RecordSample> {};

TEST_P(ForeignRecord, IsASineAndItsAnswer) {
  const RecordSample& given = GetParam();
  Provenance from;
  if (given.name == "samples.csv") from.sample_hz = 1e4;
  const TimeRecord record = TimeRecord::read_csv(sample(given.name), from);
  ASSERT_EQ(record.size(), given.samples);
  EXPECT_NEAR(record.start_s, given.start_s, 1e-12);
  EXPECT_NEAR(record.step_s, given.step_s, 1e-9);
  const Complex g = low_pass(Hertz{100.0});
  for (std::size_t i = 0; i < record.size(); ++i) {
    // The files whose times begin at 0 hold the same samples, from -2 ms on.
    const double turn = 2.0 * std::numbers::pi * 100.0 * (-2e-3 + record.step_s * static_cast<double>(i));
    EXPECT_NEAR(record.u[i], std::sin(turn), given.tolerance);
    if (!record.y.empty()) {
      EXPECT_NEAR(record.y[i], std::abs(g) * std::sin(turn + std::arg(g)), given.tolerance);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, ForeignRecord,
                         testing::Values(RecordSample{"waveforms_scope.csv", 80, -2e-3, 1e-4, 1e-9},
                                         RecordSample{"picoscope.csv", 80, -2e-3, 1e-4, 1e-9},
                                         RecordSample{"stereo16.wav", 80, 0.0, 1e-4, 5e-5},
                                         RecordSample{"mono_float.wav", 80, 0.0, 1e-4, 1e-7},
                                         RecordSample{"record.mat", 80, 0.0, 1e-4, 1e-15},
                                         RecordSample{"compressed.mat", 80, 0.0, 1e-4, 1e-15},
                                         RecordSample{"other_names.mat:clock,drive,answer", 80, 0.0, 1e-4,
                                                      1e-15},
                                         RecordSample{"rigol.csv", 80, -2e-3, 1e-4, 1e-9},
                                         RecordSample{"tektronix_tds.csv", 80, -2e-3, 1e-4, 1e-6},
                                         RecordSample{"instek_detail.csv", 80, -2e-3, 1e-4, 1e-9},
                                         // Half a code of 8 mV.
                                         RecordSample{"instek_codes.csv", 80, 0.0, 1e-4, 4.001e-3},
                                         RecordSample{"keysight_scope.csv:1,2", 80, -2e-3, 1e-4, 1e-9},
                                         RecordSample{"samples.csv", 80, 0.0, 1e-4, 1e-9}));

/// Every sample as points, response, record and record at a given rate, with a few choices: what is said of it or why it is refused.
TEST(ForeignFiles, AreReadOrRefusedAsWasKept) {
  const fs::path folder = sample("");
  std::set<std::string> names;
  for (const auto& one : fs::directory_iterator(folder)) {
    const std::string extension = one.path().extension().string();
    if (extension != ".py" && extension != ".md" && extension != ".cpp" &&
        !one.path().filename().string().starts_with("kept"))
      names.insert(one.path().filename().string());
  }
  std::string all;
  for (const std::string& name : names) {
    for (const char* choice : {"", ":deg", ":nothing", ":1,2"}) {
      const auto add = [&](const std::string& as, double rate, const auto& read) {
        if (*choice != '\0' && (as == "points" || rate > 0.0)) return;
        Provenance from;
        if (rate > 0.0) from.sample_hz = rate;
        std::string line;
        try {
          const double figure = read(sample(name + choice), from);
          line = fmt::format("{:.5g}; {}", figure, from.inputs.at(0).read_as);
        } catch (const InputError& error) {
          line = error.what();
          for (std::size_t at = line.find(folder.string()); at != std::string::npos;
               at = line.find(folder.string()))
            line.erase(at, folder.string().size());
        }
        all += name + choice + " as " + as + ": " + line + "\n";
      };
      add("points", 0.0, [](const fs::path& path, Provenance& from) {
        double sum = 0.0;
        for (const BodePoint& one : BodePoints::read_csv(path, from).points)
          sum += one.gain + one.phase_deg.value_or(0.0) + 1e-3 * one.frequency.value + one.line;
        return sum;
      });
      add("response", 0.0, [](const fs::path& path, Provenance& from) {
        const FrequencyRecord record = FrequencyRecord::read_csv(path, from);
        double sum = 0.0;
        for (std::size_t i = 0; i < record.response.size(); ++i)
          sum += record.response[i].real() + 2.0 * record.response[i].imag() +
                 1e-3 * record.frequency[i].value + (record.coherence.empty() ? 0.0 : record.coherence[i]);
        return sum;
      });
      for (const double rate : {0.0, 1e4}) {
        add(rate > 0.0 ? "sampled record" : "record", rate, [](const fs::path& path, Provenance& from) {
          const TimeRecord record = TimeRecord::read_csv(path, from);
          double sum = record.start_s + 1e3 * record.step_s + static_cast<double>(record.size());
          for (std::size_t i = 0; i < record.u.size(); ++i)
            sum += static_cast<double>(i) * (record.u[i] + (record.y.empty() ? 0.0 : 2.0 * record.y[i]));
          return sum;
        });
      }
    }
  }
  expect_kept("signal/formats/kept_readings.txt", all);
}

// The same line in every unit that the option line can name; GHz where it names none.
TEST(Touchstone, FrequenciesAreInTheUnitOfTheOptionLine) {
  const TemporaryFolder folder;
  for (const auto& [option, hz] : {std::pair{"# Hz S RI R 50", 1.0},
                                   {"# kHz S RI R 50", 1e3},
                                   {"# MHz S RI R 50", 1e6},
                                   {"# GHz S RI R 50", 1e9},
                                   {"# S RI R 50", 1e9}}) {
    write_file(folder / "one.s1p", std::string(option) + "\n1 0.5 0\n2 0.25 0\n3 0.125 0\n");
    Provenance from;
    const FrequencyRecord record = FrequencyRecord::read_csv((folder / "one.s1p").string() + ":s11", from);
    ASSERT_EQ(record.frequency.size(), 3u) << option;
    EXPECT_NEAR(record.frequency[1].value / (2.0 * hz), 1.0, 1e-12) << option;
    EXPECT_NEAR(std::abs(record.response[1] - 0.25), 0.0, 1e-12) << option;
  }
}

// No logarithm has a place for 0 Hz or for a magnitude of 0; a sweep may fall.
TEST(ForeignTables, PointsAtZeroAreLeftOutAndSaid) {
  const TemporaryFolder folder;
  const std::vector<std::string> rows = {"0,1,0", "1,3,4", "2,0,0", "3,0,-2", "4,0,0", "5,1,0"};
  for (const bool falls : {false, true}) {
    std::string text = "freq [kHz],Real,Imag\n";
    for (std::size_t i = 0; i < rows.size(); ++i) text += rows[falls ? rows.size() - 1 - i : i] + "\n";
    write_file(folder / "table.csv", text);
    Provenance from;
    const FrequencyRecord record = FrequencyRecord::read_csv(folder / "table.csv", from);
    ASSERT_EQ(record.frequency.size(), 3u);
    const std::vector<Complex> wanted = {{3.0, 4.0}, {0.0, -2.0}, {1.0, 0.0}};
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_NEAR(record.frequency[i].value, 1000.0 + 2000.0 * static_cast<double>(i), 1e-9);
      EXPECT_LT(std::abs(record.response[i] - wanted[i]), 1e-9);
    }
    EXPECT_THAT(from.inputs[0].read_as, HasSubstr("the point at 0 Hz left out"));
    EXPECT_THAT(from.inputs[0].read_as, HasSubstr("2 points of magnitude 0 left out"));
    EXPECT_EQ(from.inputs[0].read_as.find("falling sweep turned round") != std::string::npos, falls);
  }
  write_file(folder / "table.csv", "freq [kHz],Real,Imag\n0,1,0\n1,0,0\n");
  Provenance from;
  EXPECT_THROW(FrequencyRecord::read_csv(folder / "table.csv", from), InputError);
}

TEST(ForeignRecords, UnevenStepsOfSimulatorsBecomeEvenAndTheDepartureIsSaid) {
  for (const char* name : {"ltspice_tran.raw", "ltspice_tran_fast.raw:v(in),v(out)"}) {
    Provenance from;
    const TimeRecord record = TimeRecord::read_csv(sample(name), from);
    EXPECT_NEAR(record.duration_s(), 2e-3, 1e-12);
    ASSERT_EQ(record.y.size(), record.u.size());
    EXPECT_NEAR(record.y.back(), 1.0 - std::exp(-4.0 * std::numbers::pi), 1e-6);
    EXPECT_THAT(from.inputs[0].read_as, HasSubstr("12 uneven steps made"));
  }
  Provenance from;
  const TimeRecord record = TimeRecord::read_csv(sample("ngspice_tran_binary.raw"), from);
  // After five time constants: the settled answer.
  const Complex g = low_pass(Hertz{100.0});
  for (std::size_t i = record.size() / 2; i < record.size(); ++i) {
    const double turn = 2.0 * std::numbers::pi * 100.0 * record.time_s(i);
    EXPECT_NEAR(record.u[i], std::sin(turn), 3e-3);
    EXPECT_NEAR(record.y[i], std::abs(g) * std::sin(turn + std::arg(g)), 3e-3);
  }
}

// A nanosecond beside a second: no more than a thousand samples a point.
TEST(ForeignRecords, WildStepsOfSimulatorsStayOfASize) {
  const TemporaryFolder folder;
  write_file(folder / "wild.txt",
             "time\tV(in)\tV(out)\n0\t0\t0\n1e-9\t1\t0\n2e-9\t0\t1\n1e-3\t1\t1\n1\t0\t0\n");
  Provenance from;
  const TimeRecord record = TimeRecord::read_csv(folder / "wild.txt", from);
  EXPECT_GT(record.size(), 1000u);
  EXPECT_LE(record.size(), 2u * 1024u * 5u);
  EXPECT_NEAR(record.duration_s(), 1.0, 1e-3);
}

// Straight lines lose nothing however few the samples; a bend between them takes as many as keep a thousandth of the range.
TEST(ForeignRecords, StraightLinesAtUnevenTimesStayStraightAndFew) {
  const TemporaryFolder folder;
  const auto read = [&](double bend) {
    std::string text = "time\tV(in)\tV(out)\n";
    for (const double t : {0.0, 0.07, 0.1, 0.33, 0.4001, 0.81, 1.0})
      text += std::to_string(t) + "\t" + std::to_string(3.0 * t - 1.0) + "\t" +
              std::to_string(5.0 - 2.0 * t + (t > 0.33 ? bend * (t - 0.33) : 0.0)) + "\n";
    write_file(folder / "lines.txt", text);
    Provenance from;
    return TimeRecord::read_csv(folder / "lines.txt", from);
  };
  const TimeRecord straight = read(0.0);
  EXPECT_EQ(straight.size(), 64U);
  for (std::size_t i = 0; i < straight.size(); ++i) {
    EXPECT_NEAR(straight.u[i], 3.0 * straight.time_s(i) - 1.0, 1e-5);
    EXPECT_NEAR(straight.y[i], 5.0 - 2.0 * straight.time_s(i), 1e-5);
  }
  const TimeRecord bent = read(6.0);
  EXPECT_GT(bent.size(), 64U);
  const double place = 0.33 * static_cast<double>(bent.size() - 1);
  const auto k = static_cast<std::size_t>(place);
  const double there = bent.y[k] + (place - static_cast<double>(k)) * (bent.y[k + 1] - bent.y[k]);
  EXPECT_NEAR(there, 5.0 - 2.0 * 0.33, 1e-3 * 3.1);
}

// Samples that a file does not hold have no line in it, whether they are more than its own or (64) as many.
TEST(ForeignRecords, OnlySamplesOfTheFileHaveALine) {
  const TemporaryFolder folder;
  const auto lines = [&](int count, double bend) {
    std::string text = "time\tV(in)\tV(out)\n";
    for (int i = 0; i < count; ++i) text += fmt::format("{}\t{}\t0\n", i + (i == 7 ? bend : 0.0), i % 3);
    write_file(folder / "lines.txt", text);
    Provenance from;
    const Csv read = Csv::read(folder / "lines.txt", from, formats::Content::record);
    return std::pair{read.line(0), read.line(read.rows() - 1)};
  };
  EXPECT_EQ(lines(64, 0.0), (std::pair{2, 65}));
  EXPECT_EQ(lines(64, 0.4), (std::pair{0, 0}));
  EXPECT_EQ(lines(20, 0.4), (std::pair{0, 0}));
}

TEST(ForeignRecords, AnotherColumnOrNodeIsChosenByName) {
  Provenance from;
  const TimeRecord swapped = TimeRecord::read_csv(sample("waveforms_scope.csv:Channel 2,Channel 1"), from);
  const TimeRecord usual = TimeRecord::read_csv(sample("waveforms_scope.csv"), from);
  EXPECT_EQ(swapped.u, usual.y);
  EXPECT_EQ(swapped.y, usual.u);
  EXPECT_EQ(TimeRecord::read_csv_column(sample("stereo16.wav:2"), from, "r").u,
            TimeRecord::read_csv(sample("stereo16.wav"), from).y);
}

std::string refusal(const std::string& name, bool record = false) {
  Provenance from;
  try {
    if (record) {
      TimeRecord::read_csv(name, from);
    } else {
      FrequencyRecord::read_csv(name, from);
    }
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(ForeignFiles, RefusalsNameWhatIsThere) {
  const auto at = [](const std::string& name) { return sample(name).string(); };
  EXPECT_THAT(refusal(at("ma.s2p:s33")), HasSubstr("has no 's33', it holds S11 to S22"));
  EXPECT_THAT(refusal(at("ltspice_ac.raw:v(x)")), HasSubstr("has no single 'v(x)', found: V(in), V(out)"));
  EXPECT_THAT(refusal(at("ltspice_steps.txt:v(out)@3")), HasSubstr("holds 2 runs, there is no run 3"));
  EXPECT_THAT(refusal(at("stereo16.wav")), HasSubstr("is a time record (WAV"));
  EXPECT_THAT(refusal(at("ri.s2p"), true), HasSubstr("is a frequency response (Touchstone 1"));
}

std::string read_as(const std::string& text) {
  const TemporaryFolder folder;
  write_file(folder / "x", text);
  Provenance from;
  const FrequencyRecord record = FrequencyRecord::read_csv(folder / "x", from);
  return std::to_string(record.frequency.at(0).value) + " Hz " +
         std::to_string(std::abs(record.response.at(0)));
}

TEST(ForeignTables, HeadingsSayTheUnits) {
  EXPECT_EQ(read_as("f/kHz;Gain/dB;Phase/deg\n1,5;20;0\n2;20;0\n"), "1500.000000 Hz 10.000000");
  EXPECT_EQ(read_as("Frequency MHz\tMagnitude (mV)\tPhase (rad)\n1\t500\t0\n2\t1\t0\n"),
            "1000000.000000 Hz 0.500000");
  EXPECT_EQ(read_as("freq (mHz),mag (dB),phase\n1,0,0\n2,0,0\n"), "0.001000 Hz 1.000000");
  EXPECT_EQ(read_as("freq [ghz],Real,Imag\n1,3,4\n2,0,1\n"), "1000000000.000000 Hz 5.000000");
  EXPECT_EQ(read_as("% from monday\n% freq (Hz)   abs(H)  arg(H)\n1 0.5 0\n2 0.4 40\n"),
            "1.000000 Hz 0.500000");
  EXPECT_EQ(read_as(";Frequency\tMagnitude\tPhase\n20.5\t-20\t45\n30.5\t-2\t40\n"), "20.500000 Hz 0.100000");
  EXPECT_EQ(read_as("# kHz dB deg\n2 -20 0\n4 -4 1\n"), "2000.000000 Hz 0.100000");
  EXPECT_EQ(read_as("# three words here\n1 -20 0\n2 -4 40\n"), "1.000000 Hz 0.100000");
  EXPECT_EQ(read_as("Frequency,Impedance,Phase\nHz,kOhm,deg\n10,2,0\n20,1,0\n"), "10.000000 Hz 2000.000000");
}

struct ReadCoherence {
  std::vector<double> values;
  std::string said;
};
ReadCoherence coherence_in(const std::string& text) {
  const TemporaryFolder folder;
  write_file(folder / "x", text);
  Provenance from;
  const FrequencyRecord record = FrequencyRecord::read_csv(folder / "x", from);
  EXPECT_EQ(record.frequency.size(), record.response.size());
  return {record.coherence, from.inputs.at(0).read_as};
}

TEST(ForeignTables, ACoherenceGoesWithItsRows) {
  const auto shares =
      coherence_in("Frequency (Hz),Gain (dB),Phase (deg),Coherence\n30,1,0,0.9\n20,1,0,0.75\n0,1,0,0.1\n");
  EXPECT_EQ(shares.values, (std::vector<double>{0.75, 0.9}));
  EXPECT_THAT(shares.said, HasSubstr("'Coherence' as gamma squared"));
  const auto percent =
      coherence_in("* Freq(Hz) SPL(dB) Phase(degrees) Coherence(%)\n20 1 0 50\n30 2 0 100\n40 2 0 0\n");
  EXPECT_EQ(percent.values, (std::vector<double>{0.5, 1.0, 0.0}));
  EXPECT_THAT(percent.said, HasSubstr("from percent"));
  const auto parts = coherence_in("Frequency (Hz),Real,Imag,Coherence\n20,1,0,0.5\n30,2,0,1\n");
  EXPECT_EQ(parts.values, (std::vector<double>{0.5, 1.0}));
  const auto other = coherence_in("Frequency (Hz),Gain (dB),Phase (deg),Coherence\n20,1,0,-3\n30,1,0,0.9\n");
  EXPECT_TRUE(other.values.empty());
  EXPECT_THAT(other.said, HasSubstr("not used"));
}

std::string refusal_of(const std::string& text, bool record = false) {
  const TemporaryFolder folder;
  write_file(folder / "x", text);
  std::string what = refusal((folder / "x").string(), record);
  const std::string path = (folder / "x").string();
  return what.rfind(path, 0) == 0 ? what.substr(path.size()) : what;
}

TEST(ForeignFiles, BrokenOnesAreRefusedByLineOrByte) {
  EXPECT_THAT(refusal_of("# GHZ S MA R 50\n1 0.5 0\n2 x 0\n"), HasSubstr(":3: 'x' is not a finite number"));
  EXPECT_THAT(refusal_of("# GHZ S MA R 50\n1 0.5 0\n1 0.5 0\n"),
              HasSubstr(":3: has a frequency that does not rise"));
  EXPECT_THAT(refusal_of("# GHZ S MA\n1 1 0 1 0 1 0 1 0\n2 1 0 1 0 1 0\n"),
              HasSubstr(":3: begins a point of 6 numbers"));
  EXPECT_THAT(refusal_of("[Version] 3.0\n"), HasSubstr(":1: is Touchstone version '3.0'"));
  EXPECT_THAT(refusal_of("* Freq(Hz) SPL(dB) Phase(degrees)\n20 1 0\n30 2\n"),
              HasSubstr(":3: has 2 cells, expected 3"));
  EXPECT_THAT(refusal_of("Frequency (Hz),Gain (dB),Phase (deg)\n20,1,0\n30,nan,0\n"),
              HasSubstr(":3: 'nan' is not a finite"));
  EXPECT_THAT(refusal_of("Freq.\tV(out)\n1\t(0dB,0°)\n2\t(0dB 0°)\n"),
              HasSubstr(":3: '(0dB 0°)' is neither"));
  EXPECT_THAT(refusal_of("Frequency (rpm),Gain (dB)\n20,1\n"),
              HasSubstr("'Frequency (rpm)' has a unit that is not known"));
  EXPECT_THAT(refusal_of("20 5\n30 50\n"), HasSubstr("has magnitudes from 5 to 50 without a unit"));
  EXPECT_THAT(refusal_of("1 2 3 4\n2 3 4 5\n"), HasSubstr(":1: has 4 columns and no headings"));
  const std::string wav = read_file(sample("mono_float.wav"));
  EXPECT_THAT(refusal_of(wav.substr(0, 100), true), HasSubstr(": byte 100: the file ends within a chunk"));
  const std::string raw = read_file(sample("ngspice_ac_binary.raw"));
  EXPECT_THAT(refusal_of(raw.substr(0, raw.size() - 1)),
              HasSubstr("byte " + std::to_string(raw.size() - 1) + ": the file ends within point 17 of 17"));
  std::string counted = read_file(sample("ngspice_ac_ascii.raw"));
  for (const char* count : {"x", "99999999999999999999", "9999999999999"}) {
    const std::size_t at = counted.find("Points: ") + 8;
    counted.replace(at, counted.find('\n', at) - at, count);
    EXPECT_THAT(refusal_of(counted), HasSubstr("'" + std::string(count) + "' is not a count"));
  }
  const std::string mat = read_file(sample("response.mat"));
  EXPECT_THAT(refusal_of(mat.substr(0, mat.size() - 1)), HasSubstr("the file ends within a variable of"));
}

/// What stands right above the numbers is understood, or the file is refused: never are its numbers guessed.
TEST(ForeignFiles, AHeadingThatIsNotUnderstoodIsNeverDropped) {
  EXPECT_THAT(refusal_of("my amplifier\n1 0.5 0\n2 0.4 0\n"),
              HasSubstr(":1: 'my amplifier' right above the numbers is not understood"));
  EXPECT_THAT(refusal_of("# freq(kHz) gain\n1 0.5 0\n2 0.4 0\n"), HasSubstr(":1: '# freq(kHz) gain'"));
  EXPECT_THAT(refusal_of("* a,b,c\n* ------\nalpha,beta\n1,0.5,0\n"), HasSubstr(":3: 'alpha,beta'"));
  EXPECT_THAT(refusal_of("# GHz S RI R fifty\n1 0.5 0\n"), HasSubstr(":1: '# GHz S RI R fifty'"));
  EXPECT_THAT(refusal_of("# GHz Z RI R\n1 0.5 0\n"), HasSubstr("is not a Touchstone option line"));
  EXPECT_THAT(refusal_of("Frequency (Hz),Gain (bel),Phase (deg)\n1,0.5,0\n"),
              HasSubstr("'Gain (bel)' has a unit that is not known"));
  EXPECT_THAT(refusal_of("Frequency (Hz),Gain (dB),Phase (turns)\n1,0.5,0\n"),
              HasSubstr("'Phase (turns)' has a unit that is not known"));
  EXPECT_THAT(refusal_of("Frequency (Hz),A (dB),B (dB)\n1,0.5,0\n"),
              HasSubstr("holds A (dB), B (dB): choose one"));
  EXPECT_THAT(refusal_of("#Digilent WaveForms Spectrum Analyzer\nFrequency (Hz),Trace 1 (dB)\n1,-3\n2,-4\n"),
              HasSubstr(":3: begins a spectrum"));
  EXPECT_THAT(refusal_of("Frequency (Hz),C1 (dBV)\n1,-3\n2,-4\n"), HasSubstr("and no phase: a spectrum"));
  EXPECT_THAT(refusal_of("BEGIN\n1e9,-3\n2e9,-4\nEND\n"), HasSubstr(":2: begins a block without headings"));
  EXPECT_THAT(refusal_of("1,0.5,0\n2,,0\n"), HasSubstr(":2: has an empty cell"));
  EXPECT_THAT(refusal_of("x-axis,1,2\nsecond,Volt,Volt\n0,1,2\n1,3,4\n2,x,1\n", true), HasSubstr(":5: 'x'"));
  EXPECT_THAT(refusal_of("u,y\n1,2\n3,4\n", true), HasSubstr("need their sampling rate"));
  EXPECT_THAT(refusal(sample("keysight_scope.csv:Volt,Volt").string(), true),
              HasSubstr("has no single 'Volt'"));
  EXPECT_THAT(refusal(sample("sparse.mat").string(), true), HasSubstr("'u' is sparse"));
  EXPECT_THAT(refusal(sample("complex_input.mat").string(), true), HasSubstr("'u' is complex"));
  EXPECT_THAT(refusal(sample("plain.txt:volts").string()), HasSubstr("has no choice 'volts'"));
  // A remark is none, and blank ones say nothing.
  EXPECT_EQ(refusal_of("# from monday, second try\n\n1,-0.5,0\n2,-0.4,0\n"), "accepted");
  // Half a character at the end is no digit less of the last number.
  const std::string wide = read_file(sample("utf16.csv"));
  EXPECT_THAT(refusal_of(wide.substr(0, wide.size() - 3)), HasSubstr(":18: '"));
}

TEST(ForeignFiles, ATableThatMayBeEitherIsLeftToTheUser) {
  const TemporaryFolder folder;
  write_file(folder / "even", "1,-0.5,0\n2,-0.4,0\n3,-0.3,0\n");
  Provenance from;
  EXPECT_THAT(refusal((folder / "even").string()), "accepted");
  try {
    Csv::read(folder / "even", from);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("may be times or frequencies"));
  }
  EXPECT_TRUE(Csv::read((folder / "even").string() + ":record", from).has("time_s"));
  EXPECT_TRUE(Csv::read((folder / "even").string() + ":response", from).has("frequency_hz"));
}

/// A wrong end or a changed byte anywhere: read or refused, never worse.
TEST(ForeignFiles, EveryTruncationIsReadOrRefused) {
  const TemporaryFolder folder;
  int refused = 0;
  for (const char* name : {"ma.s2p", "bode100.csv", "ltspice_tran.raw", "stereo16.wav", "record.mat",
                           "rew.txt", "network.cti", "rigol.csv", "pna.csv", "instek_codes.csv"}) {
    const std::string whole = read_file(sample(name));
    for (std::size_t size = 0; size < whole.size(); size += 7) {
      write_file(folder / "x", whole.substr(0, size));
      for (const bool record : {false, true}) {
        const std::string what = refusal((folder / "x").string(), record);
        if (what == "accepted") continue;
        ++refused;
        EXPECT_EQ(what.rfind((folder / "x").string(), 0), 0u) << what;
      }
    }
  }
  EXPECT_GT(refused, 500);
}

}  // namespace
}  // namespace bodesmith
