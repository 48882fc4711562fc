#include "faults/pairs.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <string>

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
/// Times that both sizes are looked for in turn, and how much finer the comb becomes each time.
constexpr int kTurns = 3;
constexpr double kFiner = 0.4;

struct TriedPair {
  Finding finding;
  double rough = 0.0;  ///< ln of density and prior, the first one's covariance
};

bool share_a_part(const Fault& a, const Fault& b) {
  return std::any_of(a.parts.begin(), a.parts.end(), [&](const std::string& part) {
    return std::find(b.parts.begin(), b.parts.end(), part) != b.parts.end();
  });
}

/// The best size of `second` beside a first fault as it was found.
TriedPair beside(const Board& board, const Finding& first, const Likelihood& likelihood,
                 const Fault& second) {
  TriedPair best;
  best.rough = -1e300;
  const Effect effect = first.effect();
  for (const double t : comb(second, kTeethOfSecond)) {
    const Eigen::VectorXcd response = board.response(joined(effect, second.effect(t)));
    const double density = likelihood.log_density_of(residual_of(board, response).rows());
    if (!(density > best.rough)) continue;
    best.rough = density;
    best.finding.sizes = {first.sizes[0], t};
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
      const Effect other = pair.finding.faults[1 - which]->effect(pair.finding.sizes[1 - which]);
      const double middle = pair.finding.sizes[which];
      for (const double tooth : comb(fault, kTeethOfSecond)) {
        const double centre = 0.5 * (fault.from + fault.to);
        const double t = std::clamp(middle + part * (tooth - centre), fault.from, fault.to);
        const Effect here = fault.effect(t);
        const Effect both = which == 0 ? joined(here, other) : joined(other, here);
        const double density = likelihood.log_density_of(residual_of(board, board.response(both)).rows());
        if (!(density + pair.finding.log_prior > pair.rough)) continue;
        pair.rough = density + pair.finding.log_prior;
        pair.finding.sizes[which] = t;
      }
    }
  }
}

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

  /// A first fault of a given size with every other, the best of them with both sizes free.
  void try_first(const Finding& first) {
    const Likelihood likelihood(board_, board_.predict(first.effect()), noise_);
    std::vector<TriedPair> here;
    for (const Fault& fault : faults_) {
      if (share_a_part(*first.faults[0], fault)) continue;
      TriedPair pair = beside(board_, first, likelihood, fault);
      if (pair.finding.sizes.empty()) continue;
      pair.finding.log_prior = log_prior_of_two_ + prior_of(*first.faults[0]) + prior_of(fault);
      pair.rough += pair.finding.log_prior;
      here.push_back(std::move(pair));
    }
    std::stable_sort(here.begin(), here.end(), better);
    here.resize(std::min(here.size(), kSecondsOfEach));
    for (TriedPair& pair : here) {
      resize(board_, likelihood, pair);
      tried_.push_back(std::move(pair));
    }
  }

  /// Best first.
  std::vector<TriedPair> tried() const {
    std::vector<TriedPair> out = tried_;
    std::stable_sort(out.begin(), out.end(), better);
    return out;
  }

 private:
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
  std::size_t firsts = 0;
  std::map<std::string, int> kinds_of;
  std::set<const Fault*> were_first;
  for (const Finding& first : singles) {
    if (first.faults.size() != 1 || kinds_of[first.site()]++ >= kKindsOfSite) continue;
    if (firsts++ == kFirsts) break;
    were_first.insert(first.faults[0]);
    search.try_first(first);
  }
  // One of two faults may stand out only beside the other one: what did best as a second one is tried as a first one, of the
  // size that it had.
  std::size_t turned = 0;
  for (const TriedPair& pair : search.tried()) {
    if (turned == kTurned) break;
    if (!were_first.insert(pair.finding.faults[1]).second) continue;
    Finding first;
    first.faults = {pair.finding.faults[1]};
    first.sizes = {pair.finding.sizes[1]};
    search.try_first(first);
    ++turned;
  }
  std::vector<Finding> out;
  std::set<std::set<const Fault*>> known;
  for (const TriedPair& pair : search.tried()) {
    if (out.size() == kPolished) break;
    if (!known.insert({pair.finding.faults.begin(), pair.finding.faults.end()}).second) continue;
    out.push_back(polished(board, pair.finding, noise));
  }
  return out;
}

}  // namespace bodesmith::faults
