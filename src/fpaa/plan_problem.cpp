#include "fpaa/plan_problem.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace bodesmith::fpaa {
namespace {

/// No CAM is asked for more than this gain; what is left over goes to gain stages of their own.
constexpr double kMostGainOfFilter = 8.0;
constexpr double kMostGainOfStage = 50.0;

/// Clock over corner of a biquad: below, LDI warping and the delay in the loop spoil it; above, its loop
/// capacitors get coarse.
constexpr double kSlowestBiquad = 8.0;
constexpr double kFastestBiquad = 500.0;

/// ln of the highest magnitude of the first `count` filter parts, their gain left out, over the band.
double log_peak(const FilterParts& parts, size_t count, Band band) {
  double peak = -std::numeric_limits<double>::infinity();
  for (const Hertz f : log_grid(band, 64)) {
    double magnitude = 0.0;
    for (size_t i = 0; i < count; ++i) magnitude += std::log(std::abs(parts.parts[i].response(f.rad_s())));
    peak = std::max(peak, magnitude);
  }
  return peak;
}

}  // namespace

std::vector<CamSlot> slots_for(const FilterParts& parts, Band band, int extra) {
  std::vector<CamSlot> out;
  for (size_t i = 0; i < parts.parts.size(); ++i) out.push_back({static_cast<int>(i)});
  const double total = std::abs(log_peak(parts, parts.parts.size(), band) + parts.log_gain);
  const double filters = std::log(kMostGainOfFilter) * static_cast<double>(parts.parts.size());
  int stages =
      total > filters ? static_cast<int>(std::ceil((total - filters) / std::log(kMostGainOfStage))) : 0;
  const bool inverts = (parts.parts.size() + static_cast<size_t>(stages)) % 2 == 1;
  if (inverts != parts.negative) ++stages;
  for (int s = 0; s < stages + extra; ++s) out.push_back({-1});
  return out;
}

PlanProblem plan_problem(const FilterParts& parts, const std::vector<CamSlot>& slots, Hertz clock, Band band,
                         int points, int largest) {
  PlanProblem out;
  ChainProblem& chain = out.chain;
  chain.clock = clock;
  chain.log_gain = parts.log_gain;
  chain.largest = largest;
  for (const Hertz f : log_grid(band, points)) chain.grid.push_back(f.rad_s());
  const double end = log_peak(parts, parts.parts.size(), band) + parts.log_gain;
  double before = 0.0;
  using Kind = Branch::Kind;
  for (size_t c = 0; c < slots.size(); ++c) {
    const int cam = static_cast<int>(c);
    const size_t filters = std::min(c + 1, parts.parts.size());
    const double wanted_peak = end * static_cast<double>(c + 1) / static_cast<double>(slots.size());
    const double node = wanted_peak - log_peak(parts, filters, band);  // ln of all gain up to this node
    const double wanted = node - before;
    before = node;
    out.wanted_gain.push_back(std::exp(wanted));
    out.biquads.emplace_back();
    const bool is_biquad = !slots[c].is_gain() &&
                           parts.parts[static_cast<size_t>(slots[c].part)].kind == FilterPart::Kind::biquad;
    out.first_branch.push_back(is_biquad ? -1 : static_cast<int>(chain.branches.size()));
    chain.cam_log_gain.push_back(is_biquad ? 0.0 : wanted);
    if (is_biquad) {
      BiquadTarget target = parts.parts[static_cast<size_t>(slots[c].part)].biquad;
      target.gain = std::exp(wanted);
      const BiquadSolution solution = search_biquad(target, clock, chain.grid, largest);
      out.made = out.made && solution.made;
      if (!out.made) return out;
      out.biquads.back() = solution;
      target.gain = 1.0;
      chain.others.resize(chain.grid.size());
      for (size_t k = 0; k < chain.grid.size(); ++k) {
        const RadPerSecond w = chain.grid[k];
        chain.others[k] += std::log(-solution.capacitors.transfer().response(w, clock) / target.response(w));
      }
    } else if (slots[c].is_gain()) {
      chain.branches.push_back({Kind::constant, {}, true, cam});
      chain.branches.push_back({Kind::constant, {}, false, cam});
    } else {
      const FilterPart& part = parts.parts[static_cast<size_t>(slots[c].part)];
      const Kind above = part.kind == FilterPart::Kind::pole_zero   ? Kind::corner
                         : part.kind == FilterPart::Kind::high_pass ? Kind::differentiating
                                                                    : Kind::constant;
      chain.branches.push_back({above, part.zero, true, cam});
      chain.branches.push_back({Kind::corner, part.pole, false, cam});
    }
  }
  return out;
}

Band reachable_clocks(const FilterParts& parts, int largest) {
  double low = 0.0;
  double high = std::numeric_limits<double>::infinity();
  const double most = largest + 0.5;
  const auto narrow = [&](RadPerSecond corner) {
    // tan(pi f/fc) = 1/(1 + 2 ratio), ratio between 1/most and most.
    const double f = corner.hz().value * std::numbers::pi;
    high = std::min(high, f / std::atan(1.0 / (1.0 + 2.0 * most)));
    low = std::max(low, f / std::atan(1.0 / (1.0 + 2.0 / most)));
  };
  for (const FilterPart& part : parts.parts) {
    if (part.kind == FilterPart::Kind::biquad) {
      const double f = part.biquad.natural.hz().value;
      low = std::max(low, kSlowestBiquad * f);
      high = std::min(high, kFastestBiquad * f);
      continue;
    }
    narrow(part.pole);
    if (part.kind == FilterPart::Kind::pole_zero) narrow(part.zero);
  }
  return {{low}, {high}};
}

}  // namespace bodesmith::fpaa
