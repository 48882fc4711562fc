#include "gap/search/shortlist.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "base/error.hpp"
#include "gap/model/model_fit.hpp"
#include "gap/records/directions.hpp"
#include "gap/runner.hpp"
#include "gap/search_options.hpp"
#include "numeric/index.hpp"
#include "numeric/parallel_for.hpp"

namespace bodesmith::gap {
namespace {

using Vector = Eigen::VectorXd;

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
  const double step = LeastSquaresOptions().difference * (u.logarithmic ? value : u.scale);
  return value + step > u.high ? value - step : value + step;
}

/// The score of a proposal's every start that can be run, best first: by what it changes in the output; of the best ones by what their
/// unknowns would change further, too.
std::vector<StartScore> score_starts(const Proposal& proposal, const Experiments& records,
                                     const PresentModel& present) {
  Runner runner(proposal.model, records);
  auto values = proposal.model.values();
  const auto& unknowns = proposal.term().unknowns;
  const std::size_t first = values.size() - unknowns.size();
  std::vector<double> out;
  std::vector<double> moved;
  const auto scored = [&](std::size_t start, bool further) -> std::optional<StartScore> {
    std::copy(proposal.starts[start].begin(), proposal.starts[start].end(),
              values.begin() + static_cast<std::ptrdiff_t>(first));
    if (!runner(values, out)) return std::nullopt;
    Directions more = present.known;
    more.add(to_vector(as_eigen(out) - as_eigen(present.residuals)));
    for (std::size_t k = 0; further && k < unknowns.size(); ++k) {
      auto other = values;
      other[first + k] = moved_value(unknowns[k], values[first + k]);
      if (runner(other, moved)) more.add(to_vector(as_eigen(moved) - as_eigen(out)));
    }
    double along = 0.0;
    for (std::size_t d = present.known.all().size(); d < more.all().size(); ++d)
      along += std::pow(as_eigen(more.all()[d]).dot(present.unexplained), 2);
    // As its unknowns stand, those of the model refitted by linearisation.
    present.known.take_out(out);
    return StartScore{start, along / std::max(present.unexplained_energy, 1e-300),
                      as_eigen(out).squaredNorm()};
  };
  std::vector<StartScore> scores;
  for (std::size_t s = 0; s < proposal.starts.size(); ++s) {
    if (const auto one = scored(s, false)) scores.push_back(*one);
  }
  const auto by_score = [](const StartScore& a, const StartScore& b) { return a.score > b.score; };
  std::stable_sort(scores.begin(), scores.end(), by_score);
  for (auto& one : std::span(scores).first(std::min(kFew, scores.size())))
    one = scored(one.start, true).value_or(one);
  std::stable_sort(scores.begin(), scores.end(), by_score);
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

std::vector<Promising> shortlist(const Model& model, std::vector<Proposal> proposals,
                                 const Experiments& look) {
  auto out = residuals_of(model, look);
  std::vector<Promising> all;
  if (out.empty()) return all;
  PresentModel present;
  present.residuals = out;
  const Eigen::MatrixXd columns = sensitivities(model, look);
  for (Eigen::Index k = 0; k < columns.cols(); ++k) present.known.add(to_vector(columns.col(k)));
  present.known.take_out(out);
  present.unexplained = as_eigen(out);
  present.unexplained_energy = present.unexplained.squaredNorm();
  all.resize(proposals.size());
  parallel_for(proposals.size(), allowed_threads(), [&](std::size_t i) {
    auto& p = all[i];
    try {
      const auto scores = score_starts(proposals[i], look, present);
      for (const auto& s : scores) p.best_starts.push_back(s.start);
      p.score = scores.empty() ? 0.0 : scores.front().score;
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
