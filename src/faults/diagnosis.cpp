#include "faults/diagnosis.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "base/error.hpp"
#include "faults/pairs.hpp"
#include "numeric/index.hpp"

namespace bodesmith::faults {
namespace {

/// A board is accused when nothing wrong is less likely than this.
constexpr double kAccuse = 0.01;
/// Between that and this it is said to be uncertain.
constexpr double kDoubt = 0.5;
/// One suspect is named when it has so much of what accuses; otherwise as many as have together so much.
constexpr double kNamed = 0.95;
constexpr double kTied = 0.98;
/// Those below this share of the first are not tied with it, whatever the sum.
constexpr double kLeastOfTie = 0.02;
/// An explanation fits when what it leaves is so many standard deviations above its expectation at most, and within
/// this factor of it.
constexpr double kFits = 6.0;
constexpr double kFitsWithin = 1.6;
/// Two faults are tried when good parts leave this much.
constexpr double kTryTwo = 2.5;
/// Explanations this far (ln) behind the best are not looked at again.
constexpr double kHopeless = 30.0;
constexpr std::size_t kAlwaysLooked = 8;
/// Everything is fitted again when the noise turned out so much smaller.
constexpr double kNoiseAgain = 1.25;

void sort_findings(std::vector<Finding>& findings) {
  std::ranges::stable_sort(
      findings, [](const Finding& a, const Finding& b) { return a.log_weight() > b.log_weight(); });
}

/// The search: everything that may explain the measurement, with its weight.
class BoardSearch {
 public:
  BoardSearch(const Board& board, const std::vector<Fault>& faults, const DiagnosisOptions& options)
      : board_(board), faults_(faults), options_(options), log_priors_(log_priors(faults)) {}

  std::vector<Finding> run() {
    set_noise(residual_of(board_, board_.response({})));
    std::vector<Finding> findings = singles(0.0, 0.5);
    const Noise first = noise_;
    set_noise(left_by(findings.front()));
    if (first.gain > kNoiseAgain * noise_.gain || first.phase > kNoiseAgain * noise_.phase)
      findings = singles(0.5, 0.9);
    const std::vector<Finding> alone = findings;
    const bool two_tried = leaves_room_for_two(findings);
    if (two_tried) add_pairs(alone, findings);
    look_closely(findings);
    // The noise was taken from what the best one left: a peak that it misses looks like noise, and only a close look shows
    // that it does not fit.
    if (!two_tried && leaves_room_for_two(findings)) {
      add_pairs(alone, findings);
      look_closely(findings);
    }
    return findings;
  }

  const Noise& noise() const { return noise_; }
  /// Standard deviations by which an explanation's misfit is above its expectation.
  static double excess(const Finding& finding) {
    return (finding.misfit - finding.rows) / std::sqrt(2.0 * std::max(finding.rows, 1.0));
  }

 private:
  /// Whether two faults are to be tried: something is wrong (a fault that is known roughly fits much that is two others, and
  /// how much less likely it is, only these say); or the best explanation is parts spread wider than stated, which says
  /// little and which two faults look like; or good parts leave too much.
  static bool leaves_room_for_two(const std::vector<Finding>& sorted) {
    const Finding& best = sorted.front();
    return !best.faults.empty() || best.part_spread > 1.0 || excess(best) > kTryTwo;
  }

  /// Two at once, of which one is among `alone`; the noise then as the best explanation leaves it.
  void add_pairs(const std::vector<Finding>& alone, std::vector<Finding>& findings) {
    const std::vector<Finding> two =
        pairs_of(board_, alone, faults_, log_priors_, std::log(options_.priors.two_faults), noise_);
    findings.insert(findings.end(), two.begin(), two.end());
    sort_findings(findings);
    set_noise(left_by(findings.front()));
  }

  /// What is not hopeless, fitted to the end.
  void look_closely(std::vector<Finding>& findings) const {
    const double best = findings.front().log_weight();
    // One fault alone may have lost by the linear form only: the likeliest of them are always looked at.
    std::size_t alone = 0;
    std::erase_if(findings, [&](const Finding& f) {
      if (f.faults.empty() || (f.faults.size() == 1 && alone++ < kAlwaysLooked)) return false;
      return f.log_weight() < best - kHopeless;
    });
    for (Finding& finding : findings) {
      finding = refined(board_, polished(board_, std::move(finding), noise_), faults_, noise_);
    }
    sort_findings(findings);
  }

  void set_noise(const Residual& left) {
    noise_ = rough_noise(board_.measured(), left.gain, left.phase, board_.floors());
    if (options_.gain_noise) noise_.gain = *options_.gain_noise;
    if (options_.phase_noise) noise_.phase = *options_.phase_noise;
  }

  Residual left_by(const Finding& finding) const {
    const Prediction prediction = board_.predict(finding.effect());
    const Likelihood likelihood(board_, prediction, noise_, finding.part_spread);
    const Eigen::VectorXd rows = likelihood.remaining();
    Residual out = residual_of(board_, prediction.response);
    Eigen::Index row = 0;
    for (double& value : out.gain) value = rows(row++);
    for (std::size_t k = 0; k < out.phase.size(); ++k) {
      if (out.has_phase[k] != 0) out.phase[k] = rows(row++);
    }
    return out;
  }

  std::vector<Finding> singles(double from, double to) const {
    std::vector<Finding> out;
    const double share = 1.0 - 2.0 * options_.priors.wider_share;
    out.push_back(fitted(board_, {}, std::log(options_.priors.good * share), noise_));
    for (const double spread : options_.priors.wider_spread) {
      Finding wider;
      wider.part_spread = spread;
      wider.log_prior = std::log(options_.priors.good * options_.priors.wider_share);
      out.push_back(polished(board_, std::move(wider), noise_));
    }
    for (std::size_t i = 0; i < faults_.size(); ++i) {
      if (options_.stop()) throw Interrupted();
      options_.progress(from + (to - from) * static_cast<double>(i) / static_cast<double>(faults_.size()));
      out.push_back(
          fitted(board_, {&faults_[i]}, std::log(options_.priors.one_fault) + log_priors_[i], noise_));
    }
    sort_findings(out);
    return out;
  }

  const Board& board_;
  const std::vector<Fault>& faults_;
  const DiagnosisOptions& options_;
  std::vector<double> log_priors_;
  Noise noise_;
};

/// Probabilities from weights, summed by site and by part.
void share_out(const Board& board, const std::vector<Finding>& findings, Diagnosis& out) {
  const double best = findings.front().log_weight();
  double sum = 0.0;
  for (const Finding& f : findings) sum += std::exp(f.log_weight() - best);
  out.log_evidence = best + std::log(sum);
  std::map<std::string, std::size_t> by_site;
  std::map<std::string, double> by_part;
  for (const Finding& f : findings) {
    const double probability = std::exp(f.log_weight() - best) / sum;
    if (f.faults.empty()) {
      out.good_probability += probability;
      if (f.part_spread > 1.0) out.wider_probability += probability;
      continue;
    }
    const auto [at, is_new] = by_site.try_emplace(f.site(), out.suspects.size());
    if (is_new)
      out.suspects.push_back(
          {f.site(), 0.0, f, std::ranges::max(differences_percent(board, board.response(f.effect())))});
    out.suspects[at->second].probability += probability;
    for (const Fault* fault : f.faults) {
      for (const std::string& part : fault->parts) by_part[part] += probability;
    }
  }
  std::ranges::stable_sort(out.suspects, std::ranges::greater(), &Suspect::probability);
  out.parts.assign(by_part.begin(), by_part.end());
  std::ranges::stable_sort(out.parts, [](const auto& a, const auto& b) { return a.second > b.second; });
}

std::size_t tied_count(const Diagnosis& d) {
  const double accused = 1.0 - d.good_probability;
  if (d.suspects.empty()) return 0;
  if (d.suspects[0].probability >= kNamed * accused) return 1;
  double sum = 0.0;
  std::size_t count = 0;
  while (count < d.suspects.size() && sum < kTied * accused &&
         (count == 0 || d.suspects[count].probability > kLeastOfTie * d.suspects[0].probability))
    sum += d.suspects[count++].probability;
  return count;
}

/// Relative change of the response, above what counts as nothing, that no tolerance and no noise hides.
constexpr double kSeen = 0.05;
constexpr int kSizesTried = 5;

bool shows(const Board& board, const Eigen::VectorXcd& a, const Eigen::VectorXcd& b) {
  for (Eigen::Index k = 0; k < a.size(); ++k) {
    if (std::abs(a(k) - b(k)) > kSeen * (std::abs(b(k)) + board.floors()[std_index(k)])) return true;
  }
  return false;
}

/// The parts of which some wrong value changes what a board with `there` shows.
std::set<std::string> parts_seen(const Board& board, const std::vector<Fault>& faults, const Effect& there) {
  const std::unique_ptr<ChangedBoard> changed = board.changed_by(there);
  const Eigen::VectorXcd before = changed->response({});
  std::set<std::string> out;
  for (const Fault& fault : faults) {
    // Of a single part that can be exchanged: a place is no part, and an op-amp is seen through its stage's parts. Values
    // alone: an op-amp without feedback would shine through a dead stage as no real one does.
    if (fault.parts.size() != 1 || fault.replaces.empty() || !fault.has_size() ||
        out.contains(fault.parts[0]))
      continue;
    for (const double t : comb(fault, kSizesTried)) {
      if (!shows(board, changed->response(fault.effect(t)), before)) continue;
      out.insert(fault.parts[0]);
      break;
    }
  }
  return out;
}

}  // namespace

const char* to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::nothing_wrong:
      return "nothing_wrong";
    case Verdict::uncertain:
      return "uncertain";
    case Verdict::one_fault:
      return "one_fault";
    case Verdict::two_faults:
      return "two_faults";
    case Verdict::tie:
      return "tie";
    case Verdict::unexplained:
      break;
  }
  return "unexplained";
}

Diagnosis diagnose_board(const Board& board, const DiagnosisOptions& options) {
  Diagnosis out;
  out.faults = board.faults();
  BoardSearch search(board, out.faults, options);
  const std::vector<Finding> findings = search.run();
  out.noise = search.noise();
  out.tried = out.faults.size();
  out.misfit = findings.front().misfit / std::max(findings.front().rows, 1.0);
  share_out(board, findings, out);
  out.tied = tied_count(out);
  const bool fits = BoardSearch::excess(findings.front()) < kFits || out.misfit < kFitsWithin;
  if (!fits) {
    out.verdict = Verdict::unexplained;
  } else if (out.suspects.empty() || out.good_probability > kAccuse) {
    out.verdict = out.good_probability > kDoubt ? Verdict::nothing_wrong : Verdict::uncertain;
  } else if (out.tied > 1) {
    out.verdict = Verdict::tie;
  } else {
    out.verdict = out.suspects[0].best.faults.size() > 1 ? Verdict::two_faults : Verdict::one_fault;
  }
  if (out.verdict == Verdict::tie) out.probe = next_probe(board, std::span(out.suspects).first(out.tied));
  if (out.verdict == Verdict::tie || out.verdict == Verdict::one_fault ||
      out.verdict == Verdict::two_faults) {
    const std::span<const Suspect> rivals = std::span(out.suspects).first(out.tied);
    out.rework = rework_for(board, rivals);
    out.hidden = hidden_behind(board, out.faults, rivals);
  }
  return out;
}

std::vector<double> log_priors(const std::vector<Fault>& faults) {
  std::map<const FaultKind*, int> counts;
  for (const Fault& fault : faults) ++counts[fault.kind];
  double sum = 0.0;
  for (const auto& [kind, count] : counts) sum += kind->prior();
  std::vector<double> out;
  for (const Fault& fault : faults) out.push_back(std::log(fault.kind->prior() / (sum * counts[fault.kind])));
  return out;
}

std::vector<std::string> hidden_behind(const Board& board, const std::vector<Fault>& faults,
                                       std::span<const Suspect> rivals) {
  std::set<std::string> hidden = parts_seen(board, faults, {});
  for (const Suspect& rival : rivals) {
    if (hidden.empty()) break;
    for (const std::string& part : parts_seen(board, faults, rival.best.effect())) hidden.erase(part);
    for (const Fault* fault : rival.best.faults) {
      for (const std::string& part : fault->parts) hidden.erase(part);
    }
  }
  return {hidden.begin(), hidden.end()};
}

}  // namespace bodesmith::faults
