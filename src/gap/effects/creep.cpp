#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "chain/registry.hpp"
#include "gap/effect.hpp"
#include "gap/effects/relaxation_band.hpp"

namespace bodesmith::gap {
namespace {

/// Geometric mean of a term's time constants, weighted with their gains, s; 0 when it does nothing.
double middle_of_relaxations(const Term& term, const Model& model) {
  const auto& block = model.at(model.position_of(term.blocks.front()));
  const auto& gains = block.list("gains");
  const auto& times = block.list("time_constants_s");
  double sum = 0.0;
  double weights = 0.0;
  for (std::size_t k = 0; k < gains.size(); ++k) {
    sum += gains[k] * std::log(times[k]);
    weights += gains[k];
  }
  return weights > 0.0 ? std::exp(sum / weights) : 0.0;
}

class Creep final : public Effect {
 public:
  std::string_view name() const override { return "creep"; }
  std::string_view what() const override {
    return "slow relaxation, logarithmic or of several time constants";
  }
  std::string_view symptom() const override {
    return "a residual that lags the input by far more than its own time scale";
  }
  std::vector<std::string_view> confused_with() const override {
    return {"drift", "rate_dependence", "hysteresis"};
  }
  std::string_view experiment() const override { return "a long record after one step"; }
  bool linear() const override { return true; }
  bool independent_of_input() const override { return true; }
  void propose(const Scene& scene, std::vector<Proposal>& out) const override {
    const double slow = scene.frequency_only ? 1.0 / scene.low_hz : 0.7 * scene.duration_s;
    const double fast = 0.08 / scene.band_hz;
    for (std::size_t at : scene.linear_places()) {
      // One relaxation with a time constant of its own, and a logarithmic spectrum of fixed ones.
      auto one = chain::make_block("creep");
      one.set("gains", std::vector<double>{0.01})
          .set("time_constants_s", std::vector<double>{std::sqrt(fast * slow)});
      Starts starts;
      for (double part : {0.15, 0.4, 0.7, 0.95}) starts.push_back({0.01, fast * std::pow(slow / fast, part)});
      out.push_back(insert_block(scene, *this, at, one,
                                 {linear_unknown("gains[0]", 0.0, 1.0, 0.05),
                                  logarithmic_unknown("time_constants_s[0]", fast, 3.0 * slow)},
                                 starts));
      auto many = chain::make_block("creep");
      const int count = 8;
      std::vector<double> times;
      std::vector<double> gains(count, 0.01);
      std::vector<Unknown> unknowns;
      for (int k = 0; k < count; ++k) {
        times.push_back(fast * std::pow(slow / fast, k / (count - 1.0)));
        unknowns.push_back(linear_unknown("gains[" + std::to_string(k) + "]", 0.0, 1.0, 0.05));
      }
      many.set("gains", gains).set("time_constants_s", times);
      out.push_back(insert_block(scene, *this, at, many, unknowns, {gains}));
      if (!scene.frequency_only) out.push_back(logarithmic(scene, at, fast, slow));
    }
  }
  int places_a_round() const override { return 3; }
  /// One relaxation is no change of gain over a band.
  bool is_far_fetched(const Model& model, const Scene& scene) const override {
    if (model.at(model.position_of(model.terms().back().blocks.front())).list("gains").size() < 2)
      return false;
    return lies_in_driven_band(middle_of_relaxations(model.terms().back(), model), scene);
  }

 private:
  /// After a step the output grows with the logarithm of time: equal gains over time constants that are evenly spaced
  /// in their logarithm, from `fastest_s` to that times `decades`.
  Proposal logarithmic(const Scene& scene, std::size_t at, double fast, double slow) const {
    constexpr int kRelaxations = 8;
    Model model = *scene.model;
    Term term;
    term.effect = this;
    term.placed = model.placed(at);
    const std::vector<double> none(kRelaxations, 0.0);
    const std::vector<double> times(kRelaxations, fast);
    const int id =
        model.insert(at, chain::make_block("creep").set("gains", none).set("time_constants_s", times));
    term.blocks = {id};
    term.unknowns = {linear_unknown("gain", 0.0, 3.0, 0.05),
                     logarithmic_unknown("fastest_s", 0.3 * fast, slow),
                     logarithmic_unknown("slowest_over_fastest", 1.5, 1e4)};
    term.write = [id](Model& m, std::span<const double> v) {
      std::vector<double> spread;
      for (int k = 0; k < kRelaxations; ++k)
        spread.push_back(v[1] * std::pow(v[2], k / (kRelaxations - 1.0)));
      m.block(id)
          .set("gains", std::vector<double>(kRelaxations, v[0] / kRelaxations))
          .set("time_constants_s", spread);
    };
    const double range = slow / fast;
    return propose_term(std::move(model), std::move(term),
                        {{0.05, fast * std::pow(range, 0.5), std::pow(range, 0.5)},
                         {0.05, fast * std::pow(range, 0.15), std::pow(range, 0.7)}});
  }
};

}  // namespace

const Effect& creep_effect() {
  static const Creep effect;
  return effect;
}

}  // namespace bodesmith::gap
