// Files written here by their formats' descriptions, in every writing that a format knows, and read again.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <string>
#include <tuple>

#include "base/error.hpp"
#include "base/units.hpp"
#include "signal/formats/format.hpp"

namespace bodesmith::formats {
namespace {
using testing::HasSubstr;
using Numbers = std::vector<double>;

Foreign read_bytes(const std::string& bytes, const std::string& choice = "", Content wanted = Content::any) {
  const Source source{"x", bytes, bytes, choice, wanted, {}};
  const Format* format = format_of(source);
  if (format == nullptr) throw InputError("x", 0, "no format");
  return format->read(source);
}
std::string refusal_of_bytes(const std::string& bytes, const std::string& choice = "") {
  try {
    read_bytes(bytes, choice);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

/// Parameter i, j (from 0) of point k, every one another.
std::complex<double> entry(std::size_t i, std::size_t j, std::size_t k) {
  const auto [a, b, c] = std::tuple(double(i), double(j), double(k));
  return std::polar(0.2 + 0.3 * a + 0.11 * b + 0.05 * c, 0.4 - 0.5 * a + 0.7 * b + 0.1 * c);
}

struct Network {
  std::size_t ports = 1;
  char parameter = 'S';
  std::string pairs = "RI";
  std::string unit = "kHz";
  double hz = 1e3;
  bool version2 = false;
  std::string matrix = "Full";
  bool order_12_21 = false;

  bool has(std::size_t i, std::size_t j) const {
    return matrix == "Full" || (matrix == "Lower" ? j <= i : j >= i);
  }
  /// By what version 1 divides a parameter: its dimension, of 75 ohms.
  double normal(std::size_t i, std::size_t j) const {
    if (version2 || parameter == 'S') return 1.0;
    if (parameter == 'Z') return 75.0;
    if (parameter == 'Y') return 1.0 / 75.0;
    return i != j ? 1.0 : (parameter == 'H') == (i == 0) ? 75.0 : 1.0 / 75.0;
  }

  std::string text() const {
    std::string out = version2 ? "[Version] 2.0\n" : "! a comment\n";
    out += "# " + unit + " " + parameter + " " + pairs + " R 75 ! more\n";
    if (version2)
      out += "[Number of Ports] " + std::to_string(ports) + "\n[Two-Port Data Order] " +
             (order_12_21 ? "12_21" : "21_12") + "\n[Number of Frequencies] 2\n[Matrix Format] " + matrix +
             "\n[Begin Information]\n1 2 3 words\n[End Information]\n[Reference] 75" +
             std::string(ports > 1 ? "\n75" : "") + "\n[Network Data]\n";
    for (std::size_t k = 0; k < 2; ++k) {
      out += std::to_string(3 + k);
      for (std::size_t i = 0; i < ports; ++i) {
        for (std::size_t j = 0; j < ports; ++j) {
          if (!has(i, j)) continue;
          const bool across = ports == 2 && matrix == "Full" && !order_12_21;
          const std::size_t row = across ? j : i;
          const std::size_t column = across ? i : j;
          const std::complex<double> h = entry(row, column, k) / normal(row, column);
          const double degrees = to_degrees(std::arg(h));
          // Below 0: half a turn, and half a turn back.
          const auto [a, b] = pairs == "RI"   ? std::pair(h.real(), h.imag())
                              : pairs == "MA" ? std::pair(-std::abs(h), degrees - 180.0)
                                              : std::pair(to_decibel(std::abs(h)), degrees);
          char pair[80];
          std::snprintf(pair, sizeof pair, " %.15g %.15g", a, b);
          out += pair;
        }
        if (ports > 2 || i + 1 == ports) out += "\n";
      }
    }
    // Noise parameters follow where the frequency falls back.
    if (!version2 && ports == 2) out += "4 1 0.5 20 0.3\n5 1 0.5 20 0.3\n";
    return out + (version2 ? "[End]\n" : "");
  }
};

void expect_all_parameters(const Network& network) {
  const std::string text = network.text();
  for (std::size_t i = 0; i < network.ports; ++i) {
    for (std::size_t j = 0; j < network.ports; ++j) {
      const Foreign got = read_bytes(
          text, std::string(1, network.parameter) + std::to_string(i + 1) + "," + std::to_string(j + 1));
      ASSERT_EQ(got.columns.size(), 3U) << text;
      ASSERT_EQ(got.columns[0].size(), 2U) << text;
      for (std::size_t k = 0; k < 2; ++k) {
        EXPECT_NEAR(got.columns[0][k], (3.0 + double(k)) * network.hz, 1e-9 * network.hz);
        const auto h = std::polar(from_decibel(got.columns[1][k]), to_radians(got.columns[2][k]));
        EXPECT_LT(std::abs(h / (network.has(i, j) ? entry(i, j, k) : entry(j, i, k)) - 1.0), 1e-11)
            << text << i << j << k;
      }
    }
  }
}

TEST(Touchstone, EveryParameterIsFoundInEveryWriting) {
  for (const char parameter : {'S', 'Z', 'Y', 'H', 'G'}) {
    for (const bool version2 : {false, true})
      expect_all_parameters({2, parameter, "RI", "kHz", 1e3, version2});
  }
  for (const char* pairs : {"RI", "MA", "DB"}) {
    for (const std::size_t ports : {1U, 2U, 3U}) expect_all_parameters({ports, 'Z', pairs, "Hz", 1.0});
  }
  expect_all_parameters({1, 'S', "RI", "MHz", 1e6});
  expect_all_parameters({1, 'S', "RI", "GHz", 1e9});
  expect_all_parameters({2, 'S', "RI", "kHz", 1e3, true, "Full", true});
  for (const std::size_t ports : {2U, 3U, 4U}) {
    for (const char* matrix : {"Lower", "Upper"})
      expect_all_parameters({ports, 'S', "RI", "kHz", 1e3, true, matrix});
  }
}

TEST(Touchstone, WhatItTakesWithoutAChoiceAndWhatItRefuses) {
  EXPECT_THAT(read_bytes(Network{1}.text()).read_as, HasSubstr(": S11 of 1 port;"));
  EXPECT_THAT(read_bytes(Network{3}.text()).read_as, HasSubstr(": S21 of 3 ports;"));
  // GHz, S, MA and 50 ohm are what an option line that says nothing means.
  EXPECT_EQ(read_bytes("# GHz S MA R\n2 0.1 0\n", "s11").columns[0][0], 2e9);
  EXPECT_NEAR(read_bytes("# GHz Z MA\n2 0.1 0\n").columns[1][0], to_decibel(5.0), 1e-12);
  // Of two option lines the first counts.
  EXPECT_EQ(read_bytes("# kHz S MA R 50\n2 0.1 0\n# Hz S RI R 50\n3 0.1 0\n", "s11").columns[0][0], 2e3);
  const std::string version2 = "[Version] 2.0\n# Hz S RI R 50\n[Number of Ports] ";
  for (const std::string& wrong :
       {std::string("# Hz S RI R 50\n1 1 0\n1 1 0\n"), std::string("# Hz S RI R 50\n-1 1 0\n"),
        std::string("# Hz S RI R 50\n1 1 0 1 0\n"), std::string("# Hz Z RI R 0\n1 1 0\n"),
        std::string("# Hz Z RI R\n1 1 0\n"), version2 + "1\n[Network Data]\n1 1 0\n",
        version2 + "100\n[Network Data]\n1 1 0\n[End]\n", version2 + "0\n[Network Data]\n1 1 0\n[End]\n",
        version2 + "1\n[Number of Frequencies] 2\n[Network Data]\n1 1 0\n[End]\n",
        version2 + "1\n[Network Data]\n1 1 0 2\n[End]\n", version2 + "1\n[Network Data]\n[End]\n"})
    EXPECT_THAT(refusal_of_bytes(wrong), testing::StartsWith("x:")) << wrong;
  EXPECT_EQ(read_bytes(version2 + "1\n[Network Data]\n1 1 0\n[End]\n").columns[0], Numbers{1.0});
  for (const char* choice : {"s12", "s21", "z11", "s", "s1", "s0,1", "s1,", "s111"})
    EXPECT_THAT(refusal_of_bytes(Network{1}.text(), choice), HasSubstr("it holds S11 to S11")) << choice;
}

TEST(Citi, PairsOfEveryForm) {
  for (const auto& [form, rows] : {std::pair("RI", "0,2\n-3,0\n"),
                                   {"MAGANGLE", "2,90\n-3,0\n"},
                                   {"DBANGLE", "6.020599913279624,90\n9.542425094393248,-180\n"}}) {
    const Foreign got =
        read_bytes(std::string("CITIFILE A.01.00\nVAR FREQ MAG 2\nDATA S[2,1] ") + form +
                   "\nSEG_LIST_BEGIN\nSEG 5 9 1\nSEG 20 30 1\nSEG_LIST_END\nBEGIN\n" + rows + "END\n");
    EXPECT_EQ(got.columns[0], (Numbers{5.0, 20.0}));
    EXPECT_NEAR(got.columns[1][0], to_decibel(2.0), 1e-12) << form;
    EXPECT_NEAR(got.columns[1][1], to_decibel(3.0), 1e-12) << form;
    EXPECT_NEAR(got.columns[2][0], 90.0, 1e-12) << form;
    EXPECT_NEAR(std::abs(got.columns[2][1]), 180.0, 1e-12) << form;
  }
}

template <class T>
std::string bytes_of(T value, bool little = true) {
  std::string out(sizeof value, '\0');
  std::memcpy(out.data(), &value, sizeof value);
  return little ? out : std::string(out.rbegin(), out.rend());
}

/// One part of a MATLAB 5 file: type, length, bytes, filled up to eight.
std::string mat_part(std::uint32_t type, const std::string& bytes, bool little) {
  const std::string filled = bytes + std::string((8 - bytes.size() % 8) % 8, '\0');
  return bytes_of(type, little) + bytes_of(std::uint32_t(type == 14 ? filled.size() : bytes.size()), little) +
         filled;
}
template <class T>
std::string mat_numbers(std::uint32_t type, const Numbers& values, bool little) {
  std::string out;
  for (const double v : values) out += bytes_of(static_cast<T>(v), little);
  return mat_part(type, out, little);
}
std::string mat_head(const std::string& name, std::uint32_t flags, const std::vector<std::int32_t>& shape,
                     bool little) {
  std::string dims;
  for (const std::int32_t d : shape) dims += bytes_of(d, little);
  return mat_part(6, bytes_of(flags, little) + bytes_of(std::uint32_t{0}, little), little) +
         mat_part(5, dims, little) + mat_part(1, name, little);
}
template <class T>
std::string mat_matrix(const std::string& name, std::uint32_t kind, std::uint32_t type,
                       const std::vector<std::int32_t>& shape, const Numbers& re, const Numbers& im = {},
                       bool little = true) {
  return mat_part(14,
                  mat_head(name, kind | (im.empty() ? 0U : 0x800U), shape, little) +
                      mat_numbers<T>(type, re, little) + (im.empty() ? "" : mat_numbers<T>(type, im, little)),
                  little);
}
std::string mat_vector(const std::string& name, const Numbers& re, const Numbers& im = {},
                       bool little = true) {
  return mat_matrix<double>(name, 6, 9, {1, static_cast<std::int32_t>(re.size())}, re, im, little);
}
std::string mat_file(const std::string& matrices, bool little = true) {
  std::string head = "MATLAB 5.0 MAT-file";
  head.resize(124, ' ');
  return head + bytes_of(std::uint16_t{0x0100}, little) + (little ? "IM" : "MI") + matrices;
}

TEST(MatlabFile, NumbersOfEveryKindAndByteOrder) {
  const Numbers values{0.0, 1.0, 100.0, 7.0};
  const std::vector<std::int32_t> shape{4, 1};
  const std::string rate = mat_vector("dt", {0.25});
  for (const std::string& u :
       {mat_matrix<double>("u", 6, 9, shape, values), mat_matrix<float>("u", 7, 7, shape, values),
        mat_matrix<std::int8_t>("u", 8, 1, shape, values), mat_matrix<std::uint8_t>("u", 9, 2, shape, values),
        mat_matrix<std::int16_t>("u", 10, 3, shape, values),
        mat_matrix<std::uint16_t>("u", 11, 4, shape, values),
        mat_matrix<std::int32_t>("u", 12, 5, shape, values),
        mat_matrix<std::uint32_t>("u", 13, 6, shape, values),
        mat_matrix<std::int64_t>("u", 14, 12, shape, values),
        mat_matrix<std::uint64_t>("u", 15, 13, shape, values)}) {
    const Foreign got = read_bytes(mat_file(rate + u));
    EXPECT_EQ(got.columns, (std::vector<Numbers>{{0.0, 0.25, 0.5, 0.75}, values}));
  }
  const Foreign big =
      read_bytes(mat_file(mat_vector("fs", {4.0}, {}, false) + mat_vector("u", values, {}, false), false));
  EXPECT_EQ(big.columns, (std::vector<Numbers>{{0.0, 0.25, 0.5, 0.75}, values}));
}

// A matrix is a vector a column, a structure its fields; an axis in rad/s is one by its name.
TEST(MatlabFile, ColumnsFieldsAndAxes) {
  const std::string rate = mat_vector("fs", {10.0});
  const Foreign columns =
      read_bytes(mat_file(rate + mat_matrix<double>("m", 6, 9, {3, 2}, {1, 2, 3, 4, 5, 6})), "m(2),m(1)",
                 Content::record);
  EXPECT_EQ(columns.columns[1], (Numbers{4, 5, 6}));
  EXPECT_EQ(columns.columns[2], (Numbers{1, 2, 3}));
  EXPECT_THAT(
      refusal_of_bytes(mat_file(rate + mat_matrix<double>("u", 6, 9, {2, 2, 2}, {1, 2, 3, 4, 5, 6, 7, 8}))),
      HasSubstr("'u' has 3 dimensions"));
  EXPECT_EQ(read_bytes(mat_file(rate + mat_matrix<double>("u", 6, 9, {1, 1, 3}, {1, 2, 3}))).columns[1],
            (Numbers{1, 2, 3}));

  const std::string names = std::string("fs\0\0\0\0\0\0", 8) + std::string("u\0\0\0\0\0\0\0", 8);
  const std::string record = mat_part(14,
                                      mat_head("rec", 2, {1, 1}, true) + bytes_of(std::uint32_t{0x40005}) +
                                          bytes_of(std::int32_t{8}) + mat_part(1, names, true) +
                                          mat_vector("", {10.0}) + mat_vector("", {3, 1, 2}),
                                      true);
  EXPECT_EQ(read_bytes(mat_file(record)).columns, (std::vector<Numbers>{{0.0, 0.1, 0.2}, {3, 1, 2}}));

  const double turn = 6.283185307179586;
  for (const auto& [name, scale] :
       {std::pair("f", 1.0), {"Freq_Hz", 1.0}, {"w", 1.0 / turn}, {"omega_rad_s", 1.0 / turn}}) {
    const Foreign got =
        read_bytes(mat_file(mat_vector(name, {1.0, 2.0}) + mat_vector("h", {0.0, 3.0}, {2.0, 0.0})));
    EXPECT_NEAR(got.columns[0][1], 2.0 * scale, 1e-15) << name;
    EXPECT_NEAR(got.columns[1][1], to_decibel(3.0), 1e-12);
    EXPECT_NEAR(got.columns[2][0], 90.0, 1e-12);
  }
  const std::string f = mat_vector("f", {1.0, 2.0});
  for (const auto& [name, level] : {std::pair("mag", 0.5),
                                    {"mag_db", -6.020599913279624},
                                    {"gain", 0.5},
                                    {"gain_db", -6.020599913279624}}) {
    for (const auto& [phase, angle] : {std::pair("phase_deg", 90.0), {"phase_rad", turn / 4.0}}) {
      const Foreign got =
          read_bytes(mat_file(f + mat_vector(name, {level, level}) + mat_vector(phase, {angle, angle})));
      EXPECT_NEAR(got.columns[1][0], to_decibel(0.5), 1e-12) << name;
      EXPECT_NEAR(got.columns[2][1], 90.0, 1e-12) << phase;
    }
  }
}

TEST(MatlabFile, WhatDoesNotFitIsRefused) {
  const std::string f = mat_vector("f", {1.0, 2.0});
  const std::string rate = mat_vector("fs", {10.0});
  const auto said = [](const std::string& matrices, const std::string& choice = "") {
    return refusal_of_bytes(mat_file(matrices), choice);
  };
  EXPECT_THAT(said(f + mat_vector("mag", {1, 2, 3})),
              HasSubstr("'mag' has 3 values, expected 2 as of its axis"));
  EXPECT_THAT(said(f + mat_vector("h", {1, 2, 3}), "f,h"), HasSubstr("'h' has 3 values, f has 2"));
  EXPECT_THAT(said(f + mat_vector("h", {1, 2}), "f/h"), HasSubstr("is a quotient"));
  EXPECT_THAT(said(f + mat_vector("a", {1, 2}, {1, 2}) + mat_vector("b", {1, 2}, {1, 2})),
              HasSubstr("holds f (2), a (2), b (2)"));
  EXPECT_THAT(said(rate + mat_vector("u", {1, 2}, {0, 1})), HasSubstr("'u' is complex"));
  EXPECT_THAT(
      said(mat_vector("t", {0, 1, 2}) + mat_vector("a", {1, 2, 3}) + mat_vector("b", {1, 2}), "t,a,b"),
      HasSubstr("'b' has 2 values, t has 3"));
  EXPECT_THAT(said(mat_vector("fs", {0.0}) + mat_vector("u", {1, 2})), HasSubstr("expected f or w"));
  EXPECT_THAT(said(""), HasSubstr("holds no vectors"));
  // Text stands for no numbers, once.
  const std::string text = mat_matrix<std::uint16_t>("u", 4, 4, {1, 3}, {72, 105, 33});
  EXPECT_THAT(said(rate + mat_vector("y", {1, 2, 3}) + text, "y,u"),
              HasSubstr("'u' is text, expected numbers"));
  EXPECT_THAT(said(text), HasSubstr("holds no vectors of numbers: 'u' is text"));
  const std::string whole = mat_file(rate + mat_vector("u", {1, 2, 3}));
  for (const std::size_t size : {whole.size() - 1, whole.size() - 70, std::size_t{130}, std::size_t{127}})
    EXPECT_THAT(refusal_of_bytes(whole.substr(0, size)),
                HasSubstr("x: byte " + std::to_string(size) + ": the file ends within"))
        << size;
  std::string changed = whole;
  changed[128] = 13;
  EXPECT_THAT(refusal_of_bytes(changed), HasSubstr("x: byte 128: an element of type 13"));
  changed = whole;
  changed[125] = 2;
  EXPECT_THAT(refusal_of_bytes(changed), HasSubstr("version 7.3"));
  // The length of a part within its variable.
  changed = whole;
  changed[128 + 8 + 4] = 127;
  EXPECT_THAT(refusal_of_bytes(changed), HasSubstr("x: byte 136: a part of a variable goes beyond"));
}

std::string wave(std::uint16_t code, std::uint16_t bits, const std::string& samples,
                 std::uint16_t channels = 1, bool extensible = false) {
  std::string format = bytes_of(std::uint16_t(extensible ? 0xFFFE : code)) + bytes_of(channels) +
                       bytes_of(std::uint32_t{8}) + bytes_of(std::uint32_t{0}) + bytes_of(std::uint16_t{0}) +
                       bytes_of(bits);
  if (extensible) format += std::string(8, '\0') + bytes_of(code) + std::string(14, '\0');
  const auto chunk = [](const std::string& id, const std::string& bytes) {
    return id + bytes_of(std::uint32_t(bytes.size())) + bytes + std::string(bytes.size() % 2, '\0');
  };
  return "RIFF" + bytes_of(std::uint32_t{0}) + "WAVE" + chunk("LIST", "odd") + chunk("fmt ", format) +
         chunk("data", samples);
}

TEST(WaveAudio, SamplesOfEveryWidth) {
  const Numbers wanted{0.5, -1.0, 0.0};
  const auto three = [](auto a, auto b, auto c) { return bytes_of(a) + bytes_of(b) + bytes_of(c); };
  const std::string wide24 = std::string("\x00\x00\x40\x00\x00\x80\x00\x00\x00", 9);
  for (const bool extensible : {false, true}) {
    for (const auto& [code, bits, samples] :
         {std::tuple(1, 8, three(std::uint8_t{192}, std::uint8_t{0}, std::uint8_t{128})),
          std::tuple(1, 16, three(std::int16_t{16384}, std::int16_t{-32768}, std::int16_t{0})),
          std::tuple(1, 24, wide24),
          std::tuple(1, 32, three(std::int32_t{1 << 30}, std::int32_t{-2147483647 - 1}, std::int32_t{0})),
          std::tuple(3, 32, three(0.5F, -1.0F, 0.0F)), std::tuple(3, 64, three(0.5, -1.0, 0.0))}) {
      const Foreign got = read_bytes(wave(std::uint16_t(code), std::uint16_t(bits), samples, 1, extensible));
      EXPECT_EQ(got.columns, (std::vector<Numbers>{{0.0, 0.125, 0.25}, wanted})) << code << " " << bits;
    }
  }
  const Foreign two =
      read_bytes(wave(3, 64, bytes_of(1.0) + bytes_of(2.0) + bytes_of(3.0) + bytes_of(4.0), 2));
  EXPECT_EQ(two.columns, (std::vector<Numbers>{{0.0, 0.125}, {1.0, 3.0}, {2.0, 4.0}}));
  for (const auto& [code, bits] : {std::pair(1, 12), {3, 16}, {2, 16}, {1, 64}})
    EXPECT_THAT(refusal_of_bytes(wave(std::uint16_t(code), std::uint16_t(bits), std::string(24, '\0'))),
                HasSubstr("expected 8 to 32 bits"));
  EXPECT_THAT(refusal_of_bytes(wave(1, 16, "abc")), HasSubstr("expected a multiple of 2"));
  EXPECT_THAT(refusal_of_bytes(wave(1, 16, "ab")), HasSubstr("fewer than two samples"));
  EXPECT_THAT(refusal_of_bytes(wave(1, 16, "abcd", 0)), HasSubstr("no channels"));
}

/// Two runs of `points`, an axis and two variables: x = 1, 2 … in each, and 10 x, 100 x (and as much less 1 as imaginary part).
std::string raw_file(const std::string& flags, std::size_t other, bool complex, bool by_variable,
                     const std::string& axis) {
  const std::size_t points = 6;
  std::string out = "Title: t\nDate: d\nPlotname: p\nFlags: " + flags +
                    "\nNo. Variables: 3\nNo. Points: " + std::to_string(points) + "\nVariables:\n\t0\t" +
                    axis + "\t" + axis + "\n\t1\tV(in)\tvoltage\n\t2\tV(out)\tvoltage\nBinary:\n";
  const auto value = [&](std::size_t v, std::size_t i) {
    const double x = double(1 + i % 3) * (v == 0 ? 1.0 : v == 1 ? 10.0 : 100.0);
    if (complex) return bytes_of(x) + bytes_of(v == 0 ? 0.0 : x - 1.0);
    return v > 0 && other == 4 ? bytes_of(static_cast<float>(x)) : bytes_of(x);
  };
  for (std::size_t a = 0; a < (by_variable ? 3 : points); ++a) {
    for (std::size_t b = 0; b < (by_variable ? points : 3); ++b)
      out += by_variable ? value(a, b) : value(b, a);
  }
  return out;
}

TEST(SpiceRaw, NumbersOfEveryWidthAndOrder) {
  for (const bool by_variable : {false, true}) {
    const std::string fast = by_variable ? " fastaccess" : "";
    for (const std::string& bytes : {raw_file("real" + fast, 8, false, by_variable, "time"),
                                     raw_file("real forward" + fast, 4, false, by_variable, "time"),
                                     raw_file("real forward double" + fast, 8, false, by_variable, "time")}) {
      for (const char* run : {"", "@2"}) {
        EXPECT_EQ(read_bytes(bytes, std::string("V(in),V(out)") + run).columns,
                  (std::vector<Numbers>{{1, 2, 3}, {10, 20, 30}, {100, 200, 300}}));
      }
      EXPECT_THAT(refusal_of_bytes(bytes, "V(in)@3"), HasSubstr("holds 2 runs, there is no run 3"));
      for (const char* run : {"V(in)@0", "V(in)@1.5", "V(in)@x"})
        EXPECT_THAT(refusal_of_bytes(bytes, run), HasSubstr("is no run"));
      EXPECT_THAT(refusal_of_bytes(bytes.substr(0, bytes.size() - 1), "V(in)"),
                  HasSubstr("ends within point 6 of 6"));
    }
    const Foreign got = read_bytes(raw_file("complex" + fast, 16, true, by_variable, "frequency"));
    EXPECT_EQ(got.columns[0], (Numbers{1, 2, 3}));
    for (std::size_t i = 0; i < 3; ++i) {
      const std::complex<double> h(100.0 * double(i + 1), 100.0 * double(i + 1) - 1.0);
      EXPECT_NEAR(got.columns[1][i], to_decibel(std::abs(h)), 1e-12);
      EXPECT_NEAR(got.columns[2][i], to_degrees(std::arg(h)), 1e-12);
    }
  }
}

}  // namespace
}  // namespace bodesmith::formats
