#include "synthesis/ladders/ladder_realisation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <utility>
#include <vector>

#include "base/text.hpp"
#include "synthesis/circuit.hpp"
#include "synthesis/ladders/alternating_chains.hpp"
#include "synthesis/parts/exchange.hpp"
#include "synthesis/realise.hpp"

namespace bodesmith::synthesis {
namespace {

/// Values of one chain's parts: its resistor first, then the ladder's.
struct LadderValues {
  std::vector<double> exact, realised;
  /// Every value rounded on its own, at the middle of the levels that the limits leave.
  std::vector<double> nearest;
};

/// An alternating chain drawn as a ladder and a resistor around an op-amp.
class LadderStage {
 public:
  /// Refused when the ladder's values come out negative (ill-conditioned).
  static Outcome<LadderStage> draw(const AlternatingChain& chain, double gain, const RcLadder& ladder);

  /// Searches the values over the grid. `owed`: wanted over realised of the chains before, which this one
  /// makes good as far as it can, and then its own with it. Refused when no level puts all parts between
  /// their limits.
  Outcome<LadderValues> search(const RealiseOptions& options, const std::vector<Hertz>& grid,
                               std::vector<Complex>& owed) const;

  /// H(s) with ideal op-amps.
  Complex response(const std::vector<double>& values, RadPerSecond w) const;
  StageDesign design(const LadderValues& values) const;

 private:
  friend class LadderSearch;
  LadderStage(const AlternatingChain& chain, const RcLadder& ladder) : chain_(chain), ladder_(&ladder) {}

  /// |H| up to its sign: Z/R or R/Z.
  Complex ratio(const std::vector<double>& values, Complex s) const;
  std::vector<Biquad> factors(const RcImpedance& z, double resistor) const;

  AlternatingChain chain_;
  const RcLadder* ladder_;
  RcImpedance z_;                  ///< with the resistor at 1 ohm
  std::vector<StagePart> parts_;   ///< the resistor first
  std::vector<double> unit_;       ///< values with the resistor at 1 ohm
  std::vector<LadderPart> drawn_;  ///< the ladder alone
};

/// The values of one ladder stage, in the series, for a given response.
class LadderSearch {
 public:
  LadderSearch(const LadderStage& stage, const RealiseOptions& options, const std::vector<Hertz>& grid,
               const std::vector<Complex>& owed)
      : stage_(stage), options_(options) {
    for (std::size_t k = 0; k < grid.size(); ++k) {
      s_.emplace_back(0.0, grid[k].rad_s().value);
      const Complex z = stage.z_(s_.back());
      wanted_.push_back(stage.chain_.lag ? z : 1.0 / z);
      wanted_.back() *= owed[k];
    }
  }

  Outcome<LadderValues> find() const {
    const auto outcome = levels();
    if (const Refusal* refusal = refusal_of(outcome)) return *refusal;
    const auto [low, high] = std::get<Levels>(outcome);
    const double middle = std::sqrt(low * high);
    LadderValues out;
    if (options_.resistors.is_exact() && options_.capacitors.is_exact()) {
      out.exact = out.realised = out.nearest = at_level(middle);
      return out;
    }
    out.nearest = rounded(at_level(middle));
    double min_error = std::numeric_limits<double>::infinity();
    for (const double level : promising_levels(low, high, middle)) {
      const std::vector<double> exact = at_level(level);
      std::vector<double> values = rounded(exact);
      const double here = descend(exact, values);
      if (here < min_error) {
        min_error = here;
        out.exact = exact;
        out.realised = values;
      }
    }
    return out;
  }

  /// Wanted over realised at the grid, for the next stage.
  std::vector<Complex> owed(const LadderValues& values) const {
    std::vector<Complex> out;
    for (std::size_t k = 0; k < s_.size(); ++k)
      out.push_back(wanted_[k] / stage_.ratio(values.realised, s_[k]));
    return out;
  }

 private:
  static constexpr int kLevels = 192;  // tried between the limits
  static constexpr std::size_t kSearchedLevels = 12;
  static constexpr int kNeighbours = 4;

  struct Levels {
    double low, high;
  };

  Part::Kind kind(std::size_t i) const { return stage_.parts_[i].kind; }
  bool is_resistor(std::size_t i) const { return kind(i) == Part::Kind::resistor; }

  std::vector<double> at_level(double level) const {
    std::vector<double> out(stage_.unit_.size());
    for (std::size_t i = 0; i < out.size(); ++i)
      out[i] = is_resistor(i) ? stage_.unit_[i] * level : stage_.unit_[i] / level;
    return out;
  }

  /// Where all parts are between their limits.
  Outcome<Levels> levels() const {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    double min_unit[2] = {kInfinity, kInfinity}, max_unit[2] = {0.0, 0.0};
    for (std::size_t i = 0; i < stage_.unit_.size(); ++i) {
      const std::size_t k = is_resistor(i) ? 0 : 1;
      min_unit[k] = std::min(min_unit[k], stage_.unit_[i]);
      max_unit[k] = std::max(max_unit[k], stage_.unit_[i]);
    }
    const PartLimits& limits = options_.limits;
    const double low = std::max(limits.min_ohm / min_unit[0], max_unit[1] / limits.max_f);
    const double high = std::min(limits.max_ohm / max_unit[0], min_unit[1] / limits.min_f);
    if (low <= high) return Levels{low, high};
    const double level = std::sqrt(low * high);
    return Refusal{fmt::format(
        "a ladder of {} poles takes resistors of {} to {} ohm and capacitors of {} to {} F, expected wider "
        "limits of both, a lower order or another form",
        stage_.z_.poles.size(), rounded_text(min_unit[0] * level), rounded_text(max_unit[0] * level),
        rounded_text(min_unit[1] / level), rounded_text(max_unit[1] / level))};
  }

  /// The middle first: what is found is then no worse than plain rounding there.
  std::vector<double> promising_levels(double low, double high, double middle) const {
    std::vector<std::pair<double, double>> ranked;
    for (int i = 0; i < kLevels; ++i) {
      const double level = low * std::pow(high / low, (i + 0.5) / kLevels);
      ranked.emplace_back(error(rounded(at_level(level))), level);
    }
    std::ranges::sort(ranked);
    std::vector<double> out = {middle};
    for (std::size_t i = 0; out.size() < kSearchedLevels; ++i) out.push_back(ranked[i].second);
    return out;
  }

  const Series& series(std::size_t i) const {
    return is_resistor(i) ? options_.resistors : options_.capacitors;
  }

  std::vector<double> rounded(const std::vector<double>& exact) const {
    std::vector<double> out(exact.size());
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = series(i).nearest(exact[i]);
    return out;
  }

  /// Max. |H/H_wanted - 1|^2; stops looking once it is above `enough`.
  double error(const std::vector<double>& values,
               double enough = std::numeric_limits<double>::infinity()) const {
    double out = 0.0;
    for (std::size_t i = 0; i < s_.size() && out <= enough; ++i)
      out = std::max(out, std::norm(stage_.ratio(values, s_[i]) / wanted_[i] - 1.0));
    return out;
  }

  /// Two values at a time while it gets better.
  double descend(const std::vector<double>& exact, std::vector<double>& values) const {
    std::vector<std::vector<double>> near;
    for (std::size_t i = 0; i < exact.size(); ++i) {
      near.emplace_back();
      for (const double value : series(i).nearest(exact[i], kNeighbours)) {
        if (options_.limits.allow(kind(i), value)) near.back().push_back(value);
      }
    }
    return exchange_pairs(
        near, values, [this](const std::vector<double>& some, double enough) { return error(some, enough); });
  }

  const LadderStage& stage_;
  const RealiseOptions& options_;
  std::vector<Complex> s_, wanted_;
};

Outcome<LadderStage> LadderStage::draw(const AlternatingChain& chain, double gain, const RcLadder& ladder) {
  LadderStage out(chain, ladder);
  out.z_.poles = chain.lag ? chain.poles : chain.zeros;
  out.z_.zeros = chain.lag ? chain.zeros : chain.poles;
  // Lag: H(inf) = -Z(inf)/R1; lead: -R2/Z(inf). With the resistor at 1 ohm:
  out.z_.high = chain.lag ? gain : 1.0 / gain;
  // The ladder's nodes as the stage's own. Inner nodes are called l1, l2, …: n1, n2, … are the chain's.
  const auto local = [&](const std::string& node) -> std::string {
    if (node == "a") return chain.lag ? "m" : "in";
    if (node == "b") return chain.lag ? "out" : "m";
    return "l" + node.substr(1);
  };
  out.parts_ = {{Part::Kind::resistor, "Rg", chain.lag ? "in" : "m", chain.lag ? "m" : "out", false}};
  out.unit_ = {1.0};
  out.drawn_ = ladder.parts(out.z_);
  for (const LadderPart& part : out.drawn_) {
    if (!(part.value > 0.0) || !std::isfinite(part.value)) {
      return Refusal{
          fmt::format("{} of a ladder comes out as {}: the continued fraction is ill-conditioned, "
                      "expected a lower order or a Foster form",
                      part.name, part.value)};
    }
    out.parts_.push_back({part.resistor ? Part::Kind::resistor : Part::Kind::capacitor, part.name,
                          local(part.from), local(part.to), false});
    out.unit_.push_back(part.value);
  }
  return out;
}

Outcome<LadderValues> LadderStage::search(const RealiseOptions& options, const std::vector<Hertz>& grid,
                                          std::vector<Complex>& owed) const {
  const LadderSearch search(*this, options, grid, owed);
  Outcome<LadderValues> found = search.find();
  if (const LadderValues* values = std::get_if<LadderValues>(&found)) owed = search.owed(*values);
  return found;
}

Complex LadderStage::response(const std::vector<double>& values, RadPerSecond w) const {
  return -ratio(values, {0.0, w.value});
}

Complex LadderStage::ratio(const std::vector<double>& values, Complex s) const {
  const Complex z = ladder_->impedance(std::span(values).subspan(1), s);
  return chain_.lag ? z / values[0] : values[0] / z;
}

/// One pole and one zero each, the sign and the gain with the first.
std::vector<Biquad> LadderStage::factors(const RcImpedance& z, double resistor) const {
  const std::vector<double>&zeros = chain_.lag ? z.zeros : z.poles, &poles = chain_.lag ? z.poles : z.zeros;
  std::vector<Biquad> out;
  for (std::size_t i = 0; i < poles.size(); ++i) {
    const double k = i > 0 ? 1.0 : -(chain_.lag ? z.high / resistor : resistor / z.high);
    out.push_back({k * zeros[i], k, 0.0, poles[i], 1.0, 0.0});
  }
  return out;
}

StageDesign LadderStage::design(const LadderValues& values) const {
  StageDesign out;
  out.realisation = fmt::format("{} {}", ladder_->name(), chain_.lag ? "in the feedback" : "at the input");
  out.parts = parts_;
  out.opamps = {{"U1", "0", "m", "out"}};
  out.wanted_values = values.exact;
  out.realised_values = values.realised;
  out.wanted = factors(z_, 1.0);
  std::vector<LadderPart> mounted = drawn_;
  for (std::size_t i = 0; i < mounted.size(); ++i) mounted[i].value = values.realised[i + 1];
  out.realised = factors(impedance_of(mounted), values.realised[0]);
  return out;
}

constexpr int kLadderSearchGrid = 33;

/// Real poles and zeros as positive corner frequencies, rad/s, and what is left as a gain.
struct RealCorners {
  std::vector<double> poles, zeros;
  double gain = 1.0;
};

std::optional<Refusal> append_corners(const std::vector<Complex>& roots, std::vector<double>& out) {
  for (const Complex root : roots) {
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
  std::vector<Complex> owed(grid.size(), 1.0);
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
    Complex h = invert ? -1.0 : 1.0;
    for (const FoundLadder& one : ladders) h *= one.stage.response(one.values.nearest, w);
    return h;
  });
  return out;
}

}  // namespace bodesmith::synthesis
