#include "synthesis/realise.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "base/documents/document.hpp"
#include "base/error.hpp"
#include "kept_text.hpp"
#include "lti/sections.hpp"
#include "schematic/analysis/response.hpp"
#include "seed_sections.hpp"
#include "synthesis/stages/pairing.hpp"

namespace bodesmith::synthesis {
namespace {

using Complex = std::complex<double>;

std::vector<Complex> wanted_response(const Sections& sections, const std::vector<Hertz>& grid) {
  std::vector<Complex> out;
  for (const Hertz f : grid) out.push_back(sections.response(f.rad_s()));
  return out;
}

Section section_of(double gain, std::vector<Complex> zeros, std::vector<Complex> poles) {
  Section out;
  out.gain = gain;
  out.zeros = std::move(zeros);
  out.poles = std::move(poles);
  return out;
}

bool wanted_depth(const Section& section) {
  return !section.zeros.empty() && std::abs(section.zeros[0].real()) < 0.1 * std::abs(section.zeros[0]) &&
         section.zeros[0].imag() != 0.0;
}

/// The damping compensator, first seed eq. 20.
Sections damping() {
  Sections out;
  const Complex z(-0.5 * 9.854e4, std::sqrt(1.67e11 - 0.25 * 9.854e4 * 9.854e4));
  const Complex p(-0.5 * 1.917e5, std::sqrt(1.436e11 - 0.25 * 1.917e5 * 1.917e5));
  out.sections = {section_of(0.86, {z, std::conj(z)}, {p, std::conj(p)})};
  return out;
}

TEST(Realise, SeedSectionsWithE12CapacitorsAndE96ResistorsWithin20Millidecibel) {
  const RealiseOptions options;
  const Realised made = realise(seed_sections(), options);
  const auto grid = log_grid({Hertz{1}, Hertz{100}}, 400);
  const auto wanted = wanted_response(seed_sections(), grid);
  EXPECT_LE(compare_responses(grid, made.circuit.responses(grid), wanted).max_magnitude_db, 0.015);
  // Real op-amps and every stage loading the one before it.
  EXPECT_LE(compare_responses(grid, schematic::network_response(made.circuit, grid), wanted).max_magnitude_db,
            0.01);
  EXPECT_GT(made.report.nearest.max_magnitude_db, 3.0 * made.report.parts.max_magnitude_db)
      << "joint search saves nothing?";
  EXPECT_LT(made.report.highest_node_db, 6.0);
  EXPECT_GT(made.report.lowest_node_db, -6.0);
}

TEST(Realise, EveryPartIsInItsSeriesAndLimits) {
  const RealiseOptions options;
  const Realised made = realise(seed_sections(), options);
  for (const Part& part : made.circuit.parts) {
    if (part.name.starts_with("Rs_")) continue;  // isolates, about the op-amp's output resistance
    const bool resistor = part.kind == Part::Kind::resistor;
    EXPECT_EQ((resistor ? options.resistors : options.capacitors).nearest(part.realised), part.realised)
        << part.name;
    EXPECT_GE(part.realised, resistor ? options.limits.min_ohm : options.limits.min_f);
    EXPECT_LE(part.realised, resistor ? options.limits.max_ohm : options.limits.max_f);
    EXPECT_NEAR(part.wanted / part.realised, 1.0, resistor ? 0.06 : 0.06) << part.name;
  }
}

TEST(Realise, WantedValuesAreAnExactDesign) {
  for (const Sections& sections : {seed_sections(), damping()}) {
    RealiseOptions options;
    options.isolation_ohm = 0.0;
    Realised made = realise(sections, options);
    const auto grid = log_grid(made.report.band, 50);
    for (Part& part : made.circuit.parts) part.realised = part.wanted;
    const auto d =
        compare_responses(grid, schematic::network_response(made.circuit, grid, {.ideal_opamps = true}),
                          wanted_response(sections, grid));
    EXPECT_LT(d.max_complex_percent, 1e-8);
  }
}

TEST(Realise, ExactPartsAreExact) {
  RealiseOptions options;
  options.resistors = options.capacitors = Series::named("exact");
  for (const Sections& sections : {seed_sections(), damping()}) {
    EXPECT_LT(realise(sections, options).report.parts.max_complex_percent, 1e-9);
  }
}

// Every shape a section may have, either sign: closed-form transfer = nodal analysis, and the design is met.
TEST(Realise, AllShapesOfSections) {
  const std::vector<std::pair<const char*, Section>> shapes = {
      {"lowpass", section_of(100.0, {}, {-100.0})},
      {"lead", section_of(2.0, {-100.0}, {-300.0})},
      {"highpass", section_of(1.5, {0.0}, {-250.0})},
      {"all-pass", section_of(-1.0, {200.0}, {-200.0})},
      {"right zero", section_of(0.3, {90.0}, {-400.0})},
      {"resonant lowpass", section_of(1e4, {}, {{-20, 97}, {-20, -97}})},
      {"bandpass", section_of(40.0, {0.0}, {{-20, 97}, {-20, -97}})},
      {"one zero", section_of(100.0, {-50.0}, {{-20, 97}, {-20, -97}})},
      {"right zero, two poles", section_of(100.0, {50.0}, {{-20, 97}, {-20, -97}})},
      {"highpass 2", section_of(1.0, {0.0, 0.0}, {{-20, 97}, {-20, -97}})},
      {"notch", section_of(1.0, {{0, 100}, {0, -100}}, {{-20, 97}, {-20, -97}})},
      {"peak", section_of(1.0, {{-40, 90}, {-40, -90}}, {{-20, 97}, {-20, -97}})},
      {"dip", section_of(1.0, {{-4, 99}, {-4, -99}}, {{-20, 97}, {-20, -97}})},
      {"all-pass 2", section_of(1.0, {{20, 97}, {20, -97}}, {{-20, 97}, {-20, -97}})},
      {"complex zeros, real poles", section_of(1.0, {{-4, 99}, {-4, -99}}, {-50.0, -200.0})},
      {"real zeros, complex poles", section_of(1.0, {-10.0, -1000.0}, {{-20, 97}, {-20, -97}})},
  };
  std::string parts;
  for (const auto& [name, section] : shapes) {
    for (const double gain : {1.0, -0.5}) {
      Sections sections;
      sections.gain = gain;
      sections.sections = {section};
      RealiseOptions options;
      options.resistors = options.capacitors = Series::named("exact");
      const Realised exact = realise(sections, options);
      const auto grid = log_grid({Hertz{1.3}, Hertz{300}}, 30);
      const auto wanted = wanted_response(sections, grid);
      EXPECT_LT(compare_responses(grid, exact.circuit.responses(grid), wanted).max_complex_percent, 1e-8)
          << name;
      EXPECT_LT(compare_responses(
                    grid, schematic::network_response(exact.circuit, grid, {.ideal_opamps = true}), wanted)
                    .max_complex_percent,
                1e-8)
          << name;
      const Realised real = realise(sections);
      parts += fmt::format("{} {}:", name, gain);
      for (const schematic::Part& part : real.circuit.parts)
        parts += fmt::format(" {} {}-{} {:.4g}", part.name, part.from, part.to, part.realised);
      parts += "\n";
      // Zeros on or near the axis: decibels at the bottom of the dip say little.
      const double limit = std::string(name) == "notch" ? 40.0 : (wanted_depth(section) ? 0.4 : 0.15);
      EXPECT_LT(
          compare_responses(grid, schematic::network_response(real.circuit, grid, {.ideal_opamps = true}),
                            real.circuit.responses(grid))
              .max_complex_percent,
          1e-8)
          << name;
      EXPECT_LT(real.report.parts.max_magnitude_db, limit) << name << " " << gain;
    }
  }
  expect_kept("synthesis/kept_parts.txt", parts);
}

TEST(Realise, GainWithoutPoles) {
  for (const double gain : {3.0, -0.2, 1.0, -1.0}) {
    Sections sections;
    sections.gain = gain;
    const Realised made = realise(sections);
    EXPECT_NEAR(made.circuit.response({10.0}).real() / gain, 1.0, 0.003) << gain;
  }
}

TEST(Realise, RandomCascadesStayCloseToTheDesign) {
  std::mt19937_64 chance(7);
  std::uniform_real_distribution<double> log_w(std::log(30.0), std::log(3e4)), log_span(-0.8, 0.8);
  for (int trial = 0; trial < 12; ++trial) {
    Sections sections;
    const int n = 1 + trial;
    for (int i = 0; i < n; ++i) {
      const double z = std::exp(log_w(chance)), p = z * std::exp(log_span(chance));
      sections.sections.push_back(Section::pole_zero(1.0, {z}, {p}));
    }
    const Realised made = realise(sections);
    EXPECT_LT(made.report.parts.max_magnitude_db, n == 1 ? 0.1 : 0.05) << n << " sections";
    EXPECT_LT(made.report.opamps.max_magnitude_db, 0.5);  // 100 kHz, 10 MHz op-amps
  }
}

TEST(Realise, SaysWhatCannotBeMade) {
  Sections slow;
  slow.sections = {section_of(1e-7, {}, {-1e-7})};
  EXPECT_THROW(realise(slow), DesignError);
  Sections fine = seed_sections();
  RealiseOptions options;
  options.realisation = "no such";
  EXPECT_THROW(realise(fine, options), InputError);
  options = {};
  options.limits.max_ohm = 10.0;
  EXPECT_THROW(realise(fine, options), InputError);
}

TEST(Pairing, SortedNearestKeepsTheSpanSmall) {
  const Split split = split_into_stages(seed_sections());
  ASSERT_EQ(split.stages.size(), 8u);
  double worst = 0.0;
  for (const Section& s : split.stages) {
    worst = std::max(worst, std::abs(to_decibel(std::abs(s.zeros[0]) / std::abs(s.poles[0]))));
  }
  EXPECT_LE(worst, 4.9);
  Complex product = split.leading_gain;
  for (const Section& s : split.stages) product *= s.response(RadPerSecond{100.0});
  EXPECT_NEAR(std::abs(product / seed_sections().response(RadPerSecond{100.0}) - 1.0), 0.0, 1e-12);
}

// Least greatest span over all assignments, against trying every one of them.
TEST(Pairing, IsBestOverAllAssignments) {
  std::mt19937_64 chance(3);
  std::uniform_real_distribution<double> log_w(0.0, 5.0);
  for (int trial = 0; trial < 30; ++trial) {
    const size_t poles = 2 + static_cast<size_t>(trial % 4), zeros = 1 + static_cast<size_t>(trial) % poles;
    Sections sections;
    std::vector<double> z, p;
    for (size_t i = 0; i < poles; ++i) {
      p.push_back(std::exp(log_w(chance)));
      if (i < zeros) z.push_back(std::exp(log_w(chance)));
      sections.sections.push_back(
          section_of(1.0, i < zeros ? std::vector<Complex>{-z.back()} : std::vector<Complex>{}, {-p.back()}));
    }
    double best = 1e9;
    std::vector<size_t> order(poles);
    for (size_t i = 0; i < poles; ++i) order[i] = i;
    do {
      double span = 0.0;
      for (size_t i = 0; i < zeros; ++i) span = std::max(span, std::abs(std::log(z[i] / p[order[i]])));
      best = std::min(best, span);
    } while (std::next_permutation(order.begin(), order.end()));
    double got = 0.0;
    for (const Section& s : split_into_stages(sections).stages) {
      if (!s.zeros.empty())
        got = std::max(got, std::abs(std::log(std::abs(s.zeros[0]) / std::abs(s.poles[0]))));
    }
    EXPECT_NEAR(got, best, 1e-12);
  }
}

}  // namespace

namespace {

/// (1 + s/100)/s, times 50.
Sections pi_controller() {
  Sections out;
  Section one;
  one.gain = 0.5;
  one.zeros = {{-100.0, 0.0}};
  one.poles = {{0.0, 0.0}};
  out.sections = {one};
  return out;
}

TEST(Integrator, AnOpAmpWithRAndCInSeriesMakesIt) {
  for (const bool zero : {true, false}) {
    Sections wanted = pi_controller();
    if (!zero) wanted.sections[0].zeros.clear();
    if (!zero) wanted.sections[0].gain = 50.0;
    const Realised made = realise(wanted);
    for (const double hz : {0.5, 5.0, 50.0, 500.0}) {
      const RadPerSecond w = Hertz{hz}.rad_s();
      EXPECT_NEAR(std::abs(made.circuit.response(w) / wanted.response(w) - 1.0), 0.0, 0.02) << hz;
    }
    // With the op-amps' own equations too.
    const auto real = schematic::network_response(made.circuit, {Hertz{5.0}}).front();
    EXPECT_NEAR(std::abs(real / wanted.response(Hertz{5.0}.rad_s()) - 1.0), 0.0, 0.02);
  }
}

/// A PID of a slow loop has complex zeros over its pole at 0 and that of its derivative.
TEST(Integrator, TwoIntegratorsWithoutALoopMakeAPid) {
  Sections wanted;
  Section pid;
  pid.gain = 1.3;
  pid.zeros = {{-5.6, 41.8}, {-5.6, -41.8}};
  pid.poles = {{0.0, 0.0}, {-188.5, 0.0}};
  wanted.sections = {pid};
  const Realised made = realise(wanted);
  for (const double hz : {0.1, 1.0, 4.0, 20.0, 100.0}) {
    const RadPerSecond w = Hertz{hz}.rad_s();
    EXPECT_NEAR(std::abs(made.circuit.response(w) / wanted.response(w) - 1.0), 0.0, 0.05) << hz;
  }
  const auto real = schematic::network_response(made.circuit, {Hertz{20.0}}).front();
  EXPECT_NEAR(std::abs(real / wanted.response(Hertz{20.0}.rad_s()) - 1.0), 0.0, 0.05);
}

TEST(Integrator, SectionsMayHaveAPoleAtZeroAndNowhereElseOnTheAxis) {
  const auto sections = [](const std::string& poles) {
    return Sections::from_node(parse_json(
        R"({"schema":"bodesmith.sections/1","sections":[{"zeros_rad_s":[],"poles_rad_s":)" + poles + "}]}",
        "s.json"));
  };
  EXPECT_TRUE(integrates(sections("[[0,0]]")));
  EXPECT_TRUE(std::isinf(sections("[[0,0]]").dc_gain()));
  EXPECT_FALSE(integrates(sections("[[-1,0]]")));
  EXPECT_THROW(sections("[[1,0]]"), InputError);
  EXPECT_THROW(sections("[[0,5],[0,-5]]"), InputError);
}

}  // namespace

}  // namespace bodesmith::synthesis
