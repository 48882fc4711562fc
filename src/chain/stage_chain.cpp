#include "chain/stage_chain.hpp"

#include <string>

#include "chain/registry.hpp"

namespace bodesmith::chain {

Chain chain_of(const Cascade& cascade) {
  Chain out;
  if (cascade.gain != 1.0 || cascade.terms.empty()) {
    out.blocks.push_back(make_block("gain").set("gain", cascade.gain));
    out.blocks.back().part = "gain";
  }
  for (const FractionalLeadLag& term : cascade.terms) {
    const std::size_t number = 1 + static_cast<std::size_t>(&term - cascade.terms.data());
    out.blocks.push_back(make_block("fractional_lead_lag")
                             .set("lambda_s", term.lambda_s)
                             .set("x", term.x)
                             .set("beta", term.beta));
    out.blocks.back().part = "Term" + std::to_string(number);
  }
  return out;
}

Block stage_block(const Disturbance& disturbance, Hertz operating) {
  Block out = make_block("polynomial_hysteresis");
  const auto list = [](const std::array<double, 3>& a) { return std::vector<double>(a.begin(), a.end()); };
  out.set("ascending", list(disturbance.ascending)).set("descending", list(disturbance.descending));
  out.set_word("minor", "slope_sign").set("amplitude", 1.0);
  std::vector<double> frequency;
  for (const Hertz f : disturbance.rate.frequency) frequency.push_back(f.value);
  out.set("rate_frequency_hz", frequency)
      .set("rate_ascending", disturbance.rate.ascending)
      .set("rate_descending", disturbance.rate.descending)
      .set("operating_hz", operating.value);
  out.set("alpha", disturbance.amplitude.alpha)
      .set("alpha_1", disturbance.amplitude.ascending)
      .set("alpha_2", disturbance.amplitude.descending);
  out.part = "stage";
  return out;
}

}  // namespace bodesmith::chain
