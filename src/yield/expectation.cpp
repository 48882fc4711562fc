#include "yield/expectation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "yield/sensitivity.hpp"

namespace bodesmith::yield {
namespace {

/// First-order deviations of the whole design at one frequency.
struct Deviation {
  double db = 0.0, deg = 0.0;  ///< every part at its limit in the worst direction
  double variance = 0.0;       ///< of dB
};

Deviation deviation_at(const Sensitivity& s, std::size_t i) {
  Deviation out;
  for (std::size_t p = 0; p < s.limit_percent.size(); ++p) {
    out.db += std::abs(s.db_per_percent[p][i]) * s.limit_percent[p];
    out.deg += std::abs(s.deg_per_percent[p][i]) * s.limit_percent[p];
    out.variance += std::pow(s.db_per_percent[p][i] * s.limit_percent[p], 2);
  }
  return out;
}

/// `loudest`: the frequency where the design's variance is largest.
PartRank rank_of(std::size_t p, const Design& design, const Options& options, const Sensitivity& s,
                 std::size_t loudest, double max_variance) {
  PartRank out;
  out.part = design.parts[p].name;
  for (std::size_t i = 0; i < options.grid.size(); ++i) {
    const double db = std::abs(s.db_per_percent[p][i]) * s.limit_percent[p];
    if (db > out.worst_db || i == 0) {
      out.worst_db = db;
      out.worst_hz = options.grid[i];
      out.db_per_percent = s.db_per_percent[p][i];
    }
  }
  const double own = s.db_per_percent[p][loudest] * s.limit_percent[p];
  out.share = max_variance > 0.0 ? own * own / max_variance : 0.0;
  return out;
}

}  // namespace

Result expected_result(const Design& design, const Options& options) {
  // Twice the first-order worst case: far enough for six standard deviations and for curvature.
  constexpr double kRoom = 2.0;
  Result out;
  out.name = design.name;
  out.grid = options.grid;
  const Sensitivity s = sensitivity_of(design, options);
  double worst_db = 0.0, worst_deg = 0.0, max_variance = -1.0;
  std::size_t loudest = 0;
  for (std::size_t i = 0; i < options.grid.size(); ++i) {
    const Deviation at = deviation_at(s, i);
    if (at.variance > max_variance) {
      max_variance = at.variance;
      loudest = i;
    }
    const std::complex<double> offset = design.nominal(options.grid[i]) / design.reference(options.grid[i]);
    const double off_db = std::clamp(std::abs(to_decibel(std::abs(offset))), 0.0, kMaxDeviationDb);
    out.worst_case_db = std::max(out.worst_case_db, at.db + off_db);
    const double range_db = std::min(kRoom * (at.db + off_db) + 1e-6, kMaxDeviationDb);
    const double range_deg =
        std::min(kRoom * (at.deg + std::abs(to_degrees(std::arg(offset)))) + 1e-6, 180.0);
    worst_db = std::max(worst_db, range_db);
    worst_deg = std::max(worst_deg, range_deg);
    out.magnitude_db.push_back({-range_db, range_db, {}, 0.0, 0.0});
    out.phase_deg.push_back({-range_deg, range_deg, {}, 0.0, 0.0});
  }
  out.worst_db = {0.0, worst_db, {}, 0.0, 0.0};
  out.worst_deg = {0.0, worst_deg, {}, 0.0, 0.0};
  const double most = std::expm1(worst_db / kDecibelPerNeper) + worst_deg * std::numbers::pi / 180.0;
  out.worst_percent = {0.0, 100.0 * most, {}, 0.0, 0.0};
  for (std::size_t p = 0; p < design.parts.size(); ++p)
    out.ranking.push_back(rank_of(p, design, options, s, loudest, max_variance));
  std::stable_sort(out.ranking.begin(), out.ranking.end(),
                   [](const PartRank& a, const PartRank& b) { return a.share > b.share; });
  return out;
}

}  // namespace bodesmith::yield
