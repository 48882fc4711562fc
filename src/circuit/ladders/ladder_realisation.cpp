#include "circuit/ladders/ladder_realisation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/text.hpp"
#include "circuit/ladders/chain_search.hpp"
#include "circuit/stated_band.hpp"

namespace bodesmith::circuit {
namespace {

constexpr int kLadderSearchGrid = 33;

/// Real poles and zeros as positive corner frequencies, rad/s, and what is left as a gain.
struct RealCorners {
  std::vector<double> poles, zeros;
  double gain = 1.0;
};

std::optional<Refusal> append_corners(const std::vector<std::complex<double>>& roots,
                                      std::vector<double>& out) {
  for (const std::complex<double> root : roots) {
    if (root.imag() != 0.0 || !(root.real() < 0.0)) {
      return Refusal{fmt::format(
          "ladders make real poles and zeros in the left half plane, not {} {} {}j rad/s, expected "
          "op-amp stages (opamp-rc)",
          rounded_text(root.real()), root.imag() < 0.0 ? "-" : "+", rounded_text(std::abs(root.imag())))};
    }
    out.push_back(-root.real());
  }
  return std::nullopt;
}

Outcome<RealCorners> real_corners(const Sections& sections) {
  RealCorners out;
  out.gain = sections.gain;
  for (const Section& section : sections.sections) {
    out.gain *= section.gain;
    if (const auto refusal = append_corners(section.poles, out.poles)) return *refusal;
    if (const auto refusal = append_corners(section.zeros, out.zeros)) return *refusal;
  }
  if (out.poles.size() != out.zeros.size() || out.poles.empty()) {
    return Refusal{fmt::format(
        "{} poles and {} zeros, ladders make as many of one as of the other, at least one; expected "
        "op-amp stages (opamp-rc)",
        out.poles.size(), out.zeros.size())};
  }
  if (!std::isfinite(out.gain) || out.gain == 0.0) {
    return Refusal{fmt::format("the overall gain is {}, expected a finite gain other than 0", out.gain)};
  }
  return out;
}

/// Every chain with as much gain at rest as loss far above, and its share of what is left.
std::vector<double> chain_gains(const std::vector<AlternatingChain>& chains, double gain) {
  double rest = std::abs(gain);
  std::vector<double> out;
  for (const AlternatingChain& chain : chains) {
    double ratio = 1.0;
    for (std::size_t i = 0; i < chain.poles.size(); ++i) ratio *= chain.poles[i] / chain.zeros[i];
    out.push_back(std::sqrt(ratio));
    rest /= out.back();
  }
  const double share = std::pow(rest, 1.0 / static_cast<double>(chains.size()));
  for (double& one : out) one *= share;
  return out;
}

/// Two equal resistors: H = -1.
StageDesign unity_inverter(const RealiseOptions& options) {
  const double ohm =
      std::clamp(options.resistors.nearest(10e3), options.limits.min_ohm, options.limits.max_ohm);
  StageDesign out;
  out.realisation = inverter().name();
  out.parts = {{Part::Kind::resistor, "R1", "in", "m", false},
               {Part::Kind::resistor, "R2", "m", "out", false}};
  out.opamps = {{"U1", "0", "m", "out"}};
  out.wanted_values = out.realised_values = {ohm, ohm};
  out.wanted = out.realised = {{-1.0, 0.0, 0.0, 1.0, 0.0, 0.0}};
  out.form = inverter().make(Section{}, {});
  return out;
}

struct FoundLadder {
  LadderStage stage;
  LadderValues values;
};

Outcome<std::vector<FoundLadder>> find_ladders(const RcLadder& ladder, const RealCorners& corners,
                                               const RealiseOptions& options,
                                               const std::vector<Hertz>& grid) {
  const std::vector<AlternatingChain> chains = alternating_chains(corners.poles, corners.zeros);
  const std::vector<double> gains = chain_gains(chains, corners.gain);
  std::vector<FoundLadder> out;
  std::vector<std::complex<double>> owed(grid.size(), 1.0);
  for (std::size_t i = 0; i < chains.size(); ++i) {
    Outcome<LadderStage> stage = LadderStage::draw(chains[i], gains[i], ladder);
    if (const Refusal* refusal = refusal_of(stage)) return *refusal;
    Outcome<LadderValues> values = std::get<LadderStage>(stage).search(options, grid, owed);
    if (const Refusal* refusal = refusal_of(values)) return *refusal;
    out.push_back({std::get<LadderStage>(std::move(stage)), std::get<LadderValues>(std::move(values))});
  }
  return out;
}

}  // namespace

Outcome<Realised> LadderRealisation::design(const Sections& sections, const RealiseOptions& options) const {
  const Outcome<RealCorners> asked = real_corners(sections);
  if (const Refusal* refusal = refusal_of(asked)) return *refusal;
  const RealCorners& corners = std::get<RealCorners>(asked);
  const Band band = options.band.value_or(searched_band(sections));
  const auto outcome = find_ladders(ladder_, corners, options, log_grid(band, kLadderSearchGrid));
  if (const Refusal* refusal = refusal_of(outcome)) return *refusal;
  const auto& ladders = std::get<std::vector<FoundLadder>>(outcome);

  Realised out;
  out.circuit.opamp = options.opamp;
  const bool invert = (ladders.size() % 2 == 1) != (corners.gain < 0.0);
  const std::size_t stages = ladders.size() + (invert ? 1 : 0);
  if (invert) add_stage(out.circuit, unity_inverter(options), stages, options);
  for (const FoundLadder& one : ladders)
    add_stage(out.circuit, one.stage.design(one.values), stages, options);
  report_realised(out, sections, band, [&](RadPerSecond w) {
    std::complex<double> h = invert ? -1.0 : 1.0;
    for (const FoundLadder& one : ladders) h *= one.stage.response(one.values.nearest, w);
    return h;
  });
  return out;
}

}  // namespace bodesmith::circuit
