// Layouts of instruments and programs as their headings: the same numbers below each, which the reader finds again or
// refuses. Responses hold a low-pass of 1 kHz and gain 2.5, records a sine and another one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdio>
#include <functional>
#include <numbers>

#include "base/error.hpp"
#include "base/files.hpp"
#include "base/units.hpp"
#include "signal/bode_points.hpp"
#include "signal/csv.hpp"
#include "signal/time_record.hpp"
#include "temporary_folder.hpp"

namespace bodesmith {
namespace {
using testing::HasSubstr;
using Complex = std::complex<double>;
using Cells = std::vector<double>;

constexpr int kRows = 9;

Complex low_pass(double f) {
  return 2.5 / Complex(1.0, f / 1000.0);
}
double level(double f) {
  return to_decibel(std::abs(low_pass(f)));
}
double angle(double f) {
  return to_degrees(std::arg(low_pass(f)));
}
double frequency(int row) {
  return 10.0 * std::pow(10.0, 0.5 * row);
}

struct Sheet {
  char separator = ',';
  bool decimal_comma = false;
  const char* row_end = "\n";
};

std::string table(const std::string& above, const std::function<Cells(int)>& row, const Sheet& sheet = {}) {
  std::string out = above;
  for (int i = 0; i < kRows; ++i) {
    std::string line;
    for (const double cell : row(i)) {
      if (!line.empty()) line += sheet.separator;
      char text[40];
      std::snprintf(text, sizeof text, "%.12g", cell);
      line += text;
    }
    if (sheet.decimal_comma) std::replace(line.begin(), line.end(), '.', ',');
    out += line + sheet.row_end;
  }
  return out;
}

/// What is said of the file, or of its refusal.
std::string with_file(const std::string& text, const std::string& name,
                      const std::function<void(const std::string&, Provenance&)>& read) {
  const TemporaryFolder folder;
  const std::string file = name.substr(0, name.find(':'));
  write_file(folder / file, text);
  Provenance from;
  try {
    read((folder / name).string(), from);
  } catch (const InputError& error) {
    return error.what();
  }
  return from.inputs.at(0).read_as;
}

std::string refusal_of_response(const std::string& text, const std::string& name = "x") {
  return with_file(text, name,
                   [](const std::string& path, Provenance& from) { FrequencyRecord::read_csv(path, from); });
}

void expect_low_pass(const std::string& text, const std::string& name = "x") {
  const std::string said = with_file(text, name, [&](const std::string& path, Provenance& from) {
    const FrequencyRecord record = FrequencyRecord::read_csv(path, from);
    ASSERT_EQ(record.frequency.size(), static_cast<std::size_t>(kRows)) << text;
    for (int i = 0; i < kRows; ++i) {
      const auto at = static_cast<std::size_t>(i);
      EXPECT_NEAR(record.frequency[at].value / frequency(i), 1.0, 1e-9) << text;
      EXPECT_LT(std::abs(record.response[at] / low_pass(frequency(i)) - 1.0), 1e-8) << text;
    }
  });
  EXPECT_THAT(said, testing::Not(HasSubstr("/x"))) << text;  // no refusal, which names the file
}

double input(int row) {
  return 1.5 * std::sin(0.7 * row + 0.2);
}
double output(int row) {
  return 0.6 * std::cos(0.7 * row);
}

void expect_record(const std::string& text, bool with_output = true, const std::string& name = "x") {
  const std::string said = with_file(text, name, [&](const std::string& path, Provenance& from) {
    const TimeRecord record = TimeRecord::read_csv(path, from);
    ASSERT_EQ(record.size(), static_cast<std::size_t>(kRows)) << text;
    EXPECT_NEAR(record.step_s, 1e-4, 1e-12) << text;
    ASSERT_EQ(!record.y.empty(), with_output) << text;
    for (int i = 0; i < kRows; ++i) {
      const auto at = static_cast<std::size_t>(i);
      EXPECT_NEAR(record.u[at], input(i), 1e-9) << text;
      if (!with_output) continue;
      EXPECT_NEAR(record.y[at], output(i), 1e-9) << text;
    }
  });
  EXPECT_THAT(said, testing::Not(HasSubstr("/x"))) << text;  // no refusal, which names the file
}

Cells level_and_angle(int i) {
  const double f = frequency(i);
  return {f, level(f), angle(f)};
}
Cells size_and_angle(int i) {
  const double f = frequency(i);
  return {f, std::abs(low_pass(f)), angle(f)};
}
Cells parts(int i) {
  const double f = frequency(i);
  return {f, low_pass(f).real(), low_pass(f).imag()};
}

TEST(Layouts, LevelsAndPhasesByTheirHeadings) {
  for (const char* heading :
       {"Frequency (Hz),VDB(out),VP(out)\n", "F,dB(V(OUT)),PH(V(OUT))\n", "Frequency,db(:vout),ph(:vout)\n",
        "f(Hz),A(dB),phi(°)\n", "Frecuencia (Hz),Ganancia (dB),Fase (°)\n", "频率(Hz),增益(dB),相位(°)\n",
        "Frequency in Hz,Gain in dB,Phase in °\n", "freq[Hz],db:Trc1_S21,ang:Trc1_S21\n",
        "Frequency / Hz,Magnitude / dB,Phase / deg\n", "FREQ.HZ,S21.LOGMAG,S21.PHASE\n"})
    expect_low_pass(table(heading, level_and_angle));
  // Old Macintoshes end lines with a carriage return alone.
  expect_low_pass(table("Frequency (Hz);Gain (dB);Phase (°)\r", level_and_angle, {';', true, "\r"}));
  expect_low_pass(table("Freq Gain Phase\n(Hz) (dB) (deg)\n", level_and_angle, {' '}));
  // A separator at the end of each line, counts of rows under no name.
  expect_low_pass(table("freq[Hz];db:Trc1_S21;ang:Trc1_S21;\n", level_and_angle, {';', false, ";\n"}));
  expect_low_pass(table(",frequency_hz,magnitude_db,phase_deg\n", [](int i) {
    Cells out = level_and_angle(i);
    out.insert(out.begin(), i);
    return out;
  }));
  expect_low_pass(table("FREQ1.KHZ,LOGMAG1,PHASE1\n", [](int i) {
    Cells out = level_and_angle(i);
    out[0] /= 1e3;
    return out;
  }));
  expect_low_pass(table("w (krad/s),Magnitude (dB),Phase (deg)\n", [](int i) {
    Cells out = level_and_angle(i);
    out[0] *= 2e-3 * std::numbers::pi;
    return out;
  }));
  expect_low_pass(table("Frequency (radians/second),Gain (dB),Phase (deg)\n", [](int i) {
    Cells out = level_and_angle(i);
    out[0] *= 2.0 * std::numbers::pi;
    return out;
  }));
}

TEST(Layouts, SignsAreThoseOfTheHeadings) {
  const auto turned = [](int column, const auto& row) {
    return [column, row](int i) {
      Cells out = row(i);
      out[static_cast<std::size_t>(column)] *= -1.0;
      return out;
    };
  };
  for (const char* heading :
       {"Frequency (Hz),Gain (dB),-Phase (deg)\n", "Frequency (Hz),Gain (dB),Phase lag (deg)\n",
        "freq / Hz,Gain / dB,neg. Phase / °\n"})
    expect_low_pass(table(heading, turned(2, level_and_angle)));
  for (const char* heading : {"Frequency (Hz),Insertion Loss (dB),Phase (deg)\n",
                              "f (Hz),Attenuation (dB),Phase (deg)\n", "Frequenz/Hz,Dämpfung/dB,Phase/deg\n"})
    expect_low_pass(table(heading, turned(1, level_and_angle)));
  expect_low_pass(table("Frequency (Hz);Z (Ω);-Phase (°)\n", turned(2, size_and_angle), {';'}));
  expect_low_pass(table("f,Zreal,-Zimag\n", turned(2, parts)));
}

TEST(Layouts, PartsOfComplexNumbers) {
  for (const char* heading :
       {"freq[Hz],re:Trc1_S21,im:Trc1_S21\n", "Freq(Hz),Re S21,Im S21\n", "FREQ,VR(OUT),VI(OUT)\n",
        "Frequency(Hz), R(Ohm), X(Ohm)\n", "freq / Hz,Z' / Ohm,Z'' / Ohm\n"})
    expect_low_pass(table(heading, parts));
  expect_low_pass(table("f (kHz),Re Z (kOhm),Im Z (kOhm)\n", [](int i) {
    Cells out = parts(i);
    for (double& cell : out) cell /= 1e3;
    return out;
  }));
  // Gamry: a line of units with marks beside them, columns that are not used.
  expect_low_pass(table("ZCURVE\tTABLE\n\tPt\tTime\tFreq\tZreal\tZimag\tIERange\n\t#\ts\tHz\tohm\tohm\t#\n",
                        [](int i) {
                          const Cells z = parts(i);
                          return Cells{double(i), 1.0, z[0], z[1], z[2], 9.0};
                        },
                        {'\t'}));
  // ZPlot, Xyce.
  expect_low_pass(table("  Freq(Hz)   Z'(a)   Z''(b)\nEnd Comments\n", parts, {' '}));
  expect_low_pass(table("FREQ  Re(V(OUT))  Im(V(OUT))\n", parts, {' '}) + "End of Xyce(TM) Simulation\n");
}

TEST(Layouts, WhatMayBeRadiansIsAskedFor) {
  const auto radians = [](int i) {
    Cells out = level_and_angle(i);
    out[2] = to_radians(out[2]);
    return out;
  };
  EXPECT_THAT(refusal_of_response(table("", radians, {' '})), HasSubstr("it may be radians: say"));
  EXPECT_THAT(refusal_of_response(table("", parts, {' '})), HasSubstr("x:ri of real and imaginary part"));
  EXPECT_THAT(refusal_of_response(table("Frequency,Gain (dB),Phase\n", radians)), HasSubstr("x:deg or"));
  expect_low_pass(table("", radians, {' '}), "x:rad");
  expect_low_pass(table("", parts, {' '}), "x:ri");
  expect_low_pass(table("Frequency,Gain (dB),Phase\n", radians), "x:rad");
  const auto small = [](int i) { return Cells{frequency(i), -1.0 - i, 0.01 * i}; };
  EXPECT_THAT(refusal_of_response(table("", small), "x:deg"), HasSubstr("third column taken as the phase"));
}

TEST(Layouts, WhatIsNoGainIsRefused) {
  for (const char* heading : {"f (Hz),log|H|,phase (deg)\n", "f (Hz),Power gain (ratio),phase (deg)\n",
                              "f (Hz),|H|^2,phase (deg)\n", "f (Hz),PSD (dB/Hz),phase (deg)\n",
                              "f (Hz),Magnitude (V/√Hz),phase (deg)\n", "w (1/s),Gain (dB),phase (deg)\n"})
    EXPECT_THAT(refusal_of_response(table(heading, level_and_angle)),
                HasSubstr("has a unit that is not known"))
        << heading;
  EXPECT_THAT(refusal_of_response(table("f (Hz),Gain (dB),Phase margin (deg)\n", level_and_angle)),
              HasSubstr("phase_deg"));
  EXPECT_THAT(refusal_of_response(table("", level_and_angle, {' '}), "x.s1p"),
              HasSubstr("without the option line"));
}

TEST(Layouts, OneBlockAndNumbersThatAreOne) {
  const std::string block = table("f_hz,gain_db,phase_deg\n", level_and_angle);
  EXPECT_THAT(refusal_of_response(block + "\n\n# second\n2e5,-40,-80\n"),
              HasSubstr(":14: begins a second block"));
  expect_low_pass("# bodesmith, a comment\n\n# another\n" +
                  table("frequency_hz,magnitude_db,phase_deg\n", level_and_angle));
  EXPECT_THAT(refusal_of_response("f/Hz;Gain/dB;Phase/deg\n1,000;0;-45\n10,000;-3;-60\n"),
              HasSubstr("between thousands"));
  EXPECT_THAT(refusal_of_response("f/Hz;Gain/dB;Phase/deg\n1.000;0;-45\n10.000;-3;-60\n"),
              HasSubstr("between thousands"));
  EXPECT_EQ(refusal_of_response("f/Hz;Gain/dB;Phase/deg\n1,000;0,5;-45\n10,000;-3;-60\n").find("table"), 0u);
  EXPECT_THAT(refusal_of_response("f;gain dB;phase;f;gain dB;phase\n1;2;-30;5;6;-40\n2;1;-40;6;7;-50\n"),
              HasSubstr("two columns 'f' that differ"));
}

TEST(Layouts, RecordsOfScopesAndLoggers) {
  const auto both = [](double time_scale) {
    return [time_scale](int i) { return Cells{1e-4 * i * time_scale, input(i), output(i)}; };
  };
  for (const char* heading :
       {"X,CH1,CH2\nSecond,Volt,Volt\n", "Time(s),CH1(V),CH2(V),t0 =0s, tInc = 1e-04,\n",
        "in s,C1 in V,C2 in V\n",
        "Record Length,Analog:9\nSample Interval,Analog:0.0001\nSource,CH1,CH2\nSecond,Volt,Volt\n"})
    expect_record(table(heading, both(1.0)));
  expect_record(table("X,CH1,CH2,\nSecond,Volt,Volt,\n", both(1.0), {',', false, ",\n"}));
  expect_record(table("Elapsed Time (ms),AI0 (V),AI1 (V)\n", both(1e3)));
  expect_record(table("timestamp_us,a,b\n", both(1e6)));
  expect_record(table("Time\tPosition\tDisplacement\n[ms]\t[um]\t[um]\n", both(1e3), {'\t'}));
  expect_record(table("X_Dimension\tTime\tTime\n***End_of_Header***\nX_Value\tVoltage\tVoltage_0\tComment\n",
                      both(1.0), {'\t'}));
  expect_record(table("Sample,Time(s),CH1(V),CH2(V)\n", [](int i) {
    return Cells{double(i), 1e-4 * i, input(i), output(i)};
  }));
  // Tektronix TDS 5000: keys in quotation marks, the numbers beside them.
  std::string tektronix;
  for (int i = 0; i < kRows; ++i) {
    char text[80];
    std::snprintf(text, sizeof text, "%.9g,%.12g\n", 1e-4 * i, input(i));
    tektronix += (i == 0   ? "\"Record Length\",9,\"Points\","
                  : i == 1 ? "\"Sample Interval\",1e-4,\"s\","
                           : ",,,");
    tektronix += text;
  }
  expect_record(tektronix, false);
}

/// Rows without times, whose step stands above them.
TEST(Layouts, StepsThatStandAboveTheRows) {
  const auto without_times = [](int i) { return Cells{input(i), output(i)}; };
  const auto head = [](const std::string& x_columns, const std::string& names) {
    return "LabVIEW Measurement\nX_Columns\t" + x_columns +
           "\n***End_of_Header***\n\nChannels\t2\nSamples\t9\t9\nY_Unit_Label\tVolts\tVolts\n"
           "X_Dimension\tTime\tTime\nX0\t0\t0\nDelta_X\t0.000100\t0.000100\n***End_of_Header***\n" +
           names + "\tComment\n";
  };
  const auto behind_tabs = [](const std::string& table) {
    std::string rows;
    for (std::size_t at = 0; at < table.size(); at = table.find('\n', at) + 1)
      rows += "\t" + table.substr(at, table.find('\n', at) - at) + "\n";
    return rows;
  };
  const std::string rows = behind_tabs(table("", without_times, {'\t'}));
  expect_record(head("No", "X_Value\tVoltage_0\tVoltage_1") + rows);
  std::string commas = head("No", "X_Value\tVoltage_0\tVoltage_1") + rows;
  std::replace(commas.begin(), commas.end(), '.', ',');
  expect_record(commas);
  expect_record(table(head("Multi", "X_Value\tVoltage_0\tX_Value\tVoltage_1"),
                      [](int i) {
                        return Cells{1e-4 * i, input(i), 1e-4 * i, output(i)};
                      },
                      {'\t'}));
  expect_record(table("Unit:(V)\nTime interval,100.0uS\n\nindex,CH1_Voltage(V),CH2_Voltage(V)\n", [](int i) {
    return Cells{double(i), input(i), output(i)};
  }));
  // One channel alone.
  expect_record(
      head("No", "X_Value\tVoltage") + behind_tabs(table("", [](int i) { return Cells{input(i)}; })), false);
  // Spectra of LabVIEW, channels of different steps.
  std::string spectrum = head("No", "X_Value\tVoltage_0\tVoltage_1") + rows;
  spectrum.replace(spectrum.find("X_Dimension\tTime\tTime"), 21, "X_Dimension\tFrequency");
  EXPECT_THAT(refusal_of_response(spectrum), HasSubstr("/x"));
}

TEST(Layouts, TablesOfQucsconv) {
  expect_low_pass(table("\"acfrequency\";\"r out.v\";\"i out.v\"\n", parts, {';'}));
  const auto complex_record = [](double imaginary) {
    return table("\"time\";\"r in.Vt\";\"i in.Vt\";\"r out.Vt\";\"i out.Vt\"\n",
                 [=](int i) {
                   return Cells{1e-4 * i, input(i), 0.0, output(i), imaginary};
                 },
                 {';'});
  };
  expect_record(complex_record(0.0));
  EXPECT_THAT(refusal_of_response(complex_record(0.1)), HasSubstr("'out.Vt' is complex"));
}

TEST(Layouts, HantekScopes) {
  const auto channel = [](const std::string& name, const std::string& unit, double scale,
                          double (*value)(int)) {
    std::string out = "#CHANNEL:" + name + "\n#CLOCK=100uS\n#SIZE=9\n#UNITS:" + unit + "\n\n";
    return table(out, [=](int i) { return Cells{scale * value(i)}; }) + "\n\n";
  };
  expect_record(channel("CH1", "V", 1.0, input), false);
  expect_record(channel("CH1", "mV", 1e3, input) + channel("CH2", "V", 1.0, output));
  EXPECT_THAT(refusal_of_response(channel("CH1", "V", 1.0, input) + "#CHANNEL:CH2\n#CLOCK=200uS\n1\n"),
              HasSubstr("another time step"));
  expect_record(table("#timebase=2000000(ns)\n,#voltbase=1000000(mv/100)\n#size=9\n",
                      [](int i) {
                        return Cells{1e-4 * i, input(i)};
                      }),
                false);
}

TEST(Layouts, FieldSimulators) {
  expect_low_pass(table("#\"Frequency / Hz\"\t\"S2,1 [Magnitude in dB]\"\t\"S2,1 [Phase]\"\n#-----\n",
                        level_and_angle, {'\t'}));
  expect_low_pass(table("#\"Frequency / Hz\"\t\"Re(S2,1)\"\t\"Im(S2,1)\"\n#-----\n", parts, {'\t'}));
  // Names between wide gaps; a magnitude alone is no response with a phase.
  EXPECT_THAT(refusal_of_response(table("    Frequency / Hz         S2,1/abs,dB\n---------\n",
                                        [](int i) {
                                          return Cells{frequency(i), level(frequency(i))};
                                        },
                                        {' '})),
              HasSubstr("phase"));
  expect_low_pass(table("    Frequency / Hz         S2,1/abs,dB       S2,1/arg,degrees\n---------\n",
                        level_and_angle, {' '}));
  EXPECT_THAT(refusal_of_response(table("    Frequency / Hz         S2,1/arg,degrees\n---------\n",
                                        [](int i) {
                                          return Cells{frequency(i), angle(frequency(i))};
                                        },
                                        {' '})),
              HasSubstr("/x"));
}

TEST(Layouts, QucsDatasets) {
  std::string axis = "<Qucs Dataset 0.0.19>\n<indep frequency 9>\n";
  std::string values = "<dep out.v frequency>\n";
  std::string turned = values;  // by half a turn
  std::string time = "<Qucs Dataset 0.0.19>\n<indep time 9>\n";
  std::string in = "<dep in.Vt time>\n";
  std::string out = "<dep out.Vt time>\n";
  for (int i = 0; i < kRows; ++i) {
    const Complex h = low_pass(frequency(i));
    char text[80];
    std::snprintf(text, sizeof text, "  %+.14e\n", frequency(i));
    axis += text;
    std::snprintf(text, sizeof text, "  %+.14e-j%.14e\n", h.real(), -h.imag());
    values += text;
    std::snprintf(text, sizeof text, "  %+.14e+j%.14e\n", -h.real(), -h.imag());
    turned += text;
    std::snprintf(text, sizeof text, "  %+.14e\n", 1e-4 * i);
    time += text;
    std::snprintf(text, sizeof text, "  %+.14e\n", input(i));
    in += text;
    std::snprintf(text, sizeof text, "  %+.14e\n", output(i));
    out += text;
  }
  expect_low_pass(axis + "</indep>\n" + values + "</dep>\n");
  with_file(axis + "</indep>\n" + turned + "</dep>\n", "x", [](const std::string& path, Provenance& from) {
    EXPECT_LT(std::abs(FrequencyRecord::read_csv(path, from).response[4] / low_pass(1000.0) + 1.0), 1e-8);
  });
  EXPECT_THAT(refusal_of_response(axis + "</indep>\n<dep out.v frequency>\n  1*j2\n</dep>\n"),
              HasSubstr("'1*j2' is not a finite number"));
  expect_record(time + "</indep>\n" + in + "</dep>\n" + out + "</dep>\n");
  EXPECT_THAT(refusal_of_response(axis + "</indep>\n<dep out.v frequency>\n  +1.0-j2.0\n</dep>\n"),
              HasSubstr("begins 1 values over 9"));
  EXPECT_THAT(refusal_of_response(axis + "</indep>\n<dep out.v frequency>\n  1+2i\n</dep>\n"),
              HasSubstr(":14: '1+2i' is not a finite number"));
}

/// Columns that say one thing twice, and a phase that says no unit, in this program's own words too.
TEST(Layouts, OwnWordsWithoutUnits) {
  EXPECT_THAT(refusal_of_response(table("frequency_hz,magnitude_db,phase\n",
                                        [](int i) {
                                          Cells out = level_and_angle(i);
                                          out[2] = to_radians(out[2]);
                                          return out;
                                        })),
              HasSubstr("it may be radians"));
  expect_low_pass(table("frequency_hz,magnitude_db,phase_rad\n", [](int i) {
    Cells out = level_and_angle(i);
    out[2] = to_radians(out[2]);
    return out;
  }));
  expect_low_pass(table("Frequency (Hz),Gain,Gain (dB),Phase (deg)\n", [](int i) {
    const Cells at = level_and_angle(i);
    return Cells{at[0], 7.0, at[1], at[2]};
  }));
  expect_low_pass(table("Freq,Imag,Real\n", [](int i) {
    const Cells at = parts(i);
    return Cells{at[0], at[2], at[1]};
  }));
}

/// Names that say input and output go before the order of the columns.
TEST(Layouts, InputAndOutputByTheirNames) {
  const auto turned = [](int i) { return Cells{1e-4 * i, output(i), input(i)}; };
  for (const char* heading :
       {"Time (s),Output (V),Input (V)\n", "time,Out1,In1\n", "Zeit (s),Ausgang (V),Eingang (V)\n",
        "t,response,excitation\n", "time,measured,drive\n", "Time (s),Position (V),Voltage (V)\n"})
    expect_record(table(heading, turned));
  expect_record(table("time,error,output,input\n", [](int i) {
    return Cells{1e-4 * i, 9.0, output(i), input(i)};
  }));
}

}  // namespace
}  // namespace bodesmith
