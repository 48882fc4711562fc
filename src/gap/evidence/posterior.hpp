#pragma once

#include <string>
#include <vector>

#include "gap/evidence/names.hpp"

namespace bodesmith::gap {

/// Names that may be what is missing, and the probability that they are, of the sets that the search fitted.
struct NamedSet {
  std::vector<std::string> effects;
  double probability = 0.0;
};

struct Posterior {
  std::vector<double> among_names;     ///< probability of each step's name, were the catalogue all there is
  std::vector<NamedSet> alternatives;  ///< most probable first, until they hold all but a twentieth (kTied)
  double outside = 0.0;                ///< that none of the catalogue is the whole answer
};

/// Every model that a step's round fitted, and the one without the step, by its evidence (score.hpp) and what a name costs. An
/// effect counts with its best place and form, steps as independent of each other. `more_is_left`: the verdict is that something is, by a sign or
/// by records (held-out ones, a floor) that contradict what was found. `share_left`: rms of the held-out records' gap under the final model over
/// that under the base model.
Posterior posterior_of(const SearchResult& result, bool more_is_left, double share_left);

}  // namespace bodesmith::gap
