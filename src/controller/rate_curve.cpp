#include "controller/rate_curve.hpp"

#include <algorithm>
#include <cmath>

namespace bodesmith::controller {
namespace {

constexpr std::size_t kMostPieces = 12;  // to an interval of the table
constexpr int kCheckPoints = 24;         // to a piece

/// Greatest distance of the chord over a ratio of frequencies from ln f, for a rise of 1 in ln f.
double chord_error(double ratio) {
  const double h = std::log(ratio) / (ratio - 1.0);
  return h - 1.0 - std::log(h);
}

/// Corners strictly inside (low, high): the tracked frequencies when they are enough, otherwise equal ratios.
void add_inside(double low, double high, std::size_t pieces, const std::vector<Hertz>& tracked,
                std::vector<Hertz>& out) {
  std::vector<double> inside;
  for (const Hertz f : tracked) {
    if (f.value > low * 1.02 && f.value < high / 1.02) inside.push_back(f.value);
  }
  std::sort(inside.begin(), inside.end());
  if (inside.size() + 1 == pieces) {
    for (const double f : inside) out.push_back(Hertz{f});
    return;
  }
  for (std::size_t i = 1; i < pieces; ++i) {
    out.push_back(Hertz{low * std::pow(high / low, static_cast<double>(i) / static_cast<double>(pieces))});
  }
}

}  // namespace

double RateCurve::value(Disturbance::Branch which, Hertz frequency) const {
  const std::vector<double>& k = gain[which == Disturbance::Branch::ascending ? 0 : 1];
  if (frequency.value <= corner.front().value) return k.front();
  for (std::size_t i = 1; i < corner.size(); ++i) {
    if (frequency.value > corner[i].value) continue;
    const double t = (frequency.value - corner[i - 1].value) / (corner[i].value - corner[i - 1].value);
    return k[i - 1] + t * (k[i] - k[i - 1]);
  }
  return k.back();
}

RateCurve make_rate_curve(const Disturbance& disturbance, const double peak[2],
                          const std::vector<Hertz>& tracked, double tolerance_percent) {
  const std::vector<Hertz>& table = disturbance.rate.frequency;
  RateCurve out;
  out.corner.push_back(table.front());
  for (std::size_t i = 1; i < table.size(); ++i) {
    const double low = table[i - 1].value, high = table[i].value;
    double rise = 0.0;  // percent of range for one unit of ln f
    for (const int b : {0, 1}) {
      const std::vector<double>& k = b == 0 ? disturbance.rate.ascending : disturbance.rate.descending;
      rise = std::max(rise, 100.0 * peak[b] * std::abs(k[i] - k[i - 1]) / std::log(high / low));
    }
    std::size_t pieces = 1;
    while (pieces < kMostPieces &&
           rise * chord_error(std::pow(high / low, 1.0 / static_cast<double>(pieces))) > tolerance_percent)
      ++pieces;
    add_inside(low, high, pieces, tracked, out.corner);
    out.corner.push_back(table[i]);
  }
  for (const int b : {0, 1}) {
    const auto which = b == 0 ? Disturbance::Branch::ascending : Disturbance::Branch::descending;
    for (const Hertz f : out.corner) out.gain[b].push_back(disturbance.rate_gain(which, f));
    for (std::size_t i = 1; i < out.corner.size(); ++i) {
      const double ratio = out.corner[i].value / out.corner[i - 1].value;
      for (int j = 1; j < kCheckPoints; ++j) {
        const Hertz f{out.corner[i - 1].value * std::pow(ratio, static_cast<double>(j) / kCheckPoints)};
        out.max_error =
            std::max(out.max_error, std::abs(out.value(which, f) - disturbance.rate_gain(which, f)));
      }
    }
  }
  return out;
}

}  // namespace bodesmith::controller
