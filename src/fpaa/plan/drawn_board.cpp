#include "fpaa/plan/drawn_board.hpp"

#include <algorithm>
#include <cmath>

#include "numeric/parallel_for.hpp"

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

std::vector<std::vector<Complex>> DrawnBoard::slopes(std::span<const double> units) const {
  std::vector<std::vector<Complex>> out(units.size(), std::vector<Complex>(grid_.size(), 0.0));
  parallel_for(units.size(), thread_count(0), [&](std::size_t c) {
    if (!(units[c] > 0.0)) return;
    std::vector<double> moved(units.begin(), units.end());
    const auto with = [&](double step) {
      moved[c] = units[c] * std::exp(step);
      return response(moved);
    };
    const std::vector<Complex> up = with(kSensitivityStep);
    const std::vector<Complex> down = with(-kSensitivityStep);
    for (std::size_t k = 0; k < grid_.size(); ++k) out[c][k] = (up[k] - down[k]) / (2.0 * kSensitivityStep);
  });
  return out;
}

std::vector<std::vector<Complex>> DrawnBoard::sensitivities(std::span<const double> units) const {
  std::vector<std::vector<Complex>> out = slopes(units);
  const std::vector<Complex> at = response(units);
  for (std::vector<Complex>& of_one : out) {
    for (std::size_t k = 0; k < at.size(); ++k) of_one[k] /= at[k];
  }
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
