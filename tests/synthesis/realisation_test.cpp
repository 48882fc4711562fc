#include <gtest/gtest.h>

#include "base/error.hpp"
#include "schematic/analysis/response.hpp"
#include "synthesis/realisation.hpp"
#include "synthesis/realise.hpp"

namespace bodesmith::circuit {
namespace {

using Complex = std::complex<double>;

Section make(double gain, std::vector<Complex> zeros, std::vector<Complex> poles) {
  Section out;
  out.gain = gain;
  out.zeros = std::move(zeros);
  out.poles = std::move(poles);
  return out;
}

const std::vector<Complex> kResonant = {{-200, 970}, {-200, -970}};
const std::vector<Complex> kDamped = {{-800, 0}, {-1100, 0}};

const StageRealisation& stage_form(const std::string& name) {
  return *realisation_registry().get(name).stage_realisation();
}

struct Case {
  const char* realisation;
  Section section;
};

std::vector<Case> cases() {
  std::vector<Case> out;
  for (const auto& poles : {kResonant, kDamped}) {
    const double w2 = (poles[0] * poles[1]).real();
    for (const double gain : {0.4, 1.0, 2.5}) {
      out.push_back({"sallen-key", make(gain * w2, {}, poles)});
      out.push_back({"sallen-key", make(gain, {0.0, 0.0}, poles)});
      out.push_back({"multiple-feedback", make(gain * w2, {}, poles)});
      out.push_back({"multiple-feedback", make(gain, {0.0, 0.0}, poles)});
      out.push_back({"multiple-feedback", make(0.2 * gain * std::abs(poles[0]), {0.0}, poles)});
      for (const char* name : {"khn", "tow-thomas"}) {
        out.push_back({name, make(gain * w2, {}, poles)});
        out.push_back({name, make(gain * 900.0, {0.0}, poles)});
        out.push_back({name, make(gain, {-500.0, -2000.0}, poles)});
        out.push_back({name, make(gain, {{-400, 900}, {-400, -900}}, poles)});
        out.push_back({name, make(gain, {{200, 970}, {200, -970}}, poles)});
        out.push_back({name, make(gain * 900.0, {300.0}, poles)});
      }
    }
  }
  return out;
}

// Design equations, closed-form transfer and the circuit as drawn (nodal analysis with nullors) are three
// statements of one form: they must agree.
TEST(Forms, DesignTransferAndNetworkAgree) {
  const auto grid = log_grid({Hertz{10}, Hertz{3000}}, 25);
  for (const Case& one : cases()) {
    const StageRealisation& form = stage_form(one.realisation);
    ASSERT_FALSE(form.refusal(one.section)) << one.realisation;
    Sections sections;
    sections.sections = {one.section};
    RealiseOptions options;
    options.realisation = one.realisation;
    options.resistors = options.capacitors = Series::named("exact");
    const Realised exact = realise(sections, options);
    std::vector<Complex> wanted;
    for (const Hertz f : grid) wanted.push_back(sections.response(f.rad_s()));
    EXPECT_LT(compare_responses(grid, exact.circuit.responses(grid), wanted).max_complex_percent, 1e-8)
        << one.realisation << " gain " << one.section.gain;
    EXPECT_LT(compare_responses(
                  grid, schematic::network_response(exact.circuit, grid, {.ideal_opamps = true}), wanted)
                  .max_complex_percent,
              1e-8)
        << one.realisation << " gain " << one.section.gain;
    bool used = false;
    for (const Stage& stage : exact.circuit.stages) used = used || stage.realisation == one.realisation;
    EXPECT_TRUE(used);
  }
}

TEST(Forms, PreferredPartsStayClose) {
  const std::vector<Case> all = cases();
  constexpr std::size_t kEvery =
      5;  // a search each; prime to the number of cases of a gain: all forms, all gains
  for (std::size_t i = 0; i < all.size(); i += kEvery) {
    const Case& one = all[i];
    Sections sections;
    sections.sections = {one.section};
    RealiseOptions options;
    options.realisation = one.realisation;
    const Realised made = realise(sections, options);
    const auto grid = log_grid({Hertz{10}, Hertz{3000}}, 25);
    EXPECT_LT(compare_responses(grid, schematic::network_response(made.circuit, grid, {.ideal_opamps = true}),
                                made.circuit.responses(grid))
                  .max_complex_percent,
              1e-8)
        << one.realisation;
    EXPECT_LT(made.report.parts.max_complex_percent, 6.0) << one.realisation << " gain " << one.section.gain;
  }
}

TEST(Forms, RefusalsSayWhy) {
  EXPECT_TRUE(stage_form("sallen-key").refusal(make(1.0, {-5.0}, kResonant)));
  EXPECT_TRUE(stage_form("multiple-feedback").refusal(make(1.0, {-5.0}, kResonant)));
  EXPECT_TRUE(stage_form("multiple-feedback").refusal(make(1e5, {0.0}, kDamped)));
  EXPECT_TRUE(stage_form("khn").refusal(make(1.0, {}, {-5.0})));
  Sections sections;
  sections.sections = {make(1.0, {-5.0, -6.0}, kResonant)};
  RealiseOptions options;
  options.realisation = "sallen-key";
  EXPECT_THROW(realise(sections, options), DesignError);
}

}  // namespace
}  // namespace bodesmith::circuit
