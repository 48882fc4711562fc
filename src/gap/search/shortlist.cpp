#include "gap/search/shortlist.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "gap/runner.hpp"
#include "numeric/index.hpp"
#include "numeric/parallel_for.hpp"

namespace bodesmith::gap {
namespace {

using Vector = Eigen::VectorXd;

/// A direction that others explain but for this part of it is none of its own.
constexpr double kMinOwnDirection = 1e-5;
/// With more starts than this the change itself is enough; with fewer, the unknowns' own directions are worth
/// their runs.
constexpr std::size_t kFewStarts = 6;
/// Step of an unknown for its own direction, as a part of it.
constexpr double kDirectionStep = 0.02;

/// Orthonormal directions built one at a time; nearly dependent ones are left out.
class Span {
 public:
  void add(Vector v) {
    const double size = v.norm();
    if (!(size > 0.0) || !std::isfinite(size)) return;
    v /= size;
    for (int twice = 0; twice < 2; ++twice) v = without(std::move(v));
    const double left = v.norm();
    if (left < kMinOwnDirection) return;
    directions_.push_back(v / left);
  }
  Vector without(Vector v) const {
    for (const auto& d : directions_) v -= d * d.dot(v);
    return v;
  }
  /// The part of v along the directions from number `first` on.
  Vector along(const Vector& v, std::size_t first) const {
    Vector part = Vector::Zero(v.size());
    for (std::size_t d = first; d < directions_.size(); ++d) part += directions_[d] * directions_[d].dot(v);
    return part;
  }
  std::size_t size() const { return directions_.size(); }

 private:
  std::vector<Vector> directions_;
};

/// What proposals are compared with.
struct PresentModel {
  Vector residuals;     ///< model - measured
  Span known;           ///< what its own unknowns can change
  Vector unexplained;   ///< the residuals without that
  double energy = 0.0;  ///< of the residuals
  double unexplained_energy = 0.0;
  /// Residuals are logarithms: a delay of any size then promises the same, and the nearest start is the best.
  bool logarithmic = false;
};

struct StartScore {
  std::size_t start = 0;
  double score = 0.0;
  double left = 0.0;  ///< of the energy, at the start itself
};

/// Starts whose scores differ by less than this are told apart by how near they are.
constexpr double kNearness = 0.02;

double merit(const StartScore& s) {
  return s.score - kNearness * std::min(1.0, s.left);
}

double moved_value(const Unknown& u, double value) {
  const double step = kDirectionStep * (u.logarithmic ? value : u.scale);
  return value + step > u.high ? value - step : value + step;
}

/// The score of a proposal's every start that can be run, best first.
std::vector<StartScore> score_starts(const Proposal& proposal, const Experiments& records,
                                     const PresentModel& present) {
  std::vector<StartScore> scores;
  Runner runner(proposal.model, records);
  auto values = current_values(proposal.model);
  const auto& unknowns = proposal.model.terms().back().unknowns;
  const std::size_t first = values.size() - unknowns.size();
  std::vector<double> out;
  std::vector<double> moved;
  for (std::size_t s = 0; s < proposal.starts.size(); ++s) {
    std::copy(proposal.starts[s].begin(), proposal.starts[s].end(),
              values.begin() + static_cast<std::ptrdiff_t>(first));
    if (!runner(values, out)) continue;
    Span more = present.known;
    const Vector here = as_eigen(out);
    more.add(here - present.residuals);
    for (std::size_t k = 0; k < unknowns.size() && proposal.starts.size() <= kFewStarts; ++k) {
      auto other = values;
      other[first + k] = moved_value(unknowns[k], values[first + k]);
      if (runner(other, moved)) more.add(as_eigen(moved) - here);
    }
    const Vector part = more.along(present.unexplained, present.known.size());
    const double score =
        present.unexplained_energy > 0.0 ? part.squaredNorm() / present.unexplained_energy : 0.0;
    scores.push_back({s, score, present.energy > 0.0 ? here.squaredNorm() / present.energy : 0.0});
  }
  std::stable_sort(scores.begin(), scores.end(), [&](const StartScore& a, const StartScore& b) {
    return present.logarithmic ? merit(a) > merit(b) : a.score > b.score;
  });
  // What moves edges across samples has no direction in which a fit could slide: where it leaves least is where it is.
  const bool edges =
      std::any_of(unknowns.begin(), unknowns.end(), [](const Unknown& u) { return u.hop > 0.0; });
  if (edges && !scores.empty()) {
    const auto least =
        std::min_element(scores.begin(), scores.end(),
                         [](const StartScore& a, const StartScore& b) { return a.left < b.left; });
    std::rotate(scores.begin(), least, least + 1);
  }
  return scores;
}

}  // namespace

std::vector<Promising> shortlist(const Model& model, std::vector<Proposal> proposals, const Experiments& look,
                                 int threads) {
  Runners runner(model, look);
  const auto values = current_values(model);
  std::vector<double> out;
  std::vector<Promising> all;
  if (!runner(values, out)) return all;
  PresentModel present;
  present.residuals = as_eigen(out);
  present.energy = present.residuals.squaredNorm();
  present.logarithmic = are_responses(look);
  const auto residuals = [&](std::span<const double> v, std::vector<double>& o) { return runner(v, o); };
  for (const auto& column : sensitivities(model.unknowns(), residuals, values, runner.threads())) {
    if (!column.empty()) present.known.add(as_eigen(column));
  }
  present.unexplained = present.known.without(present.residuals);
  present.unexplained_energy = present.unexplained.squaredNorm();
  all.resize(proposals.size());
  parallel_for(proposals.size(), threads, [&](std::size_t i) {
    auto& p = all[i];
    try {
      const auto scores = score_starts(proposals[i], look, present);
      for (const auto& s : scores) p.best_starts.push_back(s.start);
      for (const auto& s : scores) p.score = std::max(p.score, s.score);
    } catch (const InputError&) {
      p.score = 0.0;  // a chain that cannot be run at its start values is no candidate
    }
    p.proposal = std::move(proposals[i]);
  });
  std::erase_if(all, [](const Promising& p) { return p.best_starts.empty(); });
  std::stable_sort(all.begin(), all.end(),
                   [](const Promising& a, const Promising& b) { return a.score > b.score; });
  return all;
}

}  // namespace bodesmith::gap
