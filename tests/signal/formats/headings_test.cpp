#include "signal/formats/headings.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace bodesmith::formats {
namespace {

using enum Quantity;
constexpr double kDegrees = 180.0 / std::numbers::pi;

struct Meant {
  const char* text;
  Quantity quantity;
  double scale;
  bool unit_known = true;
};

TEST(Headings, SayWhatAColumnIsAndInWhichUnit) {
  for (const Meant& m : {
           Meant{"Frequency (kHz)", frequency, 1e3},
           {"freq (mhz)", frequency, 1e6},
           {"freq (MHZ)", frequency, 1e6},
           {"freq (mHz)", frequency, 1e-3},
           {"f/GHz", frequency, 1e9},
           {"frequency_khz", frequency, 1e3},
           {"Hz", frequency, 1.0},
           {"F", frequency, 1.0},
           {"Frequency (rpm)", frequency, 1.0, false},
           {"Frequency (krad/s)", angular_frequency, 1e3},
           {"frequency_rad_s", angular_frequency, 1.0},
           {"omega", angular_frequency, 1.0},
           {"w (1/s)", angular_frequency, 1.0, false},
           {"Time (ms)", time, 1e-3},
           {"time_us", time, 1e-6},
           {"Time [\xC2\xB5s]", time, 1e-6},
           {"t, ns", time, 1e-9},
           {"Seconds", time, 1.0},
           {"X-Axis (ps)", time, 1e-12},
           {"Time (h)", time, 1.0, false},
           {"timer (V)", signal, 1.0},
           {"Gain (dB)", magnitude, 1.0},
           {"S21 Attenuation (dB)", magnitude, -1.0},
           {"Loss", magnitude, -1.0, false},
           {"-Gain (dB)", magnitude, -1.0},
           {"Gain (V/V)", magnitude, 1.0},
           {"Gain (bel)", magnitude, 1.0, false},
           {"PSD level (dB/Hz)", magnitude, 1.0, false},
           {"log gain", magnitude, 1.0, false},
           {"logmag", magnitude, 1.0},
           {"Amplitude (mV)", magnitude, 1e-3},
           {"Impedance (kOhm)", magnitude, 1e3},
           {"|Z| (M\xCE\xA9)", magnitude, 1e6},
           {"|Vac|", signal, 1.0},
           {"Ohm", magnitude, 1.0},
           {"Phase (deg)", phase, 1.0},
           {"Phase (rad)", phase, kDegrees},
           {"phase_rad", phase, kDegrees},
           {"Phase (mrad)", phase, 1e-3 * kDegrees},
           {"-Phase (rad)", phase, -kDegrees},
           {"Phase lag (deg)", phase, -1.0},
           {"Phase (turns)", phase, 1.0, false},
           {"cang_rad(S(2,1))", phase, kDegrees},
           {"cang_deg(S(2,1))", phase, 1.0},
           {"P(V(out))", phase, 1.0},
           {"P(I(R1)) (rad)", phase, kDegrees},
           {"P(W)", signal, 1.0},
           {"TR2: Gain (Degree)", phase, 1.0},
           {"TR1: Gain (Real)", real, 1.0},
           {"TR1: Gain (Imag)", imaginary, 1.0},
           {"-Im(Z)/kOhm", imaginary, -1e3},
           {"Re(Z) (mOhm)", real, 1e-3},
           {"R (Ohm)", real, 1.0},
           {"X (Ohm)", imaginary, 1.0},
           {"X", signal, 1.0},
           {"Coherence", coherence, 1.0},
           {"Phase margin (deg)", signal, 1.0},
           {"Gain error (mV)", signal, 1e-3},
           {"CH1 (mV)", signal, 1e-3},
           {"C2 in kV", signal, 1e3},
           {"I(R1) [uA]", signal, 1e-6},
           {"V(out)", signal, 1.0},
           {"Gain time (s)", signal, 1.0},
       }) {
    const Heading got = parse_heading(m.text);
    EXPECT_EQ(static_cast<int>(got.quantity), static_cast<int>(m.quantity)) << m.text;
    EXPECT_NEAR(got.scale / m.scale, 1.0, 1e-12) << m.text;
    EXPECT_EQ(got.unit_known, m.unit_known) << m.text;
    EXPECT_EQ(got.text, m.text);
  }
}

TEST(Headings, AMagnitudeIsALevelAQuotientDecibelsOrARatio) {
  struct Kind {
    const char* text;
    MagnitudeScale scale;
    bool level;
    bool quotient;
  };
  using enum MagnitudeScale;
  for (const Kind& k : {Kind{"Gain (dB)", decibel, false, false},
                        {"Trace 1 (dBV)", decibel, true, false},
                        {"Level (dBm)", decibel, true, false},
                        {"Magnitude (dBFS)", decibel, true, false},
                        {"Magnitude (dBuV)", decibel, true, false},
                        {"SPL (dB)", decibel, false, false},
                        {"Noise level (dB)", decibel, true, false},
                        {"Math (Ch B / Ch A) Magnitude (dB)", decibel, false, true},
                        {"db(S(2,1))", decibel, false, false},
                        {"mag(S(2,1))", linear, false, false},
                        {"S2,1 [Magnitude in dB]", decibel, false, false},
                        {"S2,1 [Magnitude]", linear, false, false},
                        {"Magnitude (dBV/Ohm)", unknown, false, false},
                        {"Magnitude", unknown, false, false},
                        {"Amplitude (V)", linear, true, false},
                        {"Impedance (Ohm)", linear, false, false},
                        {"Gain (ratio)", linear, false, false},
                        {"Linear gain", linear, false, false},
                        {"Attenuation (dB)", decibel, false, false}}) {
    const Heading got = parse_heading(k.text);
    EXPECT_EQ(static_cast<int>(got.quantity), static_cast<int>(magnitude)) << k.text;
    EXPECT_EQ(static_cast<int>(got.magnitude), static_cast<int>(k.scale)) << k.text;
    EXPECT_EQ(got.level, k.level) << k.text;
    EXPECT_EQ(got.quotient, k.quotient) << k.text;
  }
  for (const char* text : {"Frequency Log(Hz)", "Log frequency (Hz)", "frequency log10 (Hz)"})
    EXPECT_TRUE(parse_heading(text).logarithm) << text;
  EXPECT_FALSE(parse_heading("Frequency (Hz)").logarithm);
}

TEST(Headings, UnitsThatStandAlone) {
  for (const char* unit : {"Hz", "(kHz)", "[ms]", "dB", "dBV", "rad", "mrad", "deg", "degrees", "\xC2\xB0",
                           "V", "mA", "Vpp", "Ohm", "k\xCE\xA9", "krad/s", "rad_s", " s "})
    EXPECT_TRUE(is_unit_alone(unit)) << unit;
  for (const char* word : {"", "*", "()", "#", "Time", "gain", "xHz", "12", "dBx", "(", "kdB"})
    EXPECT_FALSE(is_unit_alone(word)) << word;
}

// Beside other columns: a first column in seconds is the time where all others are signals; "r x" and "i x" are one number.
TEST(Headings, ColumnsThatSayWhatTheirNeighboursAre) {
  const auto quantities = [](const std::vector<std::string>& texts) {
    std::vector<Quantity> out;
    for (const Heading& h : parse_headings(texts)) out.push_back(h.quantity);
    return out;
  };
  EXPECT_EQ(quantities({"X (ms)", "A (V)"}), (std::vector{time, signal}));
  EXPECT_EQ(parse_headings({"X (ms)", "A (V)"})[0].scale, 1e-3);
  EXPECT_EQ(quantities({"X (ms)", "Amplitude (V)"}), (std::vector{time, magnitude}));
  EXPECT_EQ(quantities({"X (ms)", "Gain (dB)"}), (std::vector{signal, magnitude}));
  EXPECT_EQ(quantities({"A (V)", "X (ms)"}), (std::vector{signal, signal}));
  EXPECT_EQ(quantities({"f", "r a.v", "i a.v"}), (std::vector{frequency, real, imaginary}));
  EXPECT_EQ(quantities({"f", "r a.v", "i b.v"}), (std::vector{frequency, signal, signal}));
  EXPECT_EQ(quantities({}), std::vector<Quantity>{});

  const auto of = [](const std::vector<std::string>& texts) { return parse_headings(texts); };
  EXPECT_EQ(frequency_column(of({"omega", "gain", "f"})), 2U);
  EXPECT_EQ(frequency_column(of({"gain", "omega"})), 1U);
  EXPECT_FALSE(frequency_column(of({"t", "u"})));
  EXPECT_EQ(first_of(of({"gain", "f", "gain", "phase"}), magnitude, 1), 2U);
  EXPECT_FALSE(first_of(of({"gain", "f"}), magnitude, 1));
  EXPECT_TRUE(has_response_headings(of({"f", "gain"})));
  EXPECT_TRUE(has_response_headings(of({"w", "Re(H)"})));
  EXPECT_FALSE(has_response_headings(of({"f", "phase"})));
  EXPECT_FALSE(has_response_headings(of({"gain", "phase"})));
  EXPECT_TRUE(has_record_headings(of({"u", "t"})));
  EXPECT_FALSE(has_record_headings(of({"t"})));
  EXPECT_FALSE(has_record_headings(of({"u", "y"})));
}

}  // namespace
}  // namespace bodesmith::formats
