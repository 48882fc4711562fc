#include "circuit/parts/exchange.hpp"

#include <algorithm>
#include <random>

#include "base/progress.hpp"

namespace bodesmith::circuit {
namespace {

class Exchange {
 public:
  explicit Exchange(const std::vector<std::vector<StageCandidate>>& all) : all_(all) {
    points_ = all_.empty() || all_[0].empty() ? 0 : all_[0][0].error.size();
  }

  /// The best `count` choices of all starts, each once, best first.
  std::vector<std::vector<std::size_t>> best(std::size_t count) {
    std::vector<std::pair<double, std::vector<std::size_t>>> ends;
    std::mt19937_64 chance(20210901);  // fixed: the same parts every time
    const int starts = all_.size() == 1 ? static_cast<int>(count) : 24;
    for (int start = 0; start < starts; ++start) {
      std::vector<std::size_t> pick(all_.size(), 0);
      if (all_.size() == 1) {
        pick[0] = std::min<std::size_t>(static_cast<std::size_t>(start), all_[0].size() - 1);
        ends.emplace_back(worst_square(all_[0][pick[0]].error), pick);
        continue;
      }
      if (start > 0) {
        for (std::size_t i = 0; i < pick.size(); ++i) {
          pick[i] = chance() % std::min<std::size_t>(all_[i].size(), 1 + 4 * static_cast<std::size_t>(start));
        }
      }
      const double here = descend(pick);
      ends.emplace_back(here, pick);
    }
    std::sort(ends.begin(), ends.end());
    ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
    std::vector<std::vector<std::size_t>> out;
    for (std::size_t i = 0; i < ends.size() && i < count; ++i) out.push_back(ends[i].second);
    return out;
  }

 private:
  double descend(std::vector<std::size_t>& pick) const {
    std::vector<std::complex<double>> sum(points_, 0.0);
    for (std::size_t i = 0; i < pick.size(); ++i) {
      for (std::size_t k = 0; k < points_; ++k) sum[k] += all_[i][pick[i]].error[k];
    }
    double best = worst_square(sum);
    for (bool better = true; better;) {
      stop_if_interrupted();
      better = false;
      for (std::size_t i = 0; i < pick.size(); ++i) {
        if (i % 16 == 15) stop_if_interrupted();
        std::vector<std::complex<double>> rest = sum;
        for (std::size_t k = 0; k < points_; ++k) rest[k] -= all_[i][pick[i]].error[k];
        std::size_t chosen = pick[i];
        for (std::size_t c = 0; c < all_[i].size(); ++c) {
          double here = 0.0;
          const auto& error = all_[i][c].error;
          for (std::size_t k = 0; k < points_ && here < best; ++k)
            here = std::max(here, std::norm(rest[k] + error[k]));
          if (here < best * (1.0 - 1e-9)) {
            best = here;
            chosen = c;
            better = true;
          }
        }
        pick[i] = chosen;
        for (std::size_t k = 0; k < points_; ++k) sum[k] = rest[k] + all_[i][chosen].error[k];
      }
    }
    return best;
  }

  const std::vector<std::vector<StageCandidate>>& all_;
  std::size_t points_ = 0;
};

}  // namespace

std::vector<std::vector<std::size_t>> best_choices(const std::vector<std::vector<StageCandidate>>& all,
                                                   std::size_t count) {
  return Exchange(all).best(count);
}

}  // namespace bodesmith::circuit
