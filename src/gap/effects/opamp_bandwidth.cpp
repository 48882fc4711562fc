#include <algorithm>
#include <cmath>
#include <ranges>

#include "base/text.hpp"
#include "chain/opamp_poles.hpp"
#include "chain/registry.hpp"
#include "gap/effect.hpp"

namespace bodesmith::gap {
namespace {

/// An op-amp of a section H = N(s)/P(s), P(0) = 1, and the blocks that stand behind the section for it. With 1/beta = D(s)/P(s) and
/// a gain-bandwidth f the section is H P/(P + s D/(2 pi f)): a biquad of the zeros P and two of the poles, a lowpass of the
/// last. The section stays as it is, so that its capacitors can be off besides.
struct SlowOpamp {
  std::size_t at;  ///< where the section stands in the scene's model
  std::string part;
  std::vector<double> gain;  ///< D as chain::PartChange::noise_gain; empty: of one op-amp, inverting or not
  bool inverting = false;
  double known_hz = INFINITY;  ///< the gain-bandwidth that the section has in it
  // Ids:
  int section = -1;
  int pair = -1;  ///< -1: the section has none
  int last = -1;  ///< -1: the section has one pole
};

/// Of one op-amp 1/beta = 1 + |H| when inverting, |H| when not, |H| = g (1 + s/z)/(1 + s/p).
std::vector<double> one_opamps_gain(const chain::Block& section, bool inverting) {
  const double g = std::abs(section.get("gain"));
  const double own = inverting ? 1.0 : 0.0;
  return {own + g, own + g * section.get("pole_hz") / section.get("zero_hz"), 0.0};
}

void write_poles(Model& model, const SlowOpamp& opamp, double gain_bandwidth_hz) {
  const chain::Block& section = model.block(opamp.section);
  const chain::OpampPoles poles =
      chain::opamp_poles(section, opamp.gain.empty() ? one_opamps_gain(section, opamp.inverting) : opamp.gain,
                         1.0 / gain_bandwidth_hz - 1.0 / opamp.known_hz);
  const bool two = opamp.last >= 0;
  if (two) model.block(opamp.last).set("corner_hz", poles.last->value);
  if (opamp.pair < 0) return;
  const double up = poles.natural_frequency_hz / section.get(chain::corner_of(section));
  model.block(opamp.pair)
      .set("bandpass_gain", (two ? 2.0 * section.get("damping_ratio") : 1.0) * up)
      .set("highpass_gain", two ? up * up : 0.0)
      .set("natural_frequency_hz", poles.natural_frequency_hz)
      .set("damping_ratio", poles.damping_ratio);
}

/// The greatest gain-bandwidth that is told: one that is as good as the section says does nothing.
double most_hz(const Scene& scene, double known_hz) {
  return std::min(1e4 * scene.band_hz, known_hz);
}

Proposal propose_slower(const Scene& scene, Model model, Term term, double most) {
  term.unknowns = {logarithmic_unknown("gain_bandwidth_hz", std::min(0.5 * scene.band_hz, 0.5 * most), most)};
  Starts starts;
  for (double factor : {100.0, 20.0, 4.0}) starts.push_back({std::min(factor * scene.band_hz, 0.9 * most)});
  return propose_term(std::move(model), std::move(term), std::move(starts));
}

Proposal slow(const Scene& scene, std::vector<SlowOpamp> opamps) {
  Model model = *scene.model;
  Term term;
  std::vector<std::string> numbers, parts;
  // From behind, so that the places in front stay where they are.
  std::reverse(opamps.begin(), opamps.end());
  for (auto& one : opamps) {
    one.section = model.id_at(one.at);
    const bool none = chain::corner_of(model.at(one.at)).empty();
    if (none || (!one.gain.empty() && one.gain[2] > 0.0)) {
      one.last = model.insert(one.at + 1, chain::make_block("lowpass"));
      term.blocks.push_back(one.last);
    }
    if (!none) {
      one.pair = model.insert(one.at + 1, chain::make_block("biquad").set("lowpass_gain", 1.0));
      term.blocks.push_back(one.pair);
    }
    const std::string number = std::to_string(scene.model->base_number(one.at));
    if (numbers.empty() || numbers.front() != number) numbers.insert(numbers.begin(), number);
    if (!one.part.empty()) parts.insert(parts.begin(), one.part);
  }
  term.part = join(parts, ", ");
  term.placed = (numbers.size() > 1 ? "inside blocks " : "inside block ") + join(numbers, ", ");
  term.write = [opamps](Model& m, std::span<const double> v) {
    for (const auto& one : opamps) write_poles(m, one, v[0]);
  };
  term.reads_base_blocks = true;
  return propose_slower(scene, std::move(model), std::move(term), most_hz(scene, opamps.back().known_hz));
}

/// One that something passes without: the section itself changes. `at`: a biquad.
Proposal slow_with_a_way_round(const Scene& scene, std::size_t at, const chain::PartChange& opamp) {
  Model model = *scene.model;
  const int id = model.id_at(at);
  const chain::Block good = model.at(at);
  const double most = most_hz(scene, opamp.gain_bandwidth_hz);
  const auto slowed = [good, opamp](double hz) {
    return chain::slow_section(good, opamp, 1.0 / hz - 1.0 / opamp.gain_bandwidth_hz);
  };
  Term term;
  const int behind = model.insert(at + 1, slowed(most).behind);
  term.blocks = {behind};
  term.part = opamp.part;
  term.placed = inside_block(model, at);
  term.write = [id, behind, slowed](Model& m, std::span<const double> v) {
    chain::SlowSection now = slowed(v[0]);
    m.block(id) = std::move(now.section);
    m.block(behind) = std::move(now.behind);
  };
  return propose_slower(scene, std::move(model), std::move(term), most);
}

void propose_all(const Scene& scene, const std::vector<SlowOpamp>& opamps, std::vector<Proposal>& out) {
  for (const auto& one : opamps) out.push_back(slow(scene, {one}));
  if (opamps.size() > 1) out.push_back(slow(scene, opamps));
}

/// Each op-amp of the sections whose op-amps are known; of other sections with a zero one op-amp, inverting or not. Boards carry
/// one type of op-amp: all of them as well.
void propose_opamp_bandwidth(const Scene& scene, std::vector<Proposal>& out) {
  std::vector<SlowOpamp> known;
  std::vector<std::size_t> others;
  for (std::size_t at : scene.base_places()) {
    const auto& section = scene.model->at(at);
    if (section.parts) {
      for (const auto& part : *section.parts) {
        if (!part.feedthrough.empty()) {
          out.push_back(slow_with_a_way_round(scene, at, part));
        } else if (!part.noise_gain.empty()) {
          known.push_back({at, part.part, part.noise_gain, false, part.gain_bandwidth_hz});
        }
      }
    } else if (section.has("pole_hz") && section.has("zero_hz")) {
      const bool free = std::any_of(section.parameters().begin(), section.parameters().end(),
                                    [](const chain::Parameter& p) { return p.free && p.key() == "pole_hz"; });
      if (!free) others.push_back(at);
    }
  }
  propose_all(scene, known, out);
  for (const bool inverting : {true, false}) {
    std::vector<SlowOpamp> opamps;
    for (std::size_t at : others) opamps.push_back({at, scene.model->at(at).part, {}, inverting});
    propose_all(scene, opamps, out);
  }
}

}  // namespace

BODESMITH_EFFECT(opamp_bandwidth, .what = "finite gain-bandwidth of a section's op-amp",
                 .experiment = "the section alone, measured a decade higher", .linear = true,
                 .propose = propose_opamp_bandwidth)

}  // namespace bodesmith::gap
