#include <algorithm>
#include <cmath>

#include "faults/diagnosis.hpp"
#include "numeric/index.hpp"

namespace bodesmith::faults {
namespace {

using Complex = std::complex<double>;

constexpr std::size_t kMostRivals = 8;
/// A good board's node moves by about this much with its parts' tolerances and a probe's error.
constexpr double kTolerated = 0.012;
/// Nodes quieter than this (virtual grounds) show a probe nothing.
constexpr double kAudible = 3e-3;

struct Difference {
  double size = 0.0;  ///< |ln ratio|, phase in rad
  Complex ratio;      ///< ln
  std::size_t at = 0;
};

/// Where two predictions for a node differ most.
Difference difference_of(const Eigen::VectorXcd& a, const Eigen::VectorXcd& b) {
  Difference out;
  for (Eigen::Index k = 0; k < a.size(); ++k) {
    if (std::max(std::abs(a(k)), std::abs(b(k))) < kAudible) continue;
    const Complex floor = 0.1 * kAudible;
    const Complex ratio = std::log((a(k) + floor) / (b(k) + floor));
    if (std::abs(ratio) <= out.size) continue;
    out = {std::abs(ratio), ratio, std_index(k)};
  }
  return out;
}

}  // namespace

std::optional<Probe> next_probe(const Board& board, std::span<const Suspect> rivals) {
  rivals = rivals.first(std::min(rivals.size(), kMostRivals));
  std::optional<Probe> best;
  double most = 0.0;
  for (const std::string& node : board.probe_nodes()) {
    std::vector<Eigen::VectorXcd> seen;
    for (const Suspect& rival : rivals) seen.push_back(board.at_node(node, rival.best.effect()));
    // Each pair counts as far as it can be told at all; a node that separates all is worth more than one that
    // separates two of them by much.
    double told = 0.0;
    Probe probe;
    probe.node = node;
    Difference largest;
    for (std::size_t i = 0; i < rivals.size(); ++i) {
      for (std::size_t j = i + 1; j < rivals.size(); ++j) {
        const Difference d = difference_of(seen[i], seen[j]);
        const double weight = rivals[i].probability * rivals[j].probability;
        told += weight * std::min(d.size / kTolerated, 10.0);
        if (d.size > largest.size) largest = d;
        if (d.size > 3.0 * kTolerated)
          probe.tells_apart.push_back(rivals[i].site + " from " + rivals[j].site);
      }
    }
    if (!(told > most)) continue;
    most = told;
    probe.at = board.measured().channels.front().grid[largest.at];
    probe.db = std::abs(largest.ratio.real()) * kDecibelPerNeper;
    probe.deg = std::abs(to_degrees(largest.ratio.imag()));
    probe.factor = largest.size / kTolerated;
    best = std::move(probe);
  }
  if (best && best->tells_apart.empty()) best.reset();
  return best;
}

}  // namespace bodesmith::faults
