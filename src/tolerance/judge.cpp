#include "tolerance/judge.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "fpaa/plan/drawn_board.hpp"
#include "lti/frequency_grid.hpp"
#include "schematic/analysis/response.hpp"

namespace bodesmith::tolerance {
namespace {

std::vector<Hertz> with_judged(const Design& design, const std::vector<Hertz>& grid) {
  std::vector<Hertz> out = grid;
  if (grid.size() < 2) return out;
  constexpr double kBeyond = 1.1;  // the first or last points may be left out ones
  // Between points the curve is taken as straight, which is out by an eighth of the square of the change: a fortieth here
  // stays below a thousandth of a decibel, as near as judge_responses() comes.
  constexpr double kChange = 0.025;
  const std::vector<Hertz> judged =
      judging_grid(design.wanted, {Hertz{grid.front().value / kBeyond}, Hertz{grid.back().value * kBeyond}},
                   kJudgedPoints, kChange);
  out.insert(out.end(), judged.begin(), judged.end());
  std::ranges::sort(out);
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

std::vector<Complex> wanted_at(const Design& design, const std::vector<Hertz>& grid) {
  std::vector<Complex> out;
  for (const Hertz f : grid) out.push_back(design.wanted(f));
  return out;
}

}  // namespace

Judge::Judge(const Design& design, const std::vector<Hertz>& grid)
    : Judge(design, grid, with_judged(design, grid)) {}

Judge::Judge(const Design& design, const std::vector<Hertz>& grid, const std::vector<Hertz>& dense)
    : wanted_(wanted_at(design, dense)), curve_(dense, wanted_) {
  for (const Hertz f : grid)
    place_.push_back(
        static_cast<std::size_t>(std::lower_bound(dense.begin(), dense.end(), f) - dense.begin()));
}

Judge::Worst Judge::operator()(std::size_t i, double db, double deg, const Worst& least) const {
  // |r e^{ja} - 1|^2 = (r - 1)^2 + 4 r sin^2(a/2)
  const double r = std::exp(db / kDecibelPerNeper), half = std::sin(deg * std::numbers::pi / 360.0);
  const Worst out{std::abs(db), std::abs(deg),
                  100.0 * std::sqrt((r - 1.0) * (r - 1.0) + 4.0 * r * half * half)};
  if (out.db <= least.db && out.deg <= least.deg && out.percent <= least.percent) return out;
  const double most = std::max({out.db / kDecibelPerNeper, out.deg / to_degrees(1.0), out.percent / 100.0});
  const std::size_t at = place_[i];
  if (most <= curve_.as_it_is_below(at)) return out;
  const FlankedCurve::Error error =
      curve_.error(at, wanted_[at] * std::polar(r, deg / to_degrees(1.0)),
                   {least.db / kDecibelPerNeper, least.deg / to_degrees(1.0), least.percent / 100.0});
  return {kDecibelPerNeper * error.neper, to_degrees(error.rad), 100.0 * error.relative};
}

namespace {

/// d ln H/d ln part of a design, and how far each part may be off: ranges, worst case and ranking without
/// chance.
struct Sensitivity {
  std::vector<std::vector<double>> db_per_percent;  ///< [part][frequency]; 0 at a null of the response
  std::vector<std::vector<double>> deg_per_percent;
  std::vector<double> limit_percent;  ///< of each part (three standard deviations where there is no limit)
};

double limit_percent_of(const Part& part, const Spread& spread) {
  const double kelvin =
      std::max(std::abs(spread.temperature_low_c - 25.0), std::abs(spread.temperature_high_c - 25.0));
  switch (part.kind) {
    case Part::Kind::resistor:
      return spread.resistor_percent + spread.resistor_ppm_per_k * kelvin * 1e-4;
    case Part::Kind::capacitor:
      return spread.capacitor_percent + spread.capacitor_ppm_per_k * kelvin * 1e-4;
    case Part::Kind::switched_capacitor:
      return 300.0 * spread.mismatch.relative_sigma(part.nominal);
  }
  return 0.0;
}

using Slopes = std::vector<std::vector<Complex>>;  // d ln H/d ln part, [part][frequency]

Slopes circuit_slopes(const schematic::Netlist& netlist, bool ideal_opamps, const std::vector<Hertz>& grid) {
  const schematic::Equations equations(netlist, {.ideal_opamps = ideal_opamps});
  Slopes out(netlist.parts.size());
  for (const Hertz f : grid) {
    const auto here = schematic::log_sensitivities(equations, out.size(), f.rad_s());
    for (std::size_t i = 0; i < out.size(); ++i) out[i].push_back(here[i]);
  }
  return out;
}

Slopes log_slopes(const Design& design, const std::vector<Hertz>& grid) {
  if (design.board) {
    const fpaa::DrawnBoard board(*design.board, grid);
    return board.sensitivities(board.nominal_units());
  }
  return circuit_slopes(*design.netlist, design.ideal_opamps, grid);
}

Sensitivity sensitivity_of(const Design& design, const Options& options) {
  Sensitivity out;
  for (const auto& slopes : log_slopes(design, options.grid)) {
    out.db_per_percent.emplace_back();
    out.deg_per_percent.emplace_back();
    for (const Complex& slope : slopes) {
      out.db_per_percent.back().push_back(0.01 * kDecibelPerNeper * slope.real());
      out.deg_per_percent.back().push_back(to_degrees(0.01 * slope.imag()));
    }
  }
  for (const Part& part : design.parts) out.limit_percent.push_back(limit_percent_of(part, options.spread));
  return out;
}

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

/// Every part at its limit, in the directions that its sensitivities have at one frequency or another, over all frequencies: next to a
/// sharp root the circuit that is furthest off at a frequency is one that moves another there. As a judge sees it.
double worst_case_db(const Design& design, const Options& options, const Sensitivity& s, const Judge& judge) {
  const std::vector<double> nominal = design.nominal_values();
  std::set<std::vector<double>> corners;
  for (std::size_t i = 0; i < options.grid.size(); ++i) {
    for (const double direction : {1.0, -1.0}) {
      std::vector<double> values = nominal;
      for (std::size_t p = 0; p < values.size(); ++p) {
        const double limit = std::copysign(0.01 * s.limit_percent[p], direction * s.db_per_percent[p][i]);
        values[p] *= std::max(1.0 + limit, 1e-3);
      }
      corners.insert(std::move(values));
    }
  }
  double out = 0.0;
  for (const std::vector<double>& values : corners) {
    for (std::size_t i = 0; i < options.grid.size(); ++i) {
      const Hertz f = options.grid[i];
      const Complex ratio = design.response(f, values) / design.reference(f);
      const double db = std::clamp(to_decibel(std::abs(ratio)), -kMaxDeviationDb, kMaxDeviationDb);
      out = std::max(out, judge(i, db, to_degrees(std::arg(ratio))).db);
    }
  }
  return out;
}

}  // namespace

Result expected_result(const Design& design, const Options& options, const Judge& judge) {
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
    const Complex offset = design.nominal(options.grid[i]) / design.reference(options.grid[i]);
    const double off_db = std::clamp(std::abs(to_decibel(std::abs(offset))), 0.0, kMaxDeviationDb);
    const double range_db = std::min(kRoom * (at.db + off_db) + 1e-6, kMaxDeviationDb);
    const double range_deg =
        std::min(kRoom * (at.deg + std::abs(to_degrees(std::arg(offset)))) + 1e-6, 180.0);
    worst_db = std::max(worst_db, range_db);
    worst_deg = std::max(worst_deg, range_deg);
    out.magnitude_db.push_back({-range_db, range_db, {}, 0.0, 0.0});
    out.phase_deg.push_back({-range_deg, range_deg, {}, 0.0, 0.0});
  }
  out.worst_case_db = worst_case_db(design, options, s, judge);
  out.worst_db = {0.0, worst_db, {}, 0.0, 0.0};
  out.worst_deg = {0.0, worst_deg, {}, 0.0, 0.0};
  const double most = std::expm1(worst_db / kDecibelPerNeper) + worst_deg * std::numbers::pi / 180.0;
  out.worst_percent = {0.0, 100.0 * most, {}, 0.0, 0.0};
  for (std::size_t p = 0; p < design.parts.size(); ++p)
    out.ranking.push_back(rank_of(p, design, options, s, loudest, max_variance));
  std::ranges::stable_sort(out.ranking, std::ranges::greater(), &PartRank::share);
  return out;
}

}  // namespace bodesmith::tolerance
