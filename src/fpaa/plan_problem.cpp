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

ChainProblem chain_problem(const FilterParts& parts, const std::vector<CamSlot>& slots, Hertz clock,
                           Band band, int points) {
  ChainProblem problem;
  problem.clock = clock;
  problem.log_gain = parts.log_gain;
  for (const Hertz f : log_grid(band, points)) problem.grid.push_back(f.rad_s());
  const double end = log_peak(parts, parts.parts.size(), band) + parts.log_gain;
  double before = 0.0;
  for (size_t c = 0; c < slots.size(); ++c) {
    const int cam = static_cast<int>(c);
    using Kind = Branch::Kind;
    if (slots[c].is_gain()) {
      problem.branches.push_back({Kind::constant, {}, true, cam});
      problem.branches.push_back({Kind::constant, {}, false, cam});
    } else {
      const FilterPart& part = parts.parts[static_cast<size_t>(slots[c].part)];
      const Kind above = part.kind == FilterPart::Kind::pole_zero   ? Kind::corner
                         : part.kind == FilterPart::Kind::high_pass ? Kind::differentiating
                                                                    : Kind::constant;
      problem.branches.push_back({above, part.zero, true, cam});
      problem.branches.push_back({Kind::corner, part.pole, false, cam});
    }
    const size_t filters = std::min(c + 1, parts.parts.size());
    const double wanted_peak = end * static_cast<double>(c + 1) / static_cast<double>(slots.size());
    const double node = wanted_peak - log_peak(parts, filters, band);  // ln of all gain up to this node
    problem.cam_log_gain.push_back(node - before);
    before = node;
  }
  return problem;
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
    narrow(part.pole);
    if (part.kind == FilterPart::Kind::pole_zero) narrow(part.zero);
  }
  return {{low}, {high}};
}

}  // namespace bodesmith::fpaa
