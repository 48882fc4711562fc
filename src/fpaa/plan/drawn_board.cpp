#include "fpaa/plan/drawn_board.hpp"

#include <algorithm>
#include <cmath>

#include "numeric/parallel_for.hpp"
#include "numeric/random.hpp"

namespace bodesmith::fpaa {
namespace {

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

std::vector<DrawnBoard::Share> DrawnBoard::variance_shares(const MismatchModel& mismatch) const {
  const auto slopes = sensitivities(nominal_units());
  const std::vector<double>& units = nominal_units();
  const auto variance = [&](std::size_t c, std::size_t k) {
    return std::pow(mismatch.relative_sigma(units[c]), 2) * std::norm(slopes[c][k]);
  };
  std::size_t loudest = 0;
  double largest = 0.0;
  for (std::size_t k = 0; k < grid_.size(); ++k) {
    double sum = 0.0;
    for (std::size_t c = 0; c < units.size(); ++c) sum += variance(c, k);
    if (sum > largest) {
      largest = sum;
      loudest = k;
    }
  }
  std::vector<Share> out;
  for (std::size_t c = 0; c < units.size() && largest > 0.0; ++c)
    out.push_back({names()[c], variance(c, loudest) / largest});
  std::ranges::stable_sort(out, [](const auto& a, const auto& b) { return a.share > b.share; });
  return out;
}

}  // namespace bodesmith::fpaa
