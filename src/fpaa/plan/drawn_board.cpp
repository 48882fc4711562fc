#include "fpaa/plan/drawn_board.hpp"

#include <algorithm>
#include <cmath>

#include "base/units.hpp"
#include "numeric/parallel_for.hpp"
#include "numeric/random.hpp"
#include "signal/statistics.hpp"

namespace bodesmith::fpaa {
namespace {

using Complex = std::complex<double>;

constexpr double kSensitivityStep = 1e-5;

std::vector<Complex> gains(const SwitchedBoard& board, const std::vector<Hertz>& grid) {
  std::vector<Complex> out;
  for (const Hertz f : grid) out.push_back(board.gain(f.rad_s()));
  return out;
}

}  // namespace

std::vector<Complex> DrawnBoard::response(std::span<const double> units) const {
  SwitchedBoard board = board_;
  board.set_units(units);
  return gains(board, grid_);
}

std::vector<std::vector<Complex>> DrawnBoard::sensitivities(std::span<const double> units) const {
  SwitchedBoard board = board_;
  std::vector<double> moved(units.begin(), units.end());
  std::vector<std::vector<Complex>> out(moved.size(), std::vector<Complex>(grid_.size(), 0.0));
  const auto with = [&](std::size_t c, double step) {
    moved[c] = units[c] * std::exp(step);
    board.set_units(moved);
    return gains(board, grid_);
  };
  for (std::size_t c = 0; c < moved.size(); ++c) {
    if (!(units[c] > 0.0)) continue;
    const std::vector<Complex> up = with(c, kSensitivityStep);
    const std::vector<Complex> down = with(c, -kSensitivityStep);
    moved[c] = units[c];
    for (std::size_t k = 0; k < grid_.size(); ++k)
      out[c][k] = (up[k] - down[k]) / (kSensitivityStep * (up[k] + down[k]));
  }
  return out;
}

std::vector<double> DrawnBoard::drawn(const MismatchModel& mismatch, Random& random) const {
  std::vector<double> out;
  out.reserve(capacitor_count());
  for (const double units : nominal_units()) out.push_back(mismatch.drawn(units, random.normal()));
  return out;
}

std::vector<std::vector<Complex>> DrawnBoard::drawn_responses(const MismatchModel& mismatch, int draws,
                                                              std::uint64_t seed) const {
  std::vector<std::vector<double>> boards;
  Random random(seed);
  for (int draw = 0; draw < draws; ++draw) boards.push_back(drawn(mismatch, random));
  std::vector<std::vector<Complex>> out(boards.size());
  parallel_for(boards.size(), thread_count(0), [&](std::size_t i) { out[i] = response(boards[i]); });
  return out;
}

namespace {

/// Where the first-order variance of the complex response is largest, each capacitor's share of it.
std::vector<MismatchSpread::Share> variance_shares(const DrawnBoard& board, const MismatchModel& mismatch) {
  const auto slopes = board.sensitivities(board.nominal_units());
  const std::vector<double>& units = board.nominal_units();
  const auto variance = [&](std::size_t c, std::size_t k) {
    return std::pow(mismatch.relative_sigma(units[c]), 2) * std::norm(slopes[c][k]);
  };
  std::size_t loudest = 0;
  double largest = 0.0;
  for (std::size_t k = 0; k < board.grid().size(); ++k) {
    double sum = 0.0;
    for (std::size_t c = 0; c < units.size(); ++c) sum += variance(c, k);
    if (sum > largest) {
      largest = sum;
      loudest = k;
    }
  }
  std::vector<MismatchSpread::Share> out;
  for (std::size_t c = 0; c < units.size() && largest > 0.0; ++c) {
    out.push_back({board.names()[c], variance(c, loudest) / largest});
  }
  std::stable_sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.share > b.share; });
  return out;
}

}  // namespace

MismatchSpread mismatch_spread(const DrawnBoard& board, const MismatchModel& mismatch, int draws,
                               std::uint64_t seed) {
  MismatchSpread out;
  out.draws = draws;
  out.shares = variance_shares(board, mismatch);
  if (draws <= 0) return out;
  const std::vector<Complex> designed = board.response(board.nominal_units());
  std::vector<double> percent;
  std::vector<double> decibel;
  for (const std::vector<Complex>& got : board.drawn_responses(mismatch, draws, seed)) {
    double worst = 0.0;
    double worst_db = 0.0;
    for (std::size_t k = 0; k < got.size(); ++k) {
      worst = std::max(worst, 100.0 * std::abs(got[k] / designed[k] - 1.0));
      worst_db = std::max(worst_db, std::abs(to_decibel(std::abs(got[k] / designed[k]))));
    }
    percent.push_back(worst);
    decibel.push_back(worst_db);
  }
  std::sort(percent.begin(), percent.end());
  std::sort(decibel.begin(), decibel.end());
  out.median_percent = quantile_of_sorted(percent, 0.5);
  out.p95_percent = quantile_of_sorted(percent, 0.95);
  out.max_percent = percent.back();
  out.p95_db = quantile_of_sorted(decibel, 0.95);
  return out;
}

}  // namespace bodesmith::fpaa
