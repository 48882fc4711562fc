#include <algorithm>
#include <cmath>

#include "chain/registry.hpp"
#include "gap/effect.hpp"

namespace bodesmith::gap {
namespace {

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
    }
  }
};

}  // namespace

const Effect& creep_effect() {
  static const Creep effect;
  return effect;
}

}  // namespace bodesmith::gap
