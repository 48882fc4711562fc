// circuit.json: what was made, read back; the sensitivities it states.
#include "synthesis/circuit_file.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/documents/json.hpp"
#include "base/error.hpp"
#include "schematic/analysis/response.hpp"
#include "seed_sections.hpp"

namespace bodesmith::synthesis {
namespace {

using Complex = std::complex<double>;

Json file_of(const Realised& made) {
  Json out = to_json(made);
  out["schema"] = "bodesmith.circuit/1";
  return out;
}

CircuitFile read_back(const Json& json) {
  return CircuitFile::from_node(parse_json(to_text(json), "circuit.json"));
}

/// A resonance above a notch, a lag and a lead that turns the sign.
Sections mixed() {
  Sections out;
  out.sections.resize(3);
  out.sections[0] = {.gain = 1.0, .zeros = {{-40, 90}, {-40, -90}}, .poles = {{-20, 97}, {-20, -97}}};
  out.sections[1] = {.gain = 300.0, .zeros = {}, .poles = {-300.0}};
  out.sections[2] = {.gain = -1.5, .zeros = {300.0}, .poles = {-250.0}};
  return out;
}

TEST(CircuitFile, ReadBackItIsTheSameCircuit) {
  std::vector<std::pair<const char*, Sections>> cases = {
      {"opamp-rc", mixed()}, {"khn", mixed()}, {"tow-thomas", mixed()}};
  for (const char* ladder : {"opamp-rc", "foster1", "foster2", "cauer1", "cauer2"})
    cases.emplace_back(ladder, seed_sections());
  for (const auto& [how, sections] : cases) {
    SCOPED_TRACE(how);
    RealiseOptions options;
    options.realisation = how;
    options.limits = {1.0, 1e9, 1e-13, 1e-3};
    options.opamp.swing_v = 9.0;
    options.tolerances = {.resistor_percent = 0.25, .capacitor_percent = 2.5};
    options.opamp.dc_gain = 2e5;
    const Realised made = realise(sections, options);
    const Circuit& there = made.circuit;
    const CircuitFile back = read_back(file_of(made));
    EXPECT_EQ(back.band.from.value, made.report.band.from.value);
    EXPECT_EQ(back.band.to.value, made.report.band.to.value);
    ASSERT_EQ(back.circuit.parts.size(), there.parts.size());
    for (std::size_t i = 0; i < there.parts.size(); ++i) {
      const Part& a = back.circuit.parts[i];
      const Part& b = there.parts[i];
      EXPECT_EQ(std::tie(a.kind, a.name, a.group, a.from, a.to, a.series),
                std::tie(b.kind, b.name, b.group, b.from, b.to, b.series));
      EXPECT_NEAR(a.realised, b.realised, 1e-12 * b.realised);
      EXPECT_NEAR(a.wanted, b.wanted, 1e-12 * b.wanted);
    }
    ASSERT_EQ(back.circuit.opamps.size(), there.opamps.size());
    for (std::size_t i = 0; i < there.opamps.size(); ++i) {
      const schematic::OpAmp& a = back.circuit.opamps[i];
      const schematic::OpAmp& b = there.opamps[i];
      EXPECT_EQ(std::tie(a.name, a.group, a.plus, a.minus, a.out),
                std::tie(b.name, b.group, b.plus, b.minus, b.out));
    }
    EXPECT_EQ(back.circuit.opamp.swing_v, 9.0);
    EXPECT_EQ(back.circuit.tolerances.resistor_percent, 0.25);
    EXPECT_EQ(back.circuit.tolerances.capacitor_percent, 2.5);
    EXPECT_EQ(back.circuit.opamp.dc_gain, 2e5);
    ASSERT_EQ(back.circuit.stages.size(), there.stages.size());
    const std::vector<Hertz> grid = log_grid(made.report.band, 9);
    const std::vector<Complex> same = schematic::network_response(there, grid),
                               got = schematic::network_response(back.circuit, grid);
    for (std::size_t k = 0; k < grid.size(); ++k) {
      const RadPerSecond w = grid[k].rad_s();
      EXPECT_LT(std::abs(back.wanted(w) / sections.response(w) - 1.0), 1e-8);
      EXPECT_LT(std::abs(got[k] / same[k] - 1.0), 1e-10);
      for (std::size_t i = 0; i < there.stages.size(); ++i)
        EXPECT_LT(std::abs(back.circuit.stages[i].response(w) / there.stages[i].response(w) - 1.0), 1e-8);
    }
  }
}

// Parts, orders and gains by hand: what the stages say they make is held against their parts.
TEST(CircuitFile, APartThatWasChangedByHandIsRefused) {
  for (const char* how : {"opamp-rc", "foster1", "cauer2"}) {
    RealiseOptions options;
    options.realisation = how;
    options.limits = {1.0, 1e9, 1e-13, 1e-3};
    const Json json = file_of(realise(seed_sections(), options));
    EXPECT_NO_THROW(read_back(json));
    for (std::size_t s = 0; s < json["stages"].size(); ++s) {
      Json changed = json;
      Json& part = changed["stages"][s]["parts"].back();
      const char* const key = part.contains("realised_ohm") ? "realised_ohm" : "realised_f";
      part[key] = 1.1 * part[key].get<double>();
      EXPECT_THROW(read_back(changed), InputError) << how << " " << s;
    }
    for (const char* key : {"stages", "error"}) {
      Json less = json;
      less.erase(key);
      EXPECT_THROW(read_back(less), InputError) << key;
    }
    Json none = json;
    none["stages"] = Json::array();
    EXPECT_THROW(read_back(none), InputError);
    Json band = json;
    band["error"]["band_hz"] = {100.0, 10.0};
    EXPECT_THROW(read_back(band), InputError);
    band["error"]["band_hz"] = {0.0, 10.0};
    EXPECT_THROW(read_back(band), InputError);
  }
}

/// Greatest change of the magnitude in the band for 1 % of each part, by difference quotients.
TEST(CircuitFile, StatesWhatOnePercentOfAPartDoes) {
  const Realised made = realise(mixed());
  const Json json = to_json(made);
  const std::vector<Hertz> grid = log_grid(made.report.band, 61);
  const schematic::Assumptions ideal{.ideal_opamps = true};
  std::size_t i = 0;
  for (const Json& stage : json["stages"]) {
    for (const Json& part : stage["parts"]) {
      Circuit more = made.circuit, less = made.circuit;
      more.parts[i].realised *= 1.0 + 1e-5;
      less.parts[i].realised *= 1.0 - 1e-5;
      const auto up = schematic::network_response(more, grid, ideal),
                 down = schematic::network_response(less, grid, ideal);
      double most = 0.0;
      for (std::size_t k = 0; k < grid.size(); ++k)
        most = std::max(most, std::abs(20.0 * std::log10(std::abs(up[k] / down[k])) / 2e-3));
      EXPECT_NEAR(part["worst_db_per_percent"].get<double>(), most, 2e-3 * most + 1e-7) << part["part"];
      ++i;
    }
  }
  EXPECT_EQ(i, made.circuit.parts.size());
}

}  // namespace
}  // namespace bodesmith::synthesis
