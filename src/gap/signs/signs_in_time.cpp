#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "gap/signs/chance.hpp"
#include "gap/signs/signs.hpp"
#include "signal/statistics.hpp"

namespace bodesmith::gap {
namespace {

/// A jump, over the usual change of Gaussian noise (which reaches five of its deviations in a million
/// samples).
constexpr double kJump = 8.0;
/// Deviation of Gaussian numbers whose absolute value has the median 1.
constexpr double kDeviationPerMedian = 1.4826;

/// Cells whose energies are compared; those of noise differ by more than this part of what surrogates' do.
constexpr std::size_t kEvenCells = 32;
constexpr std::size_t kMinSamplesOfCell = 16;
constexpr double kEven = 0.4;

/// Energies of equal cells of time.
std::vector<double> energies(const std::vector<double>& e, std::size_t cells) {
  const std::size_t n = e.size();
  std::vector<double> all(cells, 0.0);
  for (std::size_t c = 0; c < cells; ++c) {
    for (std::size_t i = c * n / cells; i < (c + 1) * n / cells; ++i) all[c] += e[i] * e[i];
  }
  return all;
}

/// Deviation of the cells' energies over their mean.
double spread_over_cells(const std::vector<double>& e) {
  Chance cells;
  for (double energy : energies(e, kEvenCells)) cells.add(energy);
  return cells.mean() > 0.0 ? cells.deviation() / cells.mean() : 0.0;
}

/// Share of the energy in the fullest of equal cells of time.
double largest_share(const std::vector<double>& e, std::size_t cells) {
  const auto all = energies(e, cells);
  const double total = std::accumulate(all.begin(), all.end(), 0.0);
  return total > 0.0 ? *std::max_element(all.begin(), all.end()) / total : 0.0;
}

}  // namespace

Sign bunched_in_time(const Leftover& record) {
  Sign sign{SignKind::bunched_in_time, 0.0};
  for (std::size_t cells : {5U, 20U, 60U}) {
    const double got = largest_share(record.residual, cells);
    const Chance chance = on_surrogates(
        record.residual, 3000, [&](const std::vector<double>& v) { return largest_share(v, cells); });
    sign.strength = std::max(sign.strength, got / chance.limit());
  }
  return sign;
}

Sign even_in_time(const Leftover& record) {
  Sign sign{SignKind::even_in_time, 0.0};
  if (record.residual.size() < kEvenCells * kMinSamplesOfCell) return sign;
  const Chance chance = on_surrogates(record.residual, 6000, spread_over_cells);
  sign.strength = kEven * chance.mean() / std::max(spread_over_cells(record.residual), 1e-6);
  return sign;
}

Sign jumps(const Leftover& record) {
  Sign sign{SignKind::jumps, 0.0};
  const std::size_t n = record.residual.size();
  std::vector<double> change(n - 1);
  for (std::size_t i = 1; i < n; ++i) change[i - 1] = std::abs(record.residual[i] - record.residual[i - 1]);
  const double largest = *std::max_element(change.begin(), change.end());
  const double usual = kDeviationPerMedian * median(std::move(change));
  sign.strength = usual > 0.0 ? largest / (kJump * usual) : 0.0;
  return sign;
}

}  // namespace bodesmith::gap
