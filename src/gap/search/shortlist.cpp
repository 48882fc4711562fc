#include "gap/search/shortlist.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "gap/model/model_fit.hpp"
#include "gap/records/directions.hpp"
#include "gap/runner.hpp"
#include "numeric/index.hpp"
#include "numeric/parallel_for.hpp"

namespace bodesmith::gap {
namespace {

using Vector = Eigen::VectorXd;

/// With more starts than this the change itself is enough; with fewer, the unknowns' own directions are worth
/// their runs.
constexpr std::size_t kFewStarts = 6;
/// Step of an unknown for its own direction, as a part of it.
constexpr double kDirectionStep = 0.02;

/// What proposals are compared with.
struct PresentModel {
  std::vector<double> residuals;  ///< model - measured
  Directions known;               ///< what its own unknowns can change
  Vector unexplained;             ///< the residuals without that
  double unexplained_energy = 0.0;
};

struct StartScore {
  std::size_t start = 0;
  double score = 0.0;
  double left = 0.0;  ///< energy, at the start itself
};

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
  const auto& unknowns = proposal.term().unknowns;
  const std::size_t first = values.size() - unknowns.size();
  std::vector<double> out;
  std::vector<double> moved;
  for (std::size_t s = 0; s < proposal.starts.size(); ++s) {
    std::copy(proposal.starts[s].begin(), proposal.starts[s].end(),
              values.begin() + static_cast<std::ptrdiff_t>(first));
    if (!runner(values, out)) continue;
    Directions more = present.known;
    const Vector here = as_eigen(out);
    more.add(to_vector(here - as_eigen(present.residuals)));
    for (std::size_t k = 0; k < unknowns.size() && proposal.starts.size() <= kFewStarts; ++k) {
      auto other = values;
      other[first + k] = moved_value(unknowns[k], values[first + k]);
      if (runner(other, moved)) more.add(to_vector(as_eigen(moved) - here));
    }
    double along = 0.0;
    for (std::size_t d = present.known.all().size(); d < more.all().size(); ++d)
      along += std::pow(as_eigen(more.all()[d]).dot(present.unexplained), 2);
    const double score = present.unexplained_energy > 0.0 ? along / present.unexplained_energy : 0.0;
    // As its unknowns stand, those of the model refitted by linearisation.
    present.known.take_out(out);
    scores.push_back({s, score, as_eigen(out).squaredNorm()});
  }
  std::stable_sort(scores.begin(), scores.end(),
                   [](const StartScore& a, const StartScore& b) { return a.score > b.score; });
  // The second fit begins where least is left: it cannot lose its way, and what moves edges across samples has no direction in which it
  // could slide.
  if (scores.size() > 1) {
    const auto least =
        std::min_element(scores.begin() + 1, scores.end(),
                         [](const StartScore& a, const StartScore& b) { return a.left < b.left; });
    std::rotate(scores.begin() + 1, least, least + 1);
  }
  return scores;
}

}  // namespace

std::vector<Promising> shortlist(const Model& model, std::vector<Proposal> proposals, const Experiments& look,
                                 int threads) {
  auto out = residuals_of(model, look);
  std::vector<Promising> all;
  if (out.empty()) return all;
  PresentModel present;
  present.residuals = out;
  for (const auto& column : sensitivities(model, look)) {
    if (column.size() > 0) present.known.add(to_vector(column));
  }
  present.known.take_out(out);
  present.unexplained = as_eigen(out);
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
