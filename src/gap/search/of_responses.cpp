#include "gap/search/of_responses.hpp"

namespace bodesmith::gap {
namespace {

/// Fits of responses are quick, so that none is given up behind the leader.
constexpr double kNeverBehind = 1e12;

}  // namespace

SearchOptions for_responses(SearchOptions options) {
  options.round.far_behind = options.round.behind = kNeverBehind;
  return options;
}

}  // namespace bodesmith::gap
