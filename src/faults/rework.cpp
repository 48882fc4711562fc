#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "base/text.hpp"
#include "faults/diagnosis.hpp"

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
      if (std::find(texts.begin(), texts.end(), fault->rework) == texts.end()) texts.push_back(fault->rework);
    }
  }
  return {join(texts, rivals.size() > 1 ? "; if that does not help, " : "; "), texts.size()};
}

}  // namespace

std::vector<Rework> rework_for(const Board& board, std::span<const Suspect> rivals) {
  std::vector<Rework> out;
  if (rivals.empty()) return out;
  if (auto one = one_for_all(board, rivals)) out.push_back(std::move(*one));
  out.push_back(all_of(rivals));
  return out;
}

}  // namespace bodesmith::faults
