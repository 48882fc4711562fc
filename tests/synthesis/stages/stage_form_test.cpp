// A realisation from outside the library: one class and one line that registers it.
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "schematic/analysis/response.hpp"
#include "synthesis/realisation.hpp"

namespace bodesmith::circuit {
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
  std::string_view description() const override { return "a gain above 1"; }
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
  std::string_view description() const override { return "a stage for the constant 3"; }
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
}  // namespace bodesmith::circuit
