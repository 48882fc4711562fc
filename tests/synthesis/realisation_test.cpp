#include "synthesis/realisation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <set>

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
  bool makes_two_poles() const override { return false; }
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

/// Every kind of section that a form may be asked for: those above, and gains, single poles, poles and zeros at 0.
std::vector<Section> all_sections() {
  std::vector<Section> out;
  for (const Case& one : cases()) out.push_back(one.section);
  for (const double gain : {0.3, 1.0, 4.0}) {
    out.push_back(make(gain, {}, {}));
    for (const double zero : {-50.0, -3000.0, 0.0, 400.0}) {
      out.push_back(make(gain, {zero}, {-700.0}));
      out.push_back(make(gain, {zero}, {0.0}));
    }
    out.push_back(make(700.0 * gain, {}, {-700.0}));
    out.push_back(make(700.0 * gain, {}, {0.0}));
    out.push_back(make(1e5 * gain, {}, {0.0, -300.0}));
    out.push_back(make(1e3 * gain, {-20.0}, {0.0, -300.0}));
    out.push_back(make(gain, {-20.0, -60.0}, {0.0, -300.0}));
  }
  return out;
}

/// The stage's parts and op-amps with these values.
schematic::Netlist drawn(const StageForm& form, const std::vector<double>& values) {
  schematic::Netlist out;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const StagePart& one = form.parts()[i];
    out.parts.push_back({one.kind, one.name, "", 0, one.from, one.to, "exact", values[i], values[i]});
  }
  for (const StageOpAmp& one : form.opamps())
    out.opamps.push_back({one.name, "", 0, one.plus, one.minus, one.out});
  return out;
}

// Design equations, closed-form transfer and the circuit as drawn (nodal analysis with nullors) are three
// statements of one form: they must agree, whatever the capacitors and whatever the parts then are.
TEST(Forms, DesignTransferAndNetworkAgree) {
  const RadPerSecond grid[] = {{3.0}, {90.0}, {700.0}, {1100.0}, {20e3}};
  std::set<std::string> made;
  for (const Realisation* realisation : realisation_registry().all()) {
    const StageRealisation* form = realisation->stage_realisation();
    if (form == nullptr) continue;
    for (const Section& section : all_sections()) {
      // Two poles of which one is at 0 are two stages.
      if (form->refusal(section) || (section.poles.size() > 1 && integrates(section))) continue;
      int designed = 0;
      for (const double isolation : {0.0, 40.0}) {
        const std::unique_ptr<StageForm> stage = form->make(section, {isolation});
        SCOPED_TRACE(std::string(form->name()) + " gain " + std::to_string(section.gain) + " isolation " +
                     std::to_string(isolation));
        EXPECT_EQ(
            (stage->wanted().response(grid[1]) / section.response(Complex(0.0, grid[1].value))).real() < 0.0,
            form->inverts());
        for (const double level : {1.0, 0.6, 1.7}) {
          std::vector<double> c;
          for (const CapacitorChoice& choice : stage->capacitor_choices()) {
            const double base = c.empty() ? level / (20e3 * choice.works_at.value)
                                          : c.front() / stage->capacitor_choices()[0].ratio;
            c.push_back(base * choice.ratio * (c.empty() ? 1.0 : std::pow(level, 0.1)));
          }
          const auto values = stage->design(c);
          if (!values) continue;
          ++designed;
          ASSERT_EQ(values->size(), stage->parts().size());
          EXPECT_EQ(stage->capacitors(*values), c);
          // Capacitors that work against 20 kohm leave every resistor between 150 ohm and 10 Mohm.
          for (std::size_t k = 0; k < values->size(); ++k) {
            if (stage->parts()[k].kind != Part::Kind::resistor || stage->parts()[k].fixed) continue;
            EXPECT_GT((*values)[k], 150.0) << stage->parts()[k].name;
            EXPECT_LT((*values)[k], 1e7) << stage->parts()[k].name;
          }
          // Poles and zeros are those wanted; the gain may follow the capacitors, but is one number.
          const Complex gain = stage->aim(*values).response(grid[0]) / stage->wanted().response(grid[0]);
          EXPECT_LT(std::abs(gain.imag()), 1e-9 * std::abs(gain));
          std::vector<double> off = *values;
          for (std::size_t k = 0; k < off.size(); ++k)
            off[k] *= 1.0 + 0.2 * std::sin(3.0 * static_cast<double>(k) + level);
          const schematic::Netlist netlist = drawn(*stage, off);
          const schematic::Equations network(netlist, {.ideal_opamps = true});
          const auto exact = stage->exact_near(*values);
          for (const RadPerSecond w : grid) {
            const Complex wanted = stage->wanted().response(w);
            EXPECT_LT(std::abs(stage->aim(*values).response(w) / (gain * wanted) - 1.0), 1e-9);
            EXPECT_LT(std::abs(stage->transfer(off).response(w) / network.response(w) - 1.0), 1e-9);
            if (exact) {
              EXPECT_LT(std::abs(stage->aim(*exact).response(w) / wanted - 1.0), 1e-9);
            }
          }
          made.insert(std::string(form->name()) + (exact ? "" : " without exact values"));
        }
      }
      EXPECT_GT(designed, 0) << form->name() << " gain " << section.gain << " zeros " << section.zeros.size();
    }
  }
  for (const char* name : {"first-order", "first-order-trimmed", "first-order-right-zero", "sallen-key",
                           "multiple-feedback", "khn", "tow-thomas", "inverter"})
    EXPECT_TRUE(made.contains(name)) << name;
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

// (An inverter makes none, and is asked for none.)
TEST(Realisations, ThatMakeTwoPolesTakeSomePairAndOthersNone) {
  const std::vector<std::vector<Complex>> zeros = {
      {}, {0.0}, {0.0, 0.0}, {{0.0, 3e3}, {0.0, -3e3}}, {-2e3, -4e3}};
  for (const Realisation* one : realisation_registry().all()) {
    const auto* stage = dynamic_cast<const StageRealisation*>(one);
    if (stage == nullptr || one->name() == "inverter") continue;
    bool takes = false;
    for (const auto& at : zeros) {
      for (const std::vector<Complex>& poles :
           {std::vector<Complex>{{-5e2, 2e3}, {-5e2, -2e3}}, {-1e3, -3e3}})
        takes = takes || !stage->refusal({1.0, at, poles});
    }
    EXPECT_EQ(takes, stage->makes_two_poles()) << one->name();
  }
}

}  // namespace

}  // namespace bodesmith::synthesis
