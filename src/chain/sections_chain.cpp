#include "chain/sections_chain.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.hpp"
#include "base/hertz_values.hpp"
#include "chain/registry.hpp"

namespace bodesmith::chain {
namespace {

double corner_hz(double root_rad_s) {
  return RadPerSecond{std::abs(root_rad_s)}.hz().value;
}

/// The blocks so far, and the gain that they leave to the block at the front.
struct Blocks {
  double gain = 1.0;
  std::vector<Block> list;

  Block& add(std::string_view type) {
    list.push_back(make_block(type));
    return list.back();
  }
};

/// k (s - zero)/(s - pole), or k/(s - pole).
void add_real_pole(Blocks& out, double k, double pole, std::optional<double> zero) {
  if (pole == 0.0) {
    Block& block = out.add("integrator");
    block.set("gain_per_s", zero ? -k * *zero : k);
    if (zero) block.set("proportional", k);
    return;
  }
  if (!zero) {
    out.gain *= k / -pole;
    out.add("lowpass").set("corner_hz", corner_hz(pole));
  } else if (*zero == 0.0) {
    out.gain *= k;
    out.add("highpass").set("corner_hz", corner_hz(pole));
  } else {
    out.gain *= k * *zero / pole;
    const bool left = *zero < 0.0;
    out.add(left ? "pole_zero" : "right_half_plane_zero")
        .set(left ? "zero_hz" : "right_zero_hz", corner_hz(*zero))
        .set("pole_hz", corner_hz(pole));
  }
}

/// Two poles that stay together, s^2 + 2 zeta w s + w^2, and the numerator over w^2 in powers of s/w, without the gain.
struct Pair {
  double w, damping;
  double low, band, high;
};

Pair pair_of(const Section& section) {
  Complex first = section.poles[0];
  Complex second = section.poles[1];
  if (first == 0.0) std::swap(first, second);
  if (first == 0.0) throw InputError("two poles at 0 share a section with complex zeros: no block is that");
  if (second == 0.0) second = 1e-12 * first;
  const double w = std::sqrt((first * second).real());
  Pair out{w, -(first + second).real() / (2.0 * w), 1.0 / (w * w), 0.0, 0.0};
  const auto& zeros = section.zeros;
  if (zeros.empty()) return out;
  const bool two = zeros.size() == 2;
  out.low = (two ? zeros[0] * zeros[1] : -zeros[0]).real() / (w * w);
  out.band = two ? -(zeros[0] + zeros[1]).real() / w : 1.0 / w;
  out.high = two ? 1.0 : 0.0;
  return out;
}

Block biquad_of(const Pair& pair, double gain) {
  return make_block("biquad")
      .set("lowpass_gain", gain * pair.low)
      .set("bandpass_gain", gain * pair.band)
      .set("highpass_gain", gain * pair.high)
      .set("natural_frequency_hz", corner_hz(pair.w))
      .set("damping_ratio", pair.damping);
}

void add_pair(Blocks& out, const Section& section) {
  Pair pair = pair_of(section);
  if (section.zeros.empty()) {
    out.gain *= section.gain / (pair.w * pair.w);
    out.add("resonator").set("natural_frequency_hz", corner_hz(pair.w)).set("damping_ratio", pair.damping);
    return;
  }
  const double unit = pair.low != 0.0 ? pair.low : pair.high != 0.0 ? pair.high : pair.band;
  out.gain *= section.gain * unit;
  for (double* one : {&pair.low, &pair.band, &pair.high}) *one /= unit;
  out.list.push_back(biquad_of(pair, 1.0));
}

bool all_real(const std::vector<Complex>& roots) {
  return std::ranges::all_of(roots, [](const Complex& r) { return r.imag() == 0.0; });
}

void add_section(Blocks& out, const Section& section) {
  if (section.poles.size() == 2 && !(all_real(section.poles) && all_real(section.zeros))) {
    add_pair(out, section);
    return;
  }
  for (std::size_t i = 0; i < section.poles.size(); ++i) {
    const std::optional<double> zero =
        i < section.zeros.size() ? std::optional(section.zeros[i].real()) : std::nullopt;
    add_real_pole(out, i == 0 ? section.gain : 1.0, section.poles[i].real(), zero);
  }
}

}  // namespace

Block biquad_of(const Section& section) {
  return biquad_of(pair_of(section), section.gain);
}

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
  out.set("rate_frequency_hz", hertz_values(disturbance.rate.frequency))
      .set("rate_ascending", disturbance.rate.ascending)
      .set("rate_descending", disturbance.rate.descending)
      .set("operating_hz", operating.value);
  out.set("alpha", disturbance.amplitude.alpha)
      .set("alpha_1", disturbance.amplitude.ascending)
      .set("alpha_2", disturbance.amplitude.descending);
  out.part = "stage";
  return out;
}

Chain chain_of(const Sections& sections, const std::string& prefix) {
  Blocks blocks;
  blocks.gain = sections.gain;
  for (std::size_t i = 0; i < sections.sections.size(); ++i) {
    const std::size_t first = blocks.list.size();
    add_section(blocks, sections.sections[i]);
    const bool one = blocks.list.size() == first + 1;
    for (std::size_t k = first; k < blocks.list.size() && !prefix.empty(); ++k)
      blocks.list[k].part =
          prefix + std::to_string(i + 1) + (one ? "" : std::string(1, static_cast<char>('a' + (k - first))));
  }
  Chain out;
  if (blocks.gain != 1.0 || blocks.list.empty()) {
    out.blocks.push_back(make_block("gain"));
    out.blocks.back().set("gain", blocks.gain);
    if (!prefix.empty()) out.blocks.back().part = prefix + "_gain";
  }
  for (Block& block : blocks.list) out.blocks.push_back(std::move(block));
  if (sections.delay_s > 0.0) {
    out.blocks.push_back(make_block("delay"));
    out.blocks.back().set("delay_s", sections.delay_s);
    if (!prefix.empty()) out.blocks.back().part = prefix + "_delay";
  }
  return out;
}

}  // namespace bodesmith::chain
