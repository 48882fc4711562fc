#include "gap/report/where.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "base/text.hpp"
#include "base/whole_number.hpp"
#include "gap/search_options.hpp"
#include "numeric/fourier.hpp"
#include "signal/periodogram.hpp"
#include "signal/statistics.hpp"

namespace bodesmith::gap {
namespace {

double sum_of(std::span<const Bin> bins, double Bin::*value) {
  double sum = 0.0;
  for (const auto& b : bins) sum += b.*value;
  return sum;
}

double density(const Bin& bin) {
  return bin.energy / std::max(bin.extent, 1e-300);
}

/// The run of bins with the largest share minus extent (Kadane's scan).
std::span<const Bin> densest_run(const Bins& bins, double energy, double extent) {
  std::size_t best_from = 0;
  std::size_t best_to = bins.size();
  double best = -1.0;
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
  return std::span(bins).subspan(best_from, best_to - best_from);
}

/// The densest run, widened at its denser side until it holds enough of the gap.
Cell densest(Axis axis, const Bins& bins) {
  const double energy = sum_of(bins, &Bin::energy);
  const double extent = sum_of(bins, &Bin::extent);
  if (!(energy > 0.0) || !(extent > 0.0)) return {axis, bins.front().from, bins.back().to, 1.0, 1.0};
  auto run = densest_run(bins, energy, extent);
  const auto first = [&] { return static_cast<std::size_t>(run.data() - bins.data()); };
  while (sum_of(run, &Bin::energy) / energy < kMostOfGap && run.size() < bins.size()) {
    const std::size_t from = first();
    const std::size_t to = from + run.size();
    const double left = from > 0 ? density(bins[from - 1]) : -1.0;
    const double right = to < bins.size() ? density(bins[to]) : -1.0;
    run = std::span(bins).subspan(left >= right ? from - 1 : from, run.size() + 1);
  }
  return {axis, run.front().from, run.back().to, std::min(1.0, sum_of(run, &Bin::energy) / energy),
          sum_of(run, &Bin::extent) / extent};
}

/// An axis on which share exceeds extent by less than a name must explain says nothing (unless none says more).
void keep_telling(std::vector<Cell>& cells) {
  const auto gain = [](const Cell& c) { return c.share - c.extent; };
  double best = 0.0;
  for (const auto& c : cells) best = std::max(best, gain(c));
  std::erase_if(cells, [&](const Cell& c) { return gain(c) < std::min(kExplained, 0.999 * best); });
  std::stable_sort(cells.begin(), cells.end(), [&](const Cell& a, const Cell& b) {
    if (std::abs(a.share - b.share) > 1e-12) return a.share > b.share;
    return gain(a) > gain(b);
  });
}

/// Of input, output or time; empty when it does not move.
Bins even_bins(const std::vector<double>& e, std::span<const double> u) {
  const auto [low, high] = std::minmax_element(u.begin(), u.end());
  const double span = *high - *low;
  if (!(span > 0.0)) return {};
  constexpr auto kCount = static_cast<double>(kBins);
  Bins bins(kBins);
  for (std::size_t b = 0; b < bins.size(); ++b) {
    bins[b].from = *low + span * static_cast<double>(b) / kCount;
    bins[b].to = *low + span * static_cast<double>(b + 1) / kCount;
  }
  for (std::size_t i = 0; i < u.size(); ++i) {
    const auto b = std::min(kBins - 1, whole_number<std::size_t>(kCount * (u[i] - *low) / span));
    bins[b].energy += e[i] * e[i];
    bins[b].extent += 1.0;
  }
  return bins;
}

Bins branch_bins(const std::vector<double>& e, std::span<const double> u) {
  Bins bins = {{-1.0, -1.0}, {0.0, 0.0}, {1.0, 1.0}};
  for (std::size_t i = 1; i < u.size(); ++i) {
    const double d = u[i] - u[i - 1];
    Bin& b = bins[d > 0.0 ? 2 : d < 0.0 ? 0 : 1];
    b.energy += e[i] * e[i];
    b.extent += 1.0;
  }
  return bins;
}

/// Harmonics of the mean over the periods.
Bins harmonic_bins(const std::vector<double>& e, std::size_t period) {
  const std::size_t periods = e.size() / period;
  std::vector<double> average(period, 0.0);
  for (std::size_t i = 0; i < periods * period; ++i)
    average[i % period] += e[i] / static_cast<double>(periods);
  Bins bins;
  for (const auto& coefficient : half_spectrum(average)) {
    const auto k = static_cast<double>(bins.size());
    bins.push_back({k, k, std::norm(coefficient), 1.0});
  }
  return bins;
}

}  // namespace

Bins frequency_bins(const std::vector<double>& e, double step_s) {
  const auto p = periodogram(e, step_s);
  Bins bins;
  double edge = p.bin_hz / 2.0;
  std::size_t k = 0;
  while (k < p.power.size()) {
    Bin b;
    b.from = k == 0 ? 0.0 : edge;
    const double next = std::max(edge * (1.0 + 1.0 / kBins), edge + p.bin_hz);
    while (k < p.power.size() && p.bin_hz * static_cast<double>(k) <= next) {
      b.energy += p.power[k++];
      b.extent += p.bin_hz;
    }
    edge = next;
    b.to = edge;
    if (b.extent > 0.0) bins.push_back(b);
  }
  return bins;
}

const AxisWords& words_of(Axis axis) {
  static constexpr std::array<AxisWords, 6> kWords = {
      {{"frequency_hz", "frequency, Hz", "frequencies {} Hz"},
       {"amplitude", "amplitude of the input", "inputs from {}"},
       {"amplitude", "amplitude of the output", "outputs from {}"},
       {"time_s", "time, s", "times {} s"},
       {"branch", "branch (-1 falling, 1 rising)", "while the input is {}"},
       {"harmonic", "harmonic of the input's period", "harmonics {}"}}};
  return kWords.at(static_cast<std::size_t>(axis));
}

std::vector<Cell> where(const TimeRecord& record, const std::vector<double>& residual, std::size_t from,
                        std::size_t period) {
  std::vector<Cell> cells;
  const std::size_t n = residual.size();
  if (n < from + kBins) return cells;
  const std::vector<double> e(residual.begin() + static_cast<std::ptrdiff_t>(from), residual.end());
  const auto u = std::span(record.u).subspan(from, n - from);
  cells.push_back(densest(Axis::frequency, frequency_bins(e, record.step_s)));
  const auto add = [&](Axis axis, const std::vector<double>& signal) {
    const auto bins = even_bins(e, std::span(signal).subspan(from, n - from));
    if (!bins.empty()) cells.push_back(densest(axis, bins));
  };
  add(Axis::time, record.times_s());
  add(Axis::input, record.u);
  if (record.y.size() >= n) add(Axis::output, record.y);
  cells.push_back(densest(Axis::branch, branch_bins(e, u)));
  if (period > 0 && e.size() >= 2 * period)
    cells.push_back(densest(Axis::harmonic, harmonic_bins(e, period)));
  keep_telling(cells);
  return cells;
}

std::vector<Cell> where(const FrequencyRecord& record, const std::vector<double>& residual) {
  Bins bins;
  for (std::size_t i = 0; i < record.frequency.size(); ++i) {
    const double hz = record.frequency[i].value;
    bins.push_back(
        {hz, hz, residual[2 * i] * residual[2 * i] + residual[2 * i + 1] * residual[2 * i + 1], 1.0});
  }
  if (bins.empty()) return {};
  return {densest(Axis::frequency, bins)};
}

std::string to_text(const Cell& c) {
  std::string stretch = rounded_text(c.from, 3) + " to " + rounded_text(c.to, 3);
  if (c.axis == Axis::branch)
    stretch = c.from < c.to ? "changing" : c.to > 0.0 ? "rising" : c.to < 0.0 ? "falling" : "resting";
  return fmt::format(fmt::runtime(words_of(c.axis).stretch), stretch) +
         fmt::format(" ({:.0f} % of it)", 100.0 * c.share);
}

}  // namespace bodesmith::gap
