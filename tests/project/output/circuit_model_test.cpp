// A circuit's model: its response, and what its capacitors and op-amps do to it, against the network's own equations.
#include "project/output/circuit_model.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <string>
#include <vector>

#include "base/documents/document.hpp"
#include "base/documents/json.hpp"
#include "chain/chain.hpp"
#include "chain/opamp_poles.hpp"
#include "schematic/analysis/response.hpp"
#include "synthesis/circuit_file.hpp"
#include "synthesis/realise.hpp"

namespace bodesmith::project {
namespace {

using Complex = std::complex<double>;

const std::vector<Hertz> kGrid = {Hertz{20.0},   Hertz{300.0},  Hertz{900.0},
                                  Hertz{1100.0}, Hertz{4000.0}, Hertz{3e4}};

struct Built {
  synthesis::Circuit circuit;
  chain::Chain model;
};

/// With ideal op-amps, beside its model.
Built built(const Section& section, const std::string& realisation = "opamp-rc",
            const synthesis::OpAmpModel& opamp = synthesis::OpAmpModel::ideal()) {
  Sections sections;
  sections.sections = {section};
  synthesis::RealiseOptions options;
  options.realisation = realisation;
  options.opamp = opamp;
  Json json = synthesis::to_json(synthesis::realise(sections, options));
  json["schema"] = "bodesmith.circuit/1";
  const Node node = parse_json(to_text(json), "circuit.json");
  const synthesis::Circuit circuit = synthesis::CircuitFile::from_node(node).circuit;
  return {circuit, {.blocks = circuit_blocks(circuit)}};
}

void expect_same(const std::vector<Complex>& wanted, const chain::Chain& model, double tolerance) {
  for (std::size_t i = 0; i < kGrid.size(); ++i)
    EXPECT_LT(std::abs(*model.response(kGrid[i].rad_s()) / wanted[i] - 1.0), tolerance)
        << kGrid[i].value << " Hz";
}

/// Poles of 1 kHz and a quality, and the zeros.
Section two_poles(double quality, std::vector<Complex> zeros, double gain) {
  const double w = Hertz{1000.0}.rad_s().value;
  const Complex pole = w * Complex(-0.5 / quality, std::sqrt(1.0 - 0.25 / (quality * quality)));
  return {gain, std::move(zeros), {pole, std::conj(pole)}};
}

std::vector<Section> sections() {
  const double w = Hertz{1000.0}.rad_s().value;
  return {two_poles(0.8, {}, w * w),
          two_poles(4.0, {}, -0.5 * w * w),
          two_poles(0.7, {0.0, 0.0}, 1.0),
          two_poles(1.5, {0.0}, w),
          {2.0, {-0.4 * w}, {-3.0 * w}},
          {w, {}, {-w}},
          {1.0, {0.0}, {-w}},
          {0.5 * w, {}, {0.0}},
          {2.0, {-0.3 * w}, {0.0}}};
}

TEST(CircuitModel, ACircuitsModelIsItsResponseAndFollowsItsCapacitors) {
  std::size_t capacitors = 0;
  for (const Section& section : sections()) {
    Built one = built(section);
    expect_same(schematic::network_response(one.circuit, kGrid), one.model, 1e-6);
    for (std::size_t b = 0; b < one.model.blocks.size(); ++b) {
      const chain::Block good = one.model.blocks[b];
      for (std::size_t k = 0; good.parts && k < good.parts->size(); ++k) {
        const chain::PartChange& part = (*good.parts)[k];
        if (!part.noise_gain.empty()) continue;
        SCOPED_TRACE(part.part + " " + good.type_name() + " of " + std::to_string(section.zeros.size()) +
                     " zeros, " + one.circuit.stages.back().realisation);
        ++capacitors;
        for (const double percent : {-20.0, 13.0}) {
          synthesis::Circuit off = one.circuit;
          for (synthesis::Part& p : off.parts) {
            if (p.name == part.part) p.realised *= 1.0 + percent / 100.0;
          }
          chain::Chain model = one.model;
          model.blocks[b] = good.with(part, percent);
          expect_same(schematic::network_response(off, kGrid), model, 1e-2);
        }
      }
    }
  }
  EXPECT_GE(capacitors, 11u);
}

Complex quadratic(const std::vector<double>& k, Complex s) {
  return k.empty() ? 0.0 : k[0] + s * (k[1] + s * k[2]);
}

/// (N + x F)/(P + x D) over N/P at s = j f/corner, x = j f (1/f_slow - 1/f_known).
Complex slowed(const chain::PartChange& opamp, Complex s, Complex p, Complex n, Complex x) {
  return (1.0 + x * quadratic(opamp.feedthrough, s) / n) / (1.0 + x * quadratic(opamp.noise_gain, s) / p);
}

TEST(CircuitModel, NoiseGainsAreThoseOfTheNetwork) {
  std::size_t opamps = 0;
  for (const Section& section : sections()) {
    Built one = built(section);
    for (const chain::Block& block : one.model.blocks) {
      if (!block.parts) continue;
      const bool two = block.has("damping_ratio");
      const std::string_view key = chain::corner_of(block);
      const double corner = key.empty() ? 1.0 : block.get(key);
      for (const chain::PartChange& part : *block.parts) {
        if (part.noise_gain.empty()) continue;
        SCOPED_TRACE(part.part + " " + block.type_name() + " of " + std::to_string(section.zeros.size()) +
                     " zeros, " + one.circuit.stages.back().realisation);
        ++opamps;
        synthesis::Circuit slow = one.circuit;
        slow.other_opamps = {synthesis::OpAmpModel::ideal()};
        slow.other_opamps[0].gain_bandwidth = Hertz{2e4};
        for (synthesis::OpAmp& opamp : slow.opamps) opamp.type = opamp.name == part.part ? 1 : 0;
        const auto wanted = schematic::network_response(slow, kGrid);
        for (std::size_t i = 0; i < kGrid.size(); ++i) {
          const Complex s(0.0, kGrid[i].value / corner);
          const Complex p = two           ? 1.0 + s * (2.0 * block.get("damping_ratio") + s)
                            : key.empty() ? 1.0
                                          : 1.0 + s;
          const Complex got =
              *one.model.response(kGrid[i].rad_s()) *
              slowed(part, s, p, p * *block.response(kGrid[i].rad_s()), Complex(0.0, kGrid[i].value / 2e4));
          EXPECT_LT(std::abs(got / wanted[i] - 1.0), 1e-5) << kGrid[i].value << " Hz";
        }
      }
    }
  }
  EXPECT_GE(opamps, 11u);
}

/// High-pass and band-pass outputs: integrators that something passes without.
TEST(CircuitModel, AnOpampWithAWayRoundItMovesZerosToo) {
  std::size_t opamps = 0;
  for (const char* realisation : {"khn", "tow-thomas"}) {
    for (const Section& section : sections()) {
      if (section.poles.size() != 2 || section.poles[1] == 0.0) continue;
      const Built one = built(section, realisation);
      for (std::size_t b = 0; b < one.model.blocks.size(); ++b) {
        const chain::Block& good = one.model.blocks[b];
        for (std::size_t k = 0; good.parts && k < good.parts->size(); ++k) {
          const chain::PartChange& part = (*good.parts)[k];
          if (part.feedthrough.empty()) continue;
          SCOPED_TRACE(part.part + " of " + realisation + ", " + std::to_string(section.zeros.size()) +
                       " zeros");
          ++opamps;
          for (const double hz : {2e4, 2e5}) {
            synthesis::Circuit slow = one.circuit;
            slow.other_opamps = {synthesis::OpAmpModel::ideal()};
            slow.other_opamps[0].gain_bandwidth = Hertz{hz};
            for (synthesis::OpAmp& opamp : slow.opamps) opamp.type = opamp.name == part.part ? 1 : 0;
            chain::Chain model = one.model;
            const chain::SlowSection now = chain::slow_section(good, part, 1.0 / hz);
            ASSERT_FALSE(now.section.validate() || now.behind.validate());
            model.blocks[b] = now.section;
            model.blocks.insert(model.blocks.begin() + static_cast<std::ptrdiff_t>(b) + 1, now.behind);
            expect_same(schematic::network_response(slow, kGrid), model, 1e-5);
          }
        }
      }
    }
  }
  EXPECT_GE(opamps, 4u);
}

synthesis::OpAmpModel of_bandwidth(Hertz gain_bandwidth, double output_resistance_ohm = 0.0) {
  synthesis::OpAmpModel opamp;
  opamp.gain_bandwidth = gain_bandwidth;
  opamp.output_resistance_ohm = output_resistance_ohm;
  opamp.dc_gain = 1e9;
  return opamp;
}

/// The op-amps move a section's corner, by a tenth where a small resistor makes it a pole of some MHz: noise gains are told over
/// the corner that stands in the model.
TEST(CircuitModel, NoiseGainsHoldWhateverTheSpeedOfTheOpamps) {
  constexpr double kFast = 1e7, kSlow = 6e3, kOutput = 50.0;
  std::size_t opamps = 0;
  std::vector<Section> all = sections();
  all.push_back({-0.68, {-988.0}, {-469.0}});
  for (const Section& section : all) {
    if (section.poles[0] == 0.0) continue;
    const Built one = built(section, "opamp-rc", of_bandwidth(Hertz{kFast}, kOutput));
    for (const chain::Block& block : one.model.blocks) {
      if (!block.parts || chain::corner_of(block).empty()) continue;
      const double corner = block.get(chain::corner_of(block));
      for (const chain::PartChange& part : *block.parts) {
        if (part.noise_gain.empty()) continue;
        ++opamps;
        synthesis::Circuit slow = one.circuit;
        slow.other_opamps = {of_bandwidth(Hertz{kSlow}, kOutput)};
        for (synthesis::OpAmp& opamp : slow.opamps) opamp.type = opamp.name == part.part ? 1 : 0;
        const auto wanted = schematic::network_response(slow, kGrid);
        for (std::size_t i = 0; i < 4; ++i) {
          const Complex s(0.0, kGrid[i].value / corner);
          const Complex p =
              block.has("damping_ratio") ? 1.0 + s * (2.0 * block.get("damping_ratio") + s) : 1.0 + s;
          const Complex got = *one.model.response(kGrid[i].rad_s()) *
                              slowed(part, s, p, p * *block.response(kGrid[i].rad_s()),
                                     Complex(0.0, kGrid[i].value * (1.0 / kSlow - 1.0 / kFast)));
          EXPECT_LT(std::abs(got / wanted[i] - 1.0), 0.01)
              << part.part << " of " << section.zeros.size() << " zeros and " << section.poles.size()
              << " poles, " << kGrid[i].value << " Hz";
        }
      }
    }
  }
  EXPECT_GE(opamps, 5u);
}

TEST(CircuitModel, HasTheSpeedOfItsOpamps) {
  const synthesis::OpAmpModel opamp = of_bandwidth(Hertz{1e6});
  for (const Section& section : sections()) {
    if (section.poles[0] == 0.0) continue;  // an integrator's stays ideal
    const Built one = built(section, "opamp-rc", opamp);
    const auto wanted = schematic::network_response(one.circuit, kGrid);
    for (std::size_t i = 0; i + 1 < kGrid.size(); ++i)
      EXPECT_LT(std::abs(*one.model.response(kGrid[i].rad_s()) / wanted[i] - 1.0), 1e-3)
          << section.zeros.size() << " of " << section.poles.size() << ", " << kGrid[i].value << " Hz";
  }
}

TEST(CircuitModel, InvertersAndLaddersAreBlocks) {
  const double w = Hertz{1000.0}.rad_s().value;
  const Built ladder = built({1.0, {-0.2 * w, -2.0 * w}, {-0.5 * w, -5.0 * w}}, "foster1");
  expect_same(schematic::network_response(ladder.circuit, kGrid), ladder.model, 1e-6);
  for (const chain::Block& block : ladder.model.blocks)
    EXPECT_EQ(block.parts != nullptr, block.type_name() == "gain");
}

}  // namespace
}  // namespace bodesmith::project
