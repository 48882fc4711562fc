#include "synthesis/realisation.hpp"

#include <gtest/gtest.h>

#include "base/error.hpp"
#include "schematic/analysis/response.hpp"
#include "synthesis/realise.hpp"

namespace bodesmith::synthesis {
namespace {

/// H = 1 + R2/R1: a gain that is not inverted.
class NonInverting final : public StageForm {
 public:
  explicit NonInverting(const Section& section) {
    wanted_ = Biquad::from_section(section);
    resistor("R1", "m", "0");
    resistor("R2", "m", "out");
    opamp("U1", "in", "m", "out");
  }
  Biquad transfer(std::span<const double> v) const override {
    Biquad h;
    h.b0 = 1.0 + v[1] / v[0];
    return h;
  }
  std::optional<std::vector<double>> design(std::span<const double>) const override {
    return std::vector<double>{10e3, 10e3 * (wanted_.b0 - 1.0)};
  }
};

class NonInvertingRealisation final : public StageRealisation {
 public:
  std::string_view name() const override { return "non-inverting"; }
  bool inverts() const override { return false; }
  int bid(const Section& section) const override { return refusal(section) ? 0 : 5; }
  std::optional<Refusal> refusal(const Section& section) const override {
    if (!section.poles.empty()) return Refusal{"it makes a gain only"};
    if (section.gain < 1.5) return Refusal{"it makes a gain above 1.5"};
    return std::nullopt;
  }
  std::unique_ptr<StageForm> make(const Section& section, const FormOptions&) const override {
    return std::make_unique<NonInverting>(section);
  }
};

/// Ends in one stage whatever is asked for.
class OneStage final : public Realisation {
 public:
  std::string_view name() const override { return "one-stage"; }
  Outcome<Realised> design(const Sections& sections, const RealiseOptions& options) const override {
    if (!sections.sections.empty()) return Refusal{"it makes a constant"};
    RealiseOptions plain = options;
    plain.realisation = "opamp-rc";
    return try_realise(sections, plain);
  }
};

TEST(OwnRealisation, IsChosenDesignedAndSolved) {
  static const NonInvertingRealisation stage;
  static const OneStage whole;
  realisation_registry().add(stage);
  realisation_registry().add(whole);

  Section constant;
  constant.gain = 3.0;
  const auto best = best_form(constant);
  EXPECT_EQ(std::get<const StageRealisation*>(best), &stage);

  Section lag;
  lag.gain = 100.0;
  lag.poles = {-100.0};
  Sections sections;
  sections.sections = {lag};
  RealiseOptions options;
  options.realisation = "non-inverting";
  options.resistors = options.capacitors = Series::named("exact");
  // What it cannot make is made by others: one pole beside it.
  const Realised made = realise(sections, options);
  EXPECT_LT(made.report.parts.max_complex_percent, 1e-6);

  options.realisation = "one-stage";
  Sections gain;
  gain.gain = 3.0;
  const Realised alone = realise(gain, options);
  const Hertz f{100.0};
  EXPECT_NEAR(schematic::network_response(alone.circuit, {f}, {.ideal_opamps = true}).front().real(), 3.0,
              1e-9);
  EXPECT_THROW(realise(sections, options), DesignError);
  EXPECT_EQ(std::get<Refusal>(try_realise(sections, options)).reason, "it makes a constant");
}

}  // namespace

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

}  // namespace bodesmith::synthesis
