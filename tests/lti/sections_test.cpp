#include "lti/sections.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "base/documents/json.hpp"
#include "base/error.hpp"

namespace bodesmith {
namespace {

using Complex = std::complex<double>;

TEST(Sections, ResponseIsTheProductOfFactors) {
  Sections h;
  h.gain = 2.0;
  h.sections.push_back(Section::pole_zero(3.0, RadPerSecond{10}, RadPerSecond{100}));
  Section biquad;
  biquad.gain = 0.5;
  biquad.zeros = {Complex(-1, 5), Complex(-1, -5)};
  biquad.poles = {Complex(-2, 7), Complex(-2, -7)};
  h.sections.push_back(biquad);
  const Complex s(0.0, 4.0);
  const Complex wanted = 2.0 * 3.0 * (1.0 + s / 10.0) / (1.0 + s / 100.0) * 0.5 * (s * s + 2.0 * s + 26.0) /
                         (s * s + 4.0 * s + 53.0);
  EXPECT_LT(std::abs(h.response(RadPerSecond{4.0}) - wanted), 1e-12);
  EXPECT_NEAR(h.dc_gain(), 6.0 * 0.5 * 26.0 / 53.0, 1e-12);
  EXPECT_EQ(h.pole_count(), 3);
}

TEST(Sections, RefusesWhatNoCircuitCouldBe) {
  const auto read = [](const std::string& section) {
    Sections::from_node(parse_json(
        R"({"schema": "bodesmith.sections/1", "gain": 1, "sections": [)" + section + "]}", "s.json"));
  };
  EXPECT_NO_THROW(read(R"({"gain": 1, "zeros_rad_s": [], "poles_rad_s": [[-1, 0]]})"));
  EXPECT_THROW(read(R"({"gain": 1, "zeros_rad_s": [], "poles_rad_s": [[1, 0]]})"), InputError) << "unstable";
  EXPECT_THROW(read(R"({"gain": 1, "zeros_rad_s": [], "poles_rad_s": [[0, 5], [0, -5]]})"), InputError)
      << "rings for ever";
  EXPECT_NO_THROW(read(R"({"gain": 1, "zeros_rad_s": [], "poles_rad_s": [[0, 0], [-3, 0]]})"))
      << "integrates";
  EXPECT_THROW(read(R"({"gain": 1, "zeros_rad_s": [], "poles_rad_s": []})"), InputError);
  EXPECT_THROW(read(R"({"gain": 1, "zeros_rad_s": [[-1,0],[-2,0]], "poles_rad_s": [[-1,0]]})"), InputError);
  EXPECT_THROW(read(R"({"gain": 1, "zeros_rad_s": [], "poles_rad_s": [[-1,1],[-1,-2]]})"), InputError);
  EXPECT_THROW(read(R"({"gain": 0, "zeros_rad_s": [], "poles_rad_s": [[-1,0]]})"), InputError);
  EXPECT_THROW(read(R"({"gain": 1, "zeros_rad_s": [], "poles_rad_s": [[-1]]})"), InputError);
}

TEST(Sections, OnTheAxisNothingIsStableAndThePoleAtZeroIntegrates) {
  Section h = Section::pole_zero(1.0, RadPerSecond{10}, RadPerSecond{100});
  EXPECT_TRUE(h.is_stable());
  EXPECT_FALSE(integrates(h));
  EXPECT_EQ(h.high_frequency_gain(), h.gain);
  h.poles = {Complex(0.0, 5.0), Complex(0.0, -5.0)};
  EXPECT_FALSE(h.is_stable());
  EXPECT_FALSE(integrates(h));
  EXPECT_EQ(h.high_frequency_gain(), 0.0);
  h.poles = {Complex(0.0, 0.0)};
  EXPECT_FALSE(h.is_stable());
  EXPECT_TRUE(integrates(h));
  EXPECT_EQ(h.dc_gain(), INFINITY);
  h.gain = -h.gain;
  EXPECT_EQ(h.dc_gain(), -INFINITY);
  h.poles.emplace_back(2.0, 0.0);
  EXPECT_FALSE(integrates(h)) << "runs away";
}

TEST(Sections, DelayTurnsTheResponseAndIsKeptInTheFile) {
  Sections h;
  h.sections.push_back(Section::pole_zero(3.0, RadPerSecond{10}, RadPerSecond{400}));
  const RadPerSecond w{50.0};
  const Complex without = h.response(w);
  h.delay_s = 0.01;
  EXPECT_LT(std::abs(h.response(w) - without * std::polar(1.0, -0.5)), 1e-14);
  EXPECT_NEAR(h.corner_band().from.rad_s().value, 10.0, 1e-12);
  EXPECT_NEAR(h.corner_band().to.rad_s().value, 400.0, 1e-10);
  Json json = {{"schema", "bodesmith.sections/1"}};
  json.update(h.to_json());
  EXPECT_EQ(Sections::from_node(parse_json(to_text(json), "s.json")).response(w), h.response(w));
  h.error = Sections::Error{{Hertz{1.0}, Hertz{90.0}}, 0.1, 0.2, 0.3};
  json.update(h.to_json());
  const auto error = Sections::from_node(parse_json(to_text(json), "s.json")).error;
  ASSERT_TRUE(error.has_value());
  EXPECT_EQ(error->band.to.value, 90.0);
  EXPECT_EQ(error->max_magnitude_db, 0.1);
  EXPECT_EQ(error->max_phase_deg, 0.2);
  EXPECT_EQ(error->everywhere_max_magnitude_db, 0.3);
  EXPECT_TRUE(!integrates(h));
  h.sections.push_back({1.0, {}, {0.0}});
  EXPECT_TRUE(integrates(h));
  json["error"]["band_hz"] = {1.0};
  EXPECT_THROW(Sections::from_node(parse_json(to_text(json), "s.json")), InputError);
  json["error"]["band_hz"] = {1.0, 90.0};
  json["delay_s"] = -1e-6;
  EXPECT_THROW(Sections::from_node(parse_json(to_text(json), "s.json")), InputError);
}

}  // namespace
}  // namespace bodesmith
