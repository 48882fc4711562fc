#include "circuit/realise_ladder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/error.hpp"
#include "base/text.hpp"
#include "circuit/opamp_check.hpp"
#include "circuit/response.hpp"

namespace bodesmith::circuit {
namespace {

using Complex = std::complex<double>;

constexpr int kSearchGrid = 33;
constexpr int kLevels = 192;  // tried between the limits
constexpr int kSearchedLevels = 12;
constexpr int kNeighbours = 4;

std::vector<double> corners(const std::vector<Complex>& roots) {
  std::vector<double> out;
  for (const Complex root : roots) {
    if (root.imag() != 0.0 || !(root.real() < 0.0)) {
      throw DesignError(fmt::format(
          "ladders make real poles and zeros in the left half plane, not {} {} {}j rad/s, expected "
          "--realization opamp-rc",
          rounded_text(root.real()), root.imag() < 0.0 ? "-" : "+", rounded_text(std::abs(root.imag()))));
    }
    out.push_back(-root.real());
  }
  return out;
}

/// One chain with its parts: the resistor first, then the ladder.
class Chain {
 public:
  Chain(const LadderChain& chain, double gain, LadderForm form, const RealiseOptions& options,
        const std::vector<Hertz>& grid)
      : chain_(chain), form_(form), options_(options) {
    z_.poles = chain.lag ? chain.poles : chain.zeros;
    z_.zeros = chain.lag ? chain.zeros : chain.poles;
    // Lag: H(inf) = -Z(inf)/R1; lead: -R2/Z(inf). With the resistor at 1 ohm:
    z_.high = chain.lag ? gain : 1.0 / gain;
    drawn_ = ladder_parts(z_, form);
    unit_ = {1.0};
    for (const LadderPart& part : drawn_) {
      if (!(part.value > 0.0) || !std::isfinite(part.value)) {
        throw DesignError(
            fmt::format("{} of a ladder comes out as {}: the continued fraction is ill-conditioned, "
                        "expected a lower order or a Foster form",
                        part.name, part.value));
      }
      unit_.push_back(part.value);
    }
    for (const Hertz f : grid) {
      s_.emplace_back(0.0, f.rad_s().value);
      const Complex z = z_(s_.back());
      wanted_.push_back(chain.lag ? z : 1.0 / z);
    }
  }

  /// `owed`: wanted over realised of the chains before, which this one makes good as far as it can.
  void search(std::vector<Complex>& owed) {
    for (size_t k = 0; k < owed.size(); ++k) wanted_[k] *= owed[k];
    find();
    for (size_t k = 0; k < owed.size(); ++k) owed[k] = wanted_[k] / ratio(values_, s_[k]);
  }

  size_t size() const { return unit_.size(); }
  bool lag() const { return chain_.lag; }
  bool resistor(size_t i) const { return i == 0 || drawn_[i - 1].resistor; }
  const LadderPart& drawn(size_t i) const { return drawn_[i - 1]; }
  const std::vector<double>& exact() const { return exact_; }
  const std::vector<double>& values() const { return values_; }
  /// Every value rounded on its own, at the middle of the levels that the limits leave.
  const std::vector<double>& nearest() const { return nearest_; }

  Complex response(const std::vector<double>& values, RadPerSecond w) const {
    return -ratio(values, {0.0, w.value});
  }
  std::vector<Biquad> wanted_factors() const { return factors(z_, 1.0); }
  std::vector<Biquad> realised_factors() const {
    return factors(impedance_of(form_, std::span(values_).subspan(1)), values_[0]);
  }

 private:
  Complex ratio(const std::vector<double>& values, Complex s) const {
    const Complex z = ladder_impedance(form_, std::span(values).subspan(1), s);
    return chain_.lag ? z / values[0] : values[0] / z;
  }

  /// One pole and one zero each, the sign and the gain with the first.
  std::vector<Biquad> factors(const RcImpedance& z, double resistor) const {
    const std::vector<double>&zeros = chain_.lag ? z.zeros : z.poles, &poles = chain_.lag ? z.poles : z.zeros;
    std::vector<Biquad> out;
    for (size_t i = 0; i < poles.size(); ++i) {
      const double k = i > 0 ? 1.0 : -(chain_.lag ? z.high / resistor : resistor / z.high);
      out.push_back({k * zeros[i], k, 0.0, poles[i], 1.0, 0.0});
    }
    return out;
  }

  std::vector<double> at_level(double level) const {
    std::vector<double> out(unit_.size());
    for (size_t i = 0; i < out.size(); ++i) out[i] = resistor(i) ? unit_[i] * level : unit_[i] / level;
    return out;
  }

  void find() {
    const auto [low, high] = levels();
    if (options_.resistors.is_exact() && options_.capacitors.is_exact()) {
      exact_ = at_level(std::sqrt(low * high));
      values_ = nearest_ = exact_;
      return;
    }
    std::vector<std::pair<double, double>> ranked;
    for (int i = 0; i < kLevels; ++i) {
      const double level = low * std::pow(high / low, (i + 0.5) / kLevels);
      ranked.emplace_back(miss(rounded(at_level(level))), level);
    }
    std::sort(ranked.begin(), ranked.end());
    // The middle, too: what is found is then no worse than plain rounding there.
    const double middle = std::sqrt(low * high);
    nearest_ = rounded(at_level(middle));
    ranked.insert(ranked.begin(), {miss(nearest_), middle});
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i < kSearchedLevels; ++i) {
      const std::vector<double> exact = at_level(ranked[static_cast<size_t>(i)].second);
      std::vector<double> values = rounded(exact);
      const double here = descend(exact, values);
      if (here < least) {
        least = here;
        exact_ = exact;
        values_ = values;
      }
    }
  }

  std::pair<double, double> levels() const {
    double low = 0.0, high = std::numeric_limits<double>::infinity();
    double least[2] = {high, high}, most[2] = {0.0, 0.0};
    for (size_t i = 0; i < unit_.size(); ++i) {
      const int kind = resistor(i) ? 0 : 1;
      least[kind] = std::min(least[kind], unit_[i]);
      most[kind] = std::max(most[kind], unit_[i]);
    }
    low = std::max(options_.least_ohm / least[0], most[1] / options_.greatest_f);
    high = std::min(options_.greatest_ohm / most[0], least[1] / options_.least_f);
    if (!(low <= high)) {
      const double level = std::sqrt(low * high);
      throw DesignError(fmt::format(
          "a ladder of {} poles takes resistors of {} to {} ohm and capacitors of {} to {} F, expected wider "
          "limits (--min-ohm, --max-ohm, --min-f, --max-f), a lower order or another form",
          z_.poles.size(), rounded_text(least[0] * level), rounded_text(most[0] * level),
          rounded_text(least[1] / level), rounded_text(most[1] / level)));
    }
    return {low, high};
  }

  const Series& series(size_t i) const { return resistor(i) ? options_.resistors : options_.capacitors; }

  std::vector<double> rounded(const std::vector<double>& exact) const {
    std::vector<double> out(exact.size());
    for (size_t i = 0; i < out.size(); ++i) out[i] = series(i).nearest(exact[i]);
    return out;
  }

  double miss(const std::vector<double>& values,
              double enough = std::numeric_limits<double>::infinity()) const {
    double out = 0.0;
    for (size_t i = 0; i < s_.size() && out <= enough; ++i)
      out = std::max(out, std::norm(ratio(values, s_[i]) / wanted_[i] - 1.0));
    return out;
  }

  bool allowed(size_t i, double value) const {
    const double low = resistor(i) ? options_.least_ohm : options_.least_f;
    const double high = resistor(i) ? options_.greatest_ohm : options_.greatest_f;
    return value >= low * (1.0 - 1e-9) && value <= high * (1.0 + 1e-9);
  }

  /// One and two values at a time while it gets better.
  double descend(const std::vector<double>& exact, std::vector<double>& values) const {
    std::vector<std::vector<double>> near;
    for (size_t i = 0; i < exact.size(); ++i) {
      near.emplace_back();
      for (const double value : series(i).nearest(exact[i], kNeighbours)) {
        if (allowed(i, value)) near.back().push_back(value);
      }
    }
    double best = miss(values);
    for (bool better = true; better;) {
      better = false;
      for (size_t i = 0; i < values.size(); ++i) {
        for (size_t j = i; j < values.size(); ++j) {
          std::vector<double> trial = values;
          for (const double a : near[i]) {
            for (const double b : near[j]) {
              trial[i] = a;
              trial[j] = b;
              const double here = miss(trial, best);
              if (here < best * (1.0 - 1e-9)) {
                best = here;
                values = trial;
                better = true;
              }
            }
          }
        }
      }
    }
    return best;
  }

  LadderChain chain_;
  LadderForm form_;
  const RealiseOptions& options_;
  RcImpedance z_;
  std::vector<LadderPart> drawn_;
  std::vector<double> unit_;  ///< with the resistor at 1 ohm
  std::vector<Complex> s_, wanted_;
  std::vector<double> exact_, values_, nearest_;
};

const char* form_name(LadderForm form) {
  switch (form) {
    case LadderForm::foster1:
      return "foster1";
    case LadderForm::foster2:
      return "foster2";
    case LadderForm::cauer1:
      return "cauer1";
    case LadderForm::cauer2:
      return "cauer2";
  }
  return "";
}

std::string node(const std::string& local, size_t stage, size_t count) {
  if (local == "0") return local;
  if (local == "in") return stage == 0 ? "in" : fmt::format("n{}", stage);
  if (local == "out") return stage + 1 == count ? "out" : fmt::format("n{}", stage + 1);
  return fmt::format("s{}_{}", stage + 1, local);
}

void add_part(Circuit& circuit, size_t stage, size_t count, bool resistor, const std::string& name,
              const std::string& from, const std::string& to, const Series& series, double wanted,
              double realised) {
  circuit.parts.push_back({resistor ? Part::Kind::resistor : Part::Kind::capacitor,
                           fmt::format("{}_{}", name, stage + 1), stage, node(from, stage, count),
                           node(to, stage, count), series.name(), wanted, realised});
}

void add_opamp(Circuit& circuit, size_t stage, size_t count) {
  circuit.opamps.push_back(
      {fmt::format("U1_{}", stage + 1), stage, "0", node("m", stage, count), node("out", stage, count)});
}

void add_chain(Circuit& circuit, const Chain& chain, LadderForm form, size_t stage, size_t count,
               const RealiseOptions& options) {
  Stage one;
  one.realization = fmt::format("{} {}", form_name(form), chain.lag() ? "in the feedback" : "at the input");
  one.wanted = chain.wanted_factors();
  one.realised = chain.realised_factors();
  one.in = node("in", stage, count);
  one.out = node("out", stage, count);
  one.first_part = circuit.parts.size();
  one.part_count = chain.size();
  const auto terminal = [&](const std::string& local) -> std::string {
    if (local == "a") return chain.lag() ? "m" : "in";
    if (local == "b") return chain.lag() ? "out" : "m";
    return local;
  };
  for (size_t i = 0; i < chain.size(); ++i) {
    const Series& series = chain.resistor(i) ? options.resistors : options.capacitors;
    if (i == 0) {
      add_part(circuit, stage, count, true, "Rg", chain.lag() ? "in" : "m", chain.lag() ? "m" : "out", series,
               chain.exact()[0], chain.values()[0]);
    } else {
      const LadderPart& part = chain.drawn(i);
      // Inner nodes are called l1, l2, …: n1, n2, … are the chain's.
      const auto local = [&](const std::string& name) {
        return name[0] == 'n' ? "l" + name.substr(1) : terminal(name);
      };
      add_part(circuit, stage, count, part.resistor, part.name, local(part.from), local(part.to), series,
               chain.exact()[i], chain.values()[i]);
    }
  }
  add_opamp(circuit, stage, count);
  circuit.stages.push_back(std::move(one));
}

void add_inverter(Circuit& circuit, size_t count, const RealiseOptions& options) {
  const double ohm = std::clamp(options.resistors.nearest(10e3), options.least_ohm, options.greatest_ohm);
  Stage one;
  one.realization = "inverter";
  one.wanted = one.realised = {{-1.0, 0.0, 0.0, 1.0, 0.0, 0.0}};
  one.in = node("in", 0, count);
  one.out = node("out", 0, count);
  one.part_count = 2;
  add_part(circuit, 0, count, true, "R1", "in", "m", options.resistors, ohm, ohm);
  add_part(circuit, 0, count, true, "R2", "m", "out", options.resistors, ohm, ohm);
  add_opamp(circuit, 0, count);
  circuit.stages.push_back(std::move(one));
}

}  // namespace

std::vector<LadderChain> alternating_chains(std::vector<double> poles, std::vector<double> zeros) {
  struct Corner {
    double at;
    bool pole;
  };
  std::vector<Corner> all;
  for (const double at : poles) all.push_back({at, true});
  for (const double at : zeros) all.push_back({at, false});
  std::stable_sort(all.begin(), all.end(), [](const Corner& a, const Corner& b) { return a.at < b.at; });
  std::vector<std::vector<Corner>> chains;
  std::vector<size_t> by_age;  // the one extended last is last
  for (const Corner& corner : all) {
    size_t i = by_age.size();
    while (i > 0 && chains[by_age[i - 1]].back().pole == corner.pole) --i;
    if (i == 0) {
      by_age.push_back(chains.size());
      chains.push_back({corner});
    } else {
      std::rotate(by_age.begin() + static_cast<std::ptrdiff_t>(i) - 1,
                  by_age.begin() + static_cast<std::ptrdiff_t>(i), by_age.end());
      chains[by_age.back()].push_back(corner);
    }
  }
  // Chains left with an end too many: as many end with a pole as with a zero. Two of them make a pair.
  std::vector<Corner> lone_poles, lone_zeros;
  for (auto& chain : chains) {
    if (chain.size() % 2 == 0) continue;
    (chain.back().pole ? lone_poles : lone_zeros).push_back(chain.back());
    chain.pop_back();
  }
  for (size_t i = 0; i < lone_poles.size(); ++i) {
    chains.push_back({lone_poles[i], lone_zeros[i]});
    if (chains.back()[1].at < chains.back()[0].at) std::swap(chains.back()[0], chains.back()[1]);
  }
  std::vector<LadderChain> out;
  for (const auto& chain : chains) {
    if (chain.empty()) continue;
    LadderChain one;
    one.lag = chain.front().pole;
    for (const Corner& corner : chain) (corner.pole ? one.poles : one.zeros).push_back(corner.at);
    out.push_back(std::move(one));
  }
  return out;
}

void set_ladder_limits(RealiseOptions& options) {
  options.least_ohm = 100.0;
  options.greatest_ohm = 10e6;
  options.least_f = 47e-12;
  options.greatest_f = 4.7e-6;
}

Realised realise_ladders(const Sections& sections, LadderForm form, const RealiseOptions& options) {
  std::vector<double> poles, zeros;
  double gain = sections.gain;
  for (const Section& section : sections.sections) {
    gain *= section.gain;
    for (const double at : corners(section.poles)) poles.push_back(at);
    for (const double at : corners(section.zeros)) zeros.push_back(at);
  }
  if (poles.size() != zeros.size() || poles.empty()) {
    throw DesignError(fmt::format(
        "{} poles and {} zeros, ladders make as many of one as of the other, at least one; expected "
        "--realization opamp-rc",
        poles.size(), zeros.size()));
  }
  if (!std::isfinite(gain) || gain == 0.0)
    throw DesignError(fmt::format("the overall gain is {}, expected a finite gain other than 0", gain));
  const std::vector<LadderChain> chains = alternating_chains(poles, zeros);

  const Band ends = sections.corner_band();
  const Band band = options.band.value_or(Band{Hertz{ends.from.value / 10.0}, Hertz{ends.to.value * 10.0}});
  const std::vector<Hertz> search_grid = log_grid(band, kSearchGrid);
  // Every chain with as much gain at rest as loss far above, and its share of what is left.
  double rest = std::abs(gain);
  std::vector<double> gains;
  for (const LadderChain& chain : chains) {
    double ratio = 1.0;
    for (size_t i = 0; i < chain.poles.size(); ++i) ratio *= chain.poles[i] / chain.zeros[i];
    gains.push_back(std::sqrt(ratio));
    rest /= gains.back();
  }
  const double share = std::pow(rest, 1.0 / static_cast<double>(chains.size()));
  std::vector<Chain> made;
  std::vector<Complex> owed(search_grid.size(), 1.0);
  for (size_t i = 0; i < chains.size(); ++i) {
    made.emplace_back(chains[i], gains[i] * share, form, options, search_grid);
    made.back().search(owed);
  }

  Realised out;
  Circuit& circuit = out.circuit;
  circuit.model = options.opamp;
  const bool invert = (chains.size() % 2 == 1) != (gain < 0.0);
  const size_t count = chains.size() + (invert ? 1 : 0);
  if (invert) add_inverter(circuit, count, options);
  for (const Chain& chain : made) add_chain(circuit, chain, form, circuit.stages.size(), count, options);
  report_realised(out, sections, band, [&](RadPerSecond w) {
    Complex h = invert ? -1.0 : 1.0;
    for (const Chain& chain : made) h *= chain.response(chain.nearest(), w);
    return h;
  });
  return out;
}

}  // namespace bodesmith::circuit
