#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "base/text.hpp"
#include "faults/diagnosis.hpp"
#include "numeric/index.hpp"

namespace bodesmith::faults {
namespace {

/// One added part serves several rivals when it leaves no more than this, percent.
constexpr double kServes = 2.0;
constexpr std::size_t kMostServed = 8;
constexpr int kTrials = 81;
/// ln of the added value over that of the part.
constexpr double kLeastAdded = -7.0;
constexpr double kMostAdded = 7.0;

double error_percent(const Eigen::VectorXcd& got, const Eigen::VectorXcd& wanted) {
  double worst = 0.0;
  for (Eigen::Index k = 0; k < got.size(); ++k) worst = std::max(worst, std::abs(got(k) / wanted(k) - 1.0));
  return 100.0 * worst;
}

struct Added {
  double factor = 1.0;
  double error = 1e300;
};

/// The value across one part with which the worst of the rivals' boards comes nearest to the good one.
Added best_across(const Board& board, std::size_t part, std::span<const Suspect> rivals,
                  const Eigen::VectorXcd& good) {
  Added best;
  const auto judge = [&](double factor) {
    const Effect change = board.in_parallel(part, factor);
    double worst = 0.0;
    for (const Suspect& rival : rivals)
      worst = std::max(worst, error_percent(board.response(joined(rival.best.effect(), change)), good));
    if (worst < best.error) best = {factor, worst};
  };
  const double step = (kMostAdded - kLeastAdded) / (kTrials - 1.0);
  for (int i = 0; i < kTrials; ++i) judge(std::exp(kLeastAdded + step * i));
  for (double span = step; span > 2e-3; span *= 0.5) {
    const double middle = best.factor;
    judge(middle * std::exp(0.5 * span));
    judge(middle * std::exp(-0.5 * span));
  }
  return best;
}

/// One part across another that mends the board whichever of the rivals is wrong.
std::optional<Rework> one_for_all(const Board& board, std::span<const Suspect> rivals) {
  const auto parts = board.soldered_parts();
  if (parts.empty() || rivals.size() < 2 || rivals.size() > kMostServed) return std::nullopt;
  const Eigen::VectorXcd good = board.response({});
  std::set<std::size_t> candidates;
  for (const Suspect& rival : rivals) {
    for (const Fault* fault : rival.best.faults)
      candidates.insert(fault->replaces.begin(), fault->replaces.end());
  }
  std::optional<Rework> out;
  for (const std::size_t part : candidates) {
    const Added best = best_across(board, part, rivals, good);
    if (best.error > kServes || (out && out->error_percent <= best.error)) continue;
    out = Rework{
        fmt::format("solder {} across {}: that brings the response to within {} % whichever of them is wrong",
                    engineering_text(parts[part].nominal * best.factor, parts[part].unit), parts[part].name,
                    rounded_text(best.error, 2)),
        1, best.error, Rework::Across{part, parts[part].nominal * best.factor}};
  }
  return out;
}

/// Every part that a tie accuses: exchanging all of them mends the board whichever is wrong.
Rework all_of(std::span<const Suspect> rivals) {
  std::vector<std::string> texts;
  for (const Suspect& rival : rivals) {
    for (const Fault* fault : rival.best.faults) {
      if (std::ranges::find(texts, fault->rework) == texts.end()) texts.push_back(fault->rework);
    }
  }
  return {join(texts, rivals.size() > 1 ? "; if that does not help, " : "; "), texts.size()};
}

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

std::vector<Rework> rework_for(const Board& board, std::span<const Suspect> rivals) {
  std::vector<Rework> out;
  if (rivals.empty()) return out;
  if (auto one = one_for_all(board, rivals)) out.push_back(std::move(*one));
  out.push_back(all_of(rivals));
  return out;
}

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
