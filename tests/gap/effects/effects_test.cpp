// Laws of all effects' proposals: they are in the units of the record, and one of their starts is near what is missing.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "gap/effect.hpp"
#include "gap/made_model.hpp"
#include "gap/made_record.hpp"
#include "gap/made_response.hpp"
#include "gap/runner.hpp"
#include "gap/scene.hpp"
#include "gap/search_options.hpp"
#include "kept_text.hpp"
#include "signal/statistics.hpp"

namespace effects_of {
namespace {

using namespace bodesmith;

/// Factors of signals and of time; powers of two, so that nothing is rounded otherwise.
struct Units {
  double signal = 1.0;
  double time = 1.0;
  double of(double signal_power, double time_power) const {
    return std::pow(signal, signal_power) * std::pow(time, time_power);
  }
  /// Of a parameter, or an unknown, by its unit or else by its name.
  double of(const std::string& name, const std::string& unit) const {
    const auto bracket = name.find('[');
    const double index = bracket == std::string::npos ? 0.0 : std::stod(name.substr(bracket + 1));
    if (name.starts_with("coefficients[")) return of(1.0 - index, 0.0);
    if (name.starts_with("ascending[") || name.starts_with("descending[")) return of(-index, 0.0);
    if (name.starts_with("constant_") || unit == "u" || unit == "y" || unit == "V") return of(1.0, 0.0);
    if (unit == "Hz" || name.ends_with("_hz")) return of(0.0, -1.0);
    if (unit == "s" || name == "fastest_s" || name == "slowest_s") return of(0.0, 1.0);
    if (unit == "y/s") return of(1.0, -1.0);
    if (unit == "1/y") return of(-1.0, 0.0);
    if (unit == "1/y²") return of(-2.0, 0.0);
    if (unit == "s/y") return of(-1.0, 1.0);
    return 1.0;
  }
};

chain::Chain in_units(chain::Chain chain, const Units& units) {
  for (auto& block : chain.blocks) {
    for (auto& p : block.parameters()) p.value *= units.of(p.name(), p.unit());
  }
  return chain;
}

TimeRecord in_units(TimeRecord record, const Units& units) {
  record.step_s *= units.time;
  for (double& v : record.u) v *= units.signal;
  for (double& v : record.y) v *= units.signal;
  return record;
}

/// Every kind of block that an effect changes.
const char* const kEveryPlace = R"(
[[block]]
type = "gain"
gain = 2.0
offset = 0.125
[[block]]
type = "resonator"
natural_frequency_hz = 90.0
damping_ratio = 0.2
[[block]]
type = "biquad"
lowpass_gain = 1.0
bandpass_gain = 0.3
natural_frequency_hz = 150.0
damping_ratio = 0.4
[[block]]
type = "pole_zero"
gain = 1.25
zero_hz = 40.0
pole_hz = 160.0
[[block]]
type = "polynomial_hysteresis"
ascending = [-0.0625, 0.03125, 0.015625]
descending = [0.0625, -0.03125, 0.0078125]
[[block]]
type = "multiplier"
scale_v = 8.0
)";

/// Two slow sines and white noise.
std::vector<double> drive(int samples, double slow = 1.0) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  auto u = two_sines(samples, slow, 4.0);
  for (double& v : u) v += 0.1 * normal(random);
  return u;
}

std::vector<gap::Proposal> proposals_of(const gap::Effect& effect, const gap::Scene& scene) {
  std::vector<gap::Proposal> all;
  effect.propose(scene, all);
  return all;
}

std::vector<double> output_of(const gap::Model& model, const TimeRecord& record) {
  simulate::RecordSimulator simulator(model.chain(), record.step_s);
  const auto y = simulator.run(record.u);
  return {y.begin(), y.end()};
}

void set_term(gap::Model& model, const std::vector<double>& start) {
  auto values = model.values();
  std::copy(start.begin(), start.end(), values.end() - static_cast<std::ptrdiff_t>(start.size()));
  model.set_values(values);
}

void expect_scaled(double scaled, double value, double factor, const std::string& what) {
  if (std::isinf(value)) {
    EXPECT_EQ(scaled, value) << what;
  } else {
    EXPECT_NEAR(scaled, factor * value, 1e-9 * std::abs(factor * value)) << what;
  }
}

void expect_same_proposals(const std::vector<gap::Proposal>& in_one,
                           const std::vector<gap::Proposal>& in_other, const Units& units,
                           const std::string& name) {
  ASSERT_EQ(in_one.size(), in_other.size()) << name;
  for (std::size_t i = 0; i < in_one.size(); ++i) {
    const gap::Term& one = in_one[i].model.terms().back();
    const gap::Term& other = in_other[i].model.terms().back();
    EXPECT_EQ(one.placed, other.placed);
    ASSERT_EQ(one.unknowns.size(), other.unknowns.size());
    ASSERT_EQ(in_one[i].starts.size(), in_other[i].starts.size()) << name;
    for (std::size_t k = 0; k < one.unknowns.size(); ++k) {
      const gap::Unknown& u = one.unknowns[k];
      const gap::Unknown& v = other.unknowns[k];
      // Errors of the multipliers that make powers are named as those of one multiplier, for signals of any size.
      const bool of_powers = name == "multiplier_error" && u.parameter.empty();
      const double factor = !of_powers                ? units.of(u.name, u.unit)
                            : u.name == "feedthrough" ? units.of(1.0, 0.0)
                            : u.name == "offset"      ? units.of(2.0, 0.0)
                                                      : 1.0;
      const std::string what = name + " " + one.placed + " " + u.name;
      expect_scaled(v.low, u.low, factor, what + " low");
      expect_scaled(v.high, u.high, factor, what + " high");
      expect_scaled(v.hop, u.hop, factor, what + " hop");
      if (!u.logarithmic) expect_scaled(v.scale, u.scale, factor, what + " scale");
      EXPECT_LT(u.low, u.high) << what;
      for (std::size_t s = 0; s < in_one[i].starts.size(); ++s) {
        const double start = in_one[i].starts[s][k];
        expect_scaled(in_other[i].starts[s][k], start, factor, what + " start");
        EXPECT_GE(start, u.low) << what;
        EXPECT_LE(start, u.high) << what;
      }
    }
  }
}

TEST(Effects, ProposeInTheUnitsOfTheRecord) {
  const auto base = model_of(kEveryPlace);
  const TimeRecord record = measured(std::string(kEveryPlace) +
                                         "[[block]]\ntype = \"dead_zone\"\nwidth = 0.02\n"
                                         "[[block]]\ntype = \"delay\"\ndelay_s = 0.004\n",
                                     drive(600), 1e-3, 0.0, 1);
  const gap::Model model(base);
  const auto scene = gap::make_scene(model, {gap::TimeExperiment(record)});
  for (const Units units : {Units{.signal = 16.0}, Units{.time = 0.125}}) {
    const gap::Model other(in_units(base, units));
    const TimeRecord scaled = in_units(record, units);
    const auto other_scene = gap::make_scene(other, {gap::TimeExperiment(scaled)});
    EXPECT_NEAR(other_scene.band_hz, units.of(0.0, -1.0) * scene.band_hz, 1e-9 * other_scene.band_hz);
    int proposing = 0;
    for (const gap::Effect* effect : gap::effect_registry().all()) {
      const std::string name(effect->name());
      if (name == "mains_hum" && units.time != 1.0) continue;  // the grid's frequency is what it is
      auto one = proposals_of(*effect, scene);
      auto in_other = proposals_of(*effect, other_scene);
      expect_same_proposals(one, in_other, units, name);
      if (testing::Test::HasFatalFailure()) return;
      proposing += one.empty() ? 0 : 1;
      // A multiplier's feedthrough is added to powers of any degree: it has no unit.
      for (std::size_t i = 0; i < one.size() && (name != "multiplier_error" || units.signal == 1.0); ++i) {
        set_term(one[i].model, one[i].starts.back());
        set_term(in_other[i].model, in_other[i].starts.back());
        const auto y = output_of(one[i].model, record);
        const auto scaled_y = output_of(in_other[i].model, scaled);
        double most = 0.0;
        double off = 0.0;
        for (std::size_t k = 0; k < y.size(); ++k) {
          most = std::max(most, std::abs(units.signal * y[k]));
          off = std::max(off, std::abs(scaled_y[k] - units.signal * y[k]));
        }
        EXPECT_LT(off, 1e-6 * most) << name << " " << one[i].model.terms().back().placed;
      }
    }
    EXPECT_GE(proposing, 20);
  }
}

/// Terms, the ranges and starts of their unknowns, and what the last start makes of the record, at three digits.
std::string said_of(const gap::Effect& effect, std::vector<gap::Proposal> proposals,
                    const TimeRecord* record) {
  std::string out;
  for (gap::Proposal& one : proposals) {
    out += fmt::format("{} {}:", effect.name(), one.model.terms().back().placed);
    for (const gap::Unknown& u : one.model.terms().back().unknowns)
      out += fmt::format(" {} {:.3g} to {:.3g}, {} {:.3g} {:.3g};", u.name, u.low, u.high,
                         u.logarithmic ? "log" : "by", u.scale, u.hop);
    for (const auto& start : one.starts) {
      for (const double value : start) out += fmt::format(" {:.3g}", value + 0.0);
      out += ";";
    }
    set_term(one.model, one.starts.back());
    if (record == nullptr) {
      const auto h = one.model.chain().response(Hertz{70.0}.rad_s());
      out += h ? fmt::format(" {:.3g} {:.3g}", h->real(), h->imag()) : " no response";
    } else {
      const auto y = output_of(one.model, *record);
      for (const std::size_t k : {1U, 77U, 300U, 599U}) out += fmt::format(" {:.3g}", y[k] + 0.0);
    }
    out += "\n";
  }
  return out;
}

TEST(Effects, ProposeWhatWasKept) {
  const TimeRecord record = measured(
      std::string(kEveryPlace) + "[[block]]\ntype = \"dead_zone\"\nwidth = 0.02\n", drive(600), 1e-3, 0.0, 1);
  const gap::Model model(model_of(kEveryPlace));
  const auto scene = gap::make_scene(model, {gap::TimeExperiment(record)});
  const gap::Model small(
      model_of("[[block]]\ntype = \"gain\"\ngain = 2.0\n[[block]]\ntype = \"pole_zero\"\ngain = 1.25\n"
               "zero_hz = 40.0\npole_hz = 160.0\n"));
  const auto of_response = gap::make_scene(
      small, {gap::FrequencyExperiment(made::measured(
                 [](double hz) { return (2.0 + 0.5 * made::mode(hz, 80.0, 0.03)) * made::lag(hz, 300.0); },
                 8.0, 512.0, 49, [](double) { return 0.003; }, 3))});
  std::string all = fmt::format("{:.4g} to {:.4g} Hz, peaks at {:.4g}\n", scene.low_hz, scene.band_hz,
                                fmt::join(scene.residual_peaks_hz, " "));
  for (const gap::Effect* effect : gap::effect_registry().all()) {
    all += said_of(*effect, proposals_of(*effect, scene), &record);
    if (effect->facts().linear) all += said_of(*effect, proposals_of(*effect, of_response), nullptr);
  }
  expect_kept("gap/effects/kept_proposals.txt", all);
}

TEST(Effects, ProposeInTheUnitsOfTheResponse) {
  const auto base = model_of(
      "[[block]]\ntype = \"gain\"\ngain = 2.0\n[[block]]\ntype = \"pole_zero\"\ngain = 1.25\n"
      "zero_hz = 40.0\npole_hz = 160.0\n");
  const auto response = [](double time) {
    return made::measured(
        [time](double hz) {
          return (2.0 + 0.5 * made::mode(hz * time, 80.0, 0.03)) * made::lag(hz * time, 300.0);
        },
        8.0 / time, 512.0 / time, 49, [](double) { return 0.003; }, 3);
  };
  const Units units{.time = 0.125};
  const gap::Model model(base);
  const gap::Model other(in_units(base, units));
  const auto scene = gap::make_scene(model, {gap::FrequencyExperiment(response(1.0))});
  const auto other_scene = gap::make_scene(other, {gap::FrequencyExperiment(response(units.time))});
  int proposing = 0;
  for (const gap::Effect* effect : gap::effect_registry().all()) {
    if (!effect->facts().linear) continue;
    auto one = proposals_of(*effect, scene);
    auto in_other = proposals_of(*effect, other_scene);
    expect_same_proposals(one, in_other, units, std::string(effect->name()));
    if (testing::Test::HasFatalFailure()) return;
    proposing += one.empty() ? 0 : 1;
    for (std::size_t i = 0; i < one.size(); ++i) {
      set_term(one[i].model, one[i].starts.back());
      set_term(in_other[i].model, in_other[i].starts.back());
      const auto h = one[i].model.chain().response(Hertz{70.0}.rad_s());
      const auto scaled = in_other[i].model.chain().response(Hertz{70.0 / units.time}.rad_s());
      ASSERT_TRUE(h && scaled) << effect->name();
      EXPECT_LT(std::abs(*scaled - *h), 1e-9 * std::abs(*h)) << effect->name();
    }
  }
  EXPECT_GE(proposing, 9);
}

/// What an effect is to see, and how much of the residual the best of its starts may leave.
struct Missing {
  const char* effect;
  const char* truth;  ///< behind a gain of 2
  double left;
  double slow = 1.0;  ///< size of the drive's sines
};

class MissingEffect : public testing::TestWithParam<Missing> {};

/// rms of what the best start of any proposal leaves over that of the residual.
double left_by_best_start(const gap::Effect& effect, const gap::Scene& scene, const TimeRecord& record) {
  double best = 1.0;
  for (auto& proposal : proposals_of(effect, scene)) {
    for (const auto& start : proposal.starts) {
      set_term(proposal.model, start);
      auto off = output_of(proposal.model, record);
      for (std::size_t i = 0; i < off.size(); ++i) off[i] -= record.y[i];
      best = std::min(best, rms(off) / rms(scene.residual));
    }
  }
  return best;
}

TEST_P(MissingEffect, IsNearOneOfTheStarts) {
  const std::string base = "[[block]]\ntype = \"gain\"\ngain = 2.0\n";
  const TimeRecord record = measured(base + GetParam().truth, drive(1500, GetParam().slow), 1e-3, 0.0, 1);
  const gap::Model model(model_of(base));
  const auto scene = gap::make_scene(model, {gap::TimeExperiment(record)});
  EXPECT_LT(left_by_best_start(gap::effect_registry().get(GetParam().effect), scene, record),
            GetParam().left);
}

INSTANTIATE_TEST_SUITE_P(
    OfTime, MissingEffect,
    testing::Values(
        Missing{"amplifier_pole", "[[block]]\ntype = \"lowpass\"\ncorner_hz = 60.0\n", 0.1},
        Missing{"backlash", "[[block]]\ntype = \"backlash\"\nwidth = 0.2\n", 0.03},
        Missing{"dead_zone", "[[block]]\ntype = \"dead_zone\"\nwidth = 0.2\n", 0.02},
        Missing{"drift", "[[block]]\ntype = \"drift\"\nrate_per_s = 0.02\n", 0.12},
        Missing{"offset", "[[block]]\ntype = \"gain\"\ngain = 1.0\noffset = 0.03\n", 0.12},
        Missing{"gain_error", "[[block]]\ntype = \"gain\"\ngain = 1.03\n", 0.7},
        Missing{"time_delay", "[[block]]\ntype = \"delay\"\ndelay_s = 0.0025\n", 0.55},
        Missing{"saturation", "[[block]]\ntype = \"saturation\"\nlower = -2.6\nupper = 2.2\n", 0.45},
        Missing{"slew_limit", "[[block]]\ntype = \"slew_limit\"\nrate_per_s = 120.0\n", 0.01},
        Missing{"resonance",
                "[[block]]\ntype = \"resonator\"\nnatural_frequency_hz = 130.0\ndamping_ratio = 0.05\n",
                0.01},
        Missing{"parallel_mode",
                "[[block]]\ntype = \"parallel_modes\"\ngains = [-0.2]\nnatural_frequencies_hz = [50.0]\n"
                "damping_ratios = [0.02]\n",
                0.01, 0.0},
        Missing{"quadratic_nonlinearity",
                "[[block]]\ntype = \"polynomial\"\ncoefficients = [0.0, 1.0, 0.003]\n", 0.55},
        Missing{"cubic_nonlinearity",
                "[[block]]\ntype = \"polynomial\"\ncoefficients = [0.0, 1.0, 0.0, 0.001]\n", 0.6},
        Missing{"sample_hold", "[[block]]\ntype = \"sample_hold\"\nclock_hz = 237.0\nhalf_cycle = false\n",
                0.01},
        Missing{"creep", "[[block]]\ntype = \"creep\"\ngains = [0.02]\ntime_constants_s = [0.3]\n", 0.3},
        Missing{"rate_dependence",
                "[[block]]\ntype = \"fractional_lead_lag\"\nlambda_s = 0.05\nx = 0.05\nbeta = -0.06\n", 0.3},
        Missing{"hysteresis",
                "[[block]]\ntype = \"prandtl_ishlinskii\"\nr = [0.0, 0.4, 1.2]\nw = [1.0, 0.02, 0.03]\n",
                0.5}),
    [](const auto& case_) { return std::string(case_.param.effect); });

/// A term of an effect with these values, behind a gain of 2 in a record of 600 samples of 1 ms or in a response.
struct Judged {
  gap::Model model;
  gap::Scene scene;
  const gap::Effect& effect;
  Judged(const std::string& name, bool in_response, const std::vector<double>& values,
         const std::string& more = "")
      : model(model_of("[[block]]\ntype = \"gain\"\ngain = 2.0\n" + more)),
        effect(gap::effect_registry().get(name)) {
    gap::Experiments train;
    if (in_response) {
      train.emplace_back(
          gap::FrequencyExperiment(made::measured([](double hz) { return 2.0 * made::lag(hz, 100.0); }, 8.0,
                                                  512.0, 25, [](double) { return 0.01; }, 3)));
    } else {
      train.emplace_back(gap::TimeExperiment(
          measured("[[block]]\ntype = \"gain\"\ngain = 2.1\n", drive(600), 1e-3, 0.01, 1)));
    }
    const auto before = gap::make_scene(model, train);
    for (auto& one : proposals_of(effect, before)) {
      if (one.model.terms().back().unknowns.size() != values.size()) continue;
      model = one.model;
      set_term(model, values);
      scene = gap::make_scene(model, train);
      return;
    }
    ADD_FAILURE() << name << " has no proposal of " << values.size() << " unknowns";
  }
  bool no_name() const { return effect.is_no_name(model, model.terms().back(), scene); }
};

// Branches that differ by less than what a name must explain, of their common bend, are a curve.
TEST(Effects, ALoopWithoutWidthIsNoName) {
  const auto branches = [](double loop) {
    // Both bend by .05 x^2; they part by loop x^2.
    return Judged("asymmetric_hysteresis", false, {0.0, 0.05 + loop, 0.0, 0.0, 0.05 - loop, 0.0}).no_name();
  };
  const double least = gap::kExplained;
  EXPECT_TRUE(branches(0.05 * 0.98 * least));
  EXPECT_FALSE(branches(0.05 * 1.02 * least));
  EXPECT_FALSE(branches(-0.05 * 1.02 * least));
  // A common slope is a gain and no bend: it hides no loop.
  EXPECT_FALSE(Judged("asymmetric_hysteresis", false, {0.5, 0.001, 0.0, 0.5, -0.001, 0.0}).no_name());
}

// Nine plays, of which the fourth weighs, and what a knee in the middle of the upper half bends.
TEST(Effects, PlaysWithoutAKneeAreNoAsymmetricMemory) {
  const auto bent = [](double v) {
    const double middle = 0.5 * Judged("offset", false, {0.0}).scene.boundary[0].high;
    return Judged("asymmetric_hysteresis", false, {0, 0, 0, 0.5, 0, 0, 0, 0, 0, middle, v, 0, 1}).no_name();
  };
  EXPECT_TRUE(bent(0.01));
  EXPECT_FALSE(bent(0.2));
  EXPECT_FALSE(bent(-0.2));
  EXPECT_TRUE(bent(4.9));
}

// Halves of a stop that weigh the same are hysteresis.
TEST(Effects, AStopOfEvenHalvesIsNoName) {
  const auto stop = [](double above, double below) {
    return Judged("asymmetric_hysteresis", false, {0.2, above, below}).no_name();
  };
  const double least = gap::kExplained;
  EXPECT_TRUE(stop(0.3 * (1.0 + 0.98 * least), 0.3 * (1.0 - 0.98 * least)));
  EXPECT_FALSE(stop(0.3 * (1.0 + 1.02 * least), 0.3 * (1.0 - 1.02 * least)));
  EXPECT_FALSE(stop(0.3, 0.6));
}

// A loop of one rate is hysteresis.
TEST(Effects, EvenRatesAreNoName) {
  const auto loop = [](double skew) {
    return Judged("asymmetric_hysteresis", false, {0.1, 2.0, skew, 0.0, 1.0}).no_name();
  };
  const double least = gap::kExplained;
  EXPECT_TRUE(loop(0.98 * least));
  EXPECT_FALSE(loop(1.02 * least));
  EXPECT_FALSE(loop(-1.02 * least));
}

}  // namespace
}  // namespace effects_of
