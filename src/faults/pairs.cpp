#include "faults/pairs.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <memory>
#include <set>
#include <string>

#include "numeric/parallel_for.hpp"

namespace bodesmith::faults {
namespace {

constexpr std::size_t kFirsts = 32;
/// Of them, of one part: it may be open as well as of another value.
constexpr int kKindsOfSite = 2;
/// Of one first fault, so that all the best pairs are not those of the same one.
constexpr std::size_t kSecondsOfEach = 16;
/// Seconds that are tried as firsts in their turn.
constexpr std::size_t kTurned = 12;
constexpr std::size_t kPolished = 64;
constexpr int kTeethOfSecond = 13;
constexpr int kHalvings = 4;
/// Pairs this near to the best (ln) lend their sites, so many at most, to all pairs of them.
constexpr double kNearBest = 20.0;
constexpr std::size_t kSitesClosed = 6;
/// Times that both sizes are looked for in turn, and how much finer the comb becomes each time.
constexpr int kTurns = 3;
constexpr double kFiner = 0.4;

/// Model error of a second fault that is known roughly.
constexpr double kRoughSecond = 0.02;

struct TriedPair {
  Finding finding;
  double rough = 0.0;  ///< ln of density and prior, the first one's covariance
};

bool names_any(const Fault& fault, const std::vector<std::string>& parts) {
  return std::ranges::any_of(
      fault.parts, [&](const std::string& part) { return std::ranges::find(parts, part) != parts.end(); });
}

bool share_a_part(const Fault& a, const Fault& b) {
  return names_any(a, b.parts) || names_any(a, b.covers) || names_any(b, a.covers);
}

/// The best size of `second` alongside a first fault as it was found.
TriedPair best_second(const Board& board, const ChangedBoard& changed, const Finding& first,
                      const Likelihood& likelihood, const Fault& second) {
  TriedPair best;
  best.rough = -1e300;
  const auto try_size = [&](double t) {
    const Eigen::VectorXcd response = changed.response(second.effect(t));
    const double density = likelihood.log_density_of(residual_of(board, response).rows());
    if (!(density > best.rough)) return;
    best.rough = density;
    best.finding.sizes = {first.sizes[0], t};
  };
  for (const double t : comb(second, kTeethOfSecond)) try_size(t);
  // Between the teeth: a slow op-amp that is off by half a tooth is off by more than any other fault's effect.
  double step = 0.5 * (second.to - second.from) / (kTeethOfSecond - 1);
  for (int halved = 0; second.has_size() && halved < kHalvings && !best.finding.sizes.empty();
       ++halved, step *= 0.5) {
    const double middle = best.finding.sizes[1];
    for (const double t : {middle - step, middle + step}) {
      if (t >= second.from && t <= second.to) try_size(t);
    }
  }
  best.finding.faults = {first.faults[0], &second};
  return best;
}

/// Both sizes, in turn, each on an ever finer comb around where it is: a first fault that was sized alone made up for the
/// second one too.
void resize(const Board& board, const Likelihood& likelihood, TriedPair& pair) {
  double part = 1.0;
  for (int turn = 0; turn < kTurns; ++turn, part *= kFiner) {
    for (std::size_t which = 0; which < 2; ++which) {
      const Fault& fault = *pair.finding.faults[which];
      if (!fault.has_size()) continue;
      const std::unique_ptr<ChangedBoard> with_other =
          board.changed_by(pair.finding.faults[1 - which]->effect(pair.finding.sizes[1 - which]));
      const double middle = pair.finding.sizes[which];
      for (const double tooth : comb(fault, kTeethOfSecond)) {
        const double centre = 0.5 * (fault.from + fault.to);
        const double t = std::clamp(middle + part * (tooth - centre), fault.from, fault.to);
        const double density =
            likelihood.log_density_of(residual_of(board, with_other->response(fault.effect(t))).rows());
        if (!(density + pair.finding.log_prior > pair.rough)) continue;
        pair.rough = density + pair.finding.log_prior;
        pair.finding.sizes[which] = t;
      }
    }
  }
}

using KnownPairs = std::set<std::set<const Fault*>>;

bool better(const TriedPair& a, const TriedPair& b) {
  return a.rough > b.rough;
}

/// All pairs that are tried, and what they are tried with.
class PairSearch {
 public:
  PairSearch(const Board& board, const std::vector<Fault>& faults, const std::vector<double>& log_priors,
             double log_prior_of_two, const Noise& noise)
      : board_(board),
        faults_(faults),
        log_priors_(log_priors),
        log_prior_of_two_(log_prior_of_two),
        noise_(noise) {}

  /// Each first fault, of the size that it was found with, with every other.
  void try_firsts(const std::vector<Finding>& firsts) {
    std::vector<std::vector<TriedPair>> of_each(firsts.size());
    parallel_for(firsts.size(), thread_count(0), [&](std::size_t i) { of_each[i] = with_first(firsts[i]); });
    for (std::vector<TriedPair>& pairs : of_each) std::ranges::move(pairs, std::back_inserter(tried_));
  }

  /// Of three values of which any two explain the same, A with B and A with C may be found and B with C not, far away in both
  /// sizes: the sites of the likeliest pairs, each with each, over all sizes of both.
  void close(KnownPairs& known, std::vector<Finding>& found) const {
    if (found.empty()) return;
    std::ranges::stable_sort(
        found, [](const Finding& a, const Finding& b) { return a.log_weight() > b.log_weight(); });
    const double least = found.front().log_weight() - kNearBest;
    std::vector<std::string> sites;
    for (const Finding& finding : found) {
      if (finding.log_weight() < least) break;
      for (const Fault* fault : finding.faults) {
        if (sites.size() < kSitesClosed && std::ranges::find(sites, fault->site) == sites.end())
          sites.push_back(fault->site);
      }
    }
    std::vector<const Fault*> sized;
    for (const Fault& fault : faults_) {
      if (fault.has_size() && !fault.replaces.empty() && std::ranges::find(sites, fault.site) != sites.end())
        sized.push_back(&fault);
    }
    const Likelihood likelihood(board_, board_.predict(found.front().effect()), noise_);
    for (std::size_t i = 0; i < sized.size(); ++i) {
      std::vector<std::unique_ptr<ChangedBoard>> with_first;
      const std::vector<double> teeth = comb(*sized[i], kTeethOfSecond);
      for (const double t : teeth) with_first.push_back(board_.changed_by(sized[i]->effect(t)));
      for (std::size_t j = i + 1; j < sized.size(); ++j) {
        if (share_a_part(*sized[i], *sized[j]) || !known.insert({sized[i], sized[j]}).second) continue;
        TriedPair best;
        best.rough = -1e300;
        for (std::size_t a = 0; a < teeth.size(); ++a) {
          Finding first{.faults = {sized[i]}, .sizes = {teeth[a]}};
          TriedPair pair = best_second(board_, *with_first[a], first, likelihood, *sized[j]);
          if (pair.rough > best.rough) best = std::move(pair);
        }
        if (best.finding.sizes.empty()) continue;
        best.finding.log_prior = log_prior_of_two_ + prior_of(*sized[i]) + prior_of(*sized[j]);
        best.rough += best.finding.log_prior;
        resize(board_, likelihood, best);
        Finding polished_pair = polished(board_, best.finding, noise_);
        if (polished_pair.log_weight() > least) found.push_back(std::move(polished_pair));
      }
    }
  }

  /// Best first.
  std::vector<TriedPair> tried() const {
    std::vector<TriedPair> out = tried_;
    std::ranges::stable_sort(out, better);
    return out;
  }

 private:
  /// The best seconds of a first fault, both sizes free.
  std::vector<TriedPair> with_first(const Finding& first) const {
    Prediction prediction = board_.predict(first.effect());
    const Likelihood exact(board_, prediction, noise_);
    // A second fault that is known roughly is not judged by what even the right one would leave: its model's error, as if
    // it changed everything by a factor of e.
    prediction.model_error = std::max(prediction.model_error, kRoughSecond);
    prediction.reference = prediction.response * std::exp(-1.0);
    const Likelihood rough(board_, prediction, noise_);
    const std::unique_ptr<ChangedBoard> changed = board_.changed_by(first.effect());
    const auto likelihood_of = [&](const Fault& fault) -> const Likelihood& {
      return fault.effect(fault.from).model_error > 0.0 ? rough : exact;
    };
    std::vector<TriedPair> here;
    for (const Fault& fault : faults_) {
      if (share_a_part(*first.faults[0], fault)) continue;
      TriedPair pair = best_second(board_, *changed, first, likelihood_of(fault), fault);
      if (pair.finding.sizes.empty()) continue;
      pair.finding.log_prior = log_prior_of_two_ + prior_of(*first.faults[0]) + prior_of(fault);
      pair.rough += pair.finding.log_prior;
      here.push_back(std::move(pair));
    }
    std::ranges::stable_sort(here, better);
    here.resize(std::min(here.size(), kSecondsOfEach));
    for (TriedPair& pair : here) resize(board_, likelihood_of(*pair.finding.faults[1]), pair);
    return here;
  }

  double prior_of(const Fault& fault) const {
    return log_priors_[static_cast<std::size_t>(&fault - faults_.data())];
  }

  const Board& board_;
  const std::vector<Fault>& faults_;
  const std::vector<double>& log_priors_;
  double log_prior_of_two_;
  const Noise& noise_;
  std::vector<TriedPair> tried_;
};

}  // namespace

std::vector<Finding> pairs_of(const Board& board, const std::vector<Finding>& singles,
                              const std::vector<Fault>& faults, const std::vector<double>& log_priors,
                              double log_prior_of_two, const Noise& noise) {
  PairSearch search(board, faults, log_priors, log_prior_of_two, noise);
  std::vector<Finding> firsts;
  std::map<std::string, int> kinds_of;
  std::set<const Fault*> were_first;
  for (const Finding& first : singles) {
    if (first.faults.size() != 1 || kinds_of[first.site()]++ >= kKindsOfSite) continue;
    if (firsts.size() == kFirsts) break;
    were_first.insert(first.faults[0]);
    firsts.push_back(first);
  }
  search.try_firsts(firsts);
  // One of two faults may stand out only alongside the other one: what did best as a second one is tried as a first one, of the
  // size that it had.
  std::vector<Finding> turned;
  for (const TriedPair& pair : search.tried()) {
    if (turned.size() == kTurned) break;
    if (were_first.insert(pair.finding.faults[1]).second)
      turned.push_back({.faults = {pair.finding.faults[1]}, .sizes = {pair.finding.sizes[1]}});
  }
  search.try_firsts(turned);
  std::vector<Finding> out;
  KnownPairs known;
  for (const TriedPair& pair : search.tried()) {
    if (out.size() == kPolished) break;
    if (known.insert({pair.finding.faults.begin(), pair.finding.faults.end()}).second)
      out.push_back(pair.finding);
  }
  parallel_for(out.size(), thread_count(0), [&](std::size_t i) { out[i] = polished(board, out[i], noise); });
  search.close(known, out);
  return out;
}

}  // namespace bodesmith::faults
