#include "gap/search/of_responses.hpp"

#include <algorithm>
#include <variant>

namespace bodesmith::gap {
namespace {

/// Fits of responses are quick, so that none is given up behind the leader; and curves that differ by less than this are
/// one, whatever they are called (a logarithmic creep, a fractional lag).
constexpr double kNeverBehind = 1e12;
constexpr double kSameCurve = 0.006;
/// Standard deviations where coherence makes the noise of all points alike; otherwise the points that carry a term may be
/// noisier than the others, which makes it look surer than it is.
constexpr double kSureOfWeighted = 3.5;

}  // namespace

SearchOptions for_responses(SearchOptions options, const Experiments& train) {
  const bool weighted = std::all_of(train.begin(), train.end(), [](const Experiment& e) {
    return !std::get<FrequencyExperiment>(e).weights().empty();
  });
  if (weighted)
    options.acceptance.min_significance = std::min(options.acceptance.min_significance, kSureOfWeighted);
  options.round.far_behind = options.round.behind = kNeverBehind;
  options.acceptance.tie_surely_within = std::max(options.acceptance.tie_surely_within, kSameCurve);
  return options;
}

}  // namespace bodesmith::gap
