#include "gap/where.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "signal/periodogram.hpp"
#include "signal/statistics.hpp"

namespace bodesmith::gap {
namespace {

struct Bin {
  double from = 0.0;
  double to = 0.0;
  double energy = 0.0;
  double extent = 0.0;
};

/// The run of bins with the largest share minus extent; widened at its denser side until it holds half of the
/// gap.
Cell densest(const std::string& axis, const std::vector<Bin>& bins) {
  double energy = 0.0;
  double extent = 0.0;
  for (const auto& b : bins) {
    energy += b.energy;
    extent += b.extent;
  }
  if (!(energy > 0.0) || !(extent > 0.0)) return {axis, bins.front().from, bins.back().to, 1.0, 1.0};
  std::size_t best_from = 0;
  std::size_t best_to = bins.size();
  double best = -1.0;
  // Kadane's scan over share - extent.
  double sum = 0.0;
  std::size_t start = 0;
  for (std::size_t i = 0; i < bins.size(); ++i) {
    if (sum <= 0.0) {
      sum = 0.0;
      start = i;
    }
    sum += bins[i].energy / energy - bins[i].extent / extent;
    if (sum > best) {
      best = sum;
      best_from = start;
      best_to = i + 1;
    }
  }
  const auto share = [&] {
    double e = 0.0;
    for (std::size_t i = best_from; i < best_to; ++i) e += bins[i].energy;
    return e / energy;
  };
  while (share() < 0.5 && (best_from > 0 || best_to < bins.size())) {
    const double left =
        best_from > 0 ? bins[best_from - 1].energy / std::max(bins[best_from - 1].extent, 1e-300) : -1.0;
    const double right =
        best_to < bins.size() ? bins[best_to].energy / std::max(bins[best_to].extent, 1e-300) : -1.0;
    if (left >= right) {
      --best_from;
    } else {
      ++best_to;
    }
  }
  double covered = 0.0;
  for (std::size_t i = best_from; i < best_to; ++i) covered += bins[i].extent;
  return {axis, bins[best_from].from, bins[best_to - 1].to, std::min(1.0, share()), covered / extent};
}

void keep_telling(std::vector<Cell>& cells) {
  const auto gain = [](const Cell& c) { return c.share - c.extent; };
  double best = 0.0;
  for (const auto& c : cells) best = std::max(best, gain(c));
  std::erase_if(cells, [&](const Cell& c) { return gain(c) < std::min(0.15, 0.999 * best); });
  std::stable_sort(cells.begin(), cells.end(), [&](const Cell& a, const Cell& b) {
    if (std::abs(a.share - b.share) > 1e-12) return a.share > b.share;
    return gain(a) > gain(b);
  });
}

}  // namespace

std::vector<Cell> where(const TimeRecord& record, const std::vector<double>& residual, std::size_t from,
                        std::size_t period) {
  std::vector<Cell> cells;
  const std::size_t n = residual.size();
  if (n < from + 16) return cells;
  const std::vector<double> e(residual.begin() + static_cast<std::ptrdiff_t>(from), residual.end());
  const std::vector<double> u(record.u.begin() + static_cast<std::ptrdiff_t>(from),
                              record.u.begin() + static_cast<std::ptrdiff_t>(n));

  {  // frequency, in narrow logarithmic steps
    const auto p = periodogram(e, record.step_s);
    std::vector<Bin> bins;
    double edge = 0.5 * p.bin_hz;
    std::size_t k = 0;
    while (k < p.power.size()) {
      Bin b;
      b.from = k == 0 ? 0.0 : edge;
      const double next = std::max(edge * 1.06, edge + p.bin_hz);
      while (k < p.power.size() && p.bin_hz * static_cast<double>(k) <= next) {
        b.energy += p.power[k++];
        b.extent += 1.0;
      }
      edge = next;
      b.to = edge;
      if (b.extent > 0.0) bins.push_back(b);
    }
    cells.push_back(densest("frequency_hz", bins));
  }
  {  // time, in 2 % steps
    std::vector<Bin> bins(std::min<std::size_t>(50, e.size() / 8));
    for (std::size_t b = 0; b < bins.size(); ++b) {
      const std::size_t i = b * e.size() / bins.size();
      const std::size_t j = (b + 1) * e.size() / bins.size();
      bins[b].from = record.time_s(from + i);
      bins[b].to = record.time_s(from + j - 1);
      bins[b].extent = static_cast<double>(j - i);
      for (std::size_t k = i; k < j; ++k) bins[b].energy += e[k] * e[k];
    }
    cells.push_back(densest("time_s", bins));
  }
  {  // amplitude of the input, in 20 cells
    const auto [low, high] = std::minmax_element(u.begin(), u.end());
    const double span = *high - *low;
    if (span > 0.0) {
      std::vector<Bin> bins(20);
      for (std::size_t b = 0; b < bins.size(); ++b) {
        bins[b].from = *low + span * static_cast<double>(b) / 20.0;
        bins[b].to = *low + span * static_cast<double>(b + 1) / 20.0;
      }
      for (std::size_t i = 0; i < u.size(); ++i) {
        const auto b = std::min<std::size_t>(19, static_cast<std::size_t>(20.0 * (u[i] - *low) / span));
        bins[b].energy += e[i] * e[i];
        bins[b].extent += 1.0;
      }
      cells.push_back(densest("amplitude", bins));
    }
  }
  {  // branch
    std::vector<Bin> bins(3);
    const std::size_t look = 1;
    for (int b = 0; b < 3; ++b)
      bins[static_cast<std::size_t>(b)].from = bins[static_cast<std::size_t>(b)].to = b - 1;
    for (std::size_t i = look; i < u.size(); ++i) {
      const double d = u[i] - u[i - look];
      const std::size_t b = d > 0.0 ? 2 : d < 0.0 ? 0 : 1;
      bins[b].energy += e[i] * e[i];
      bins[b].extent += 1.0;
    }
    cells.push_back(densest("branch", bins));
  }
  if (period > 0 && e.size() >= 2 * period) {  // harmonic: averaged over the periods
    const std::size_t periods = e.size() / period;
    std::vector<double> average(period, 0.0);
    for (std::size_t i = 0; i < periods * period; ++i)
      average[i % period] += e[i] / static_cast<double>(periods);
    const auto bins_of = half_spectrum(average);
    std::vector<Bin> bins;
    for (std::size_t k = 0; k < bins_of.size(); ++k) {
      bins.push_back({static_cast<double>(k), static_cast<double>(k), std::norm(bins_of[k]), 1.0});
    }
    cells.push_back(densest("harmonic", bins));
  }
  keep_telling(cells);
  return cells;
}

std::vector<Cell> where(const FrequencyRecord& record, const std::vector<double>& residual) {
  std::vector<Bin> bins;
  for (std::size_t i = 0; i < record.frequency.size(); ++i) {
    bins.push_back({record.frequency[i].value, record.frequency[i].value,
                    residual[2 * i] * residual[2 * i] + residual[2 * i + 1] * residual[2 * i + 1], 1.0});
  }
  if (bins.empty()) return {};
  return {densest("frequency_hz", bins)};
}

std::vector<double> share_over_time(const std::vector<double>& residual, std::size_t cells) {
  std::vector<double> shares(cells, 0.0);
  double total = 0.0;
  for (std::size_t i = 0; i < residual.size(); ++i) {
    shares[i * cells / residual.size()] += residual[i] * residual[i];
    total += residual[i] * residual[i];
  }
  for (double& s : shares) s = total > 0.0 ? s / total : 0.0;
  return shares;
}

}  // namespace bodesmith::gap
