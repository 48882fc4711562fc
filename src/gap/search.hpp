#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "gap/effect.hpp"
#include "gap/experiment.hpp"
#include "gap/leftover.hpp"
#include "gap/noise_floor.hpp"

namespace bodesmith::gap {

struct SearchOptions {
  int most_terms = 5;
  double least_gain = 0.01;         ///< of the held-out rms, that a term must earn
  double least_significance = 2.8;  ///< standard deviations, held-out and training gain each (colour counted)
  double least_combined = 5.0;      ///< of both together
  double control_factor = 3.0;      ///< times the gain that surrogate data show
  double tie_within = 0.10;         ///< a rival less than this worse is a tie
  double enough = 1.2;              ///< times the floor: nothing more is looked for
  double largest_condition = 1e7;
  std::size_t most_unknowns = 99;  ///< of one term; few when nothing with another excitation is held out
  int shortlist = 9;               ///< effects fitted in each round
  int threads = 2;
  std::uint64_t seed = 1;
  std::function<void(double)> progress;  ///< fraction of the work, roughly
  std::function<bool()> stop;            ///< true: keep the best so far and return
};

/// One candidate of a round, fitted.
struct Ranked {
  const Effect* effect = nullptr;
  std::string placed;
  Model model;
  double score = 0.0;  ///< share of the residual's energy that the shortlist foresaw
  double train_rms = 0.0;
  double holdout_rms = 0.0;
  double z = 0.0;
  double train_z = 0.0;
  double condition_number = 0.0;
  std::size_t unknowns = 0;
  std::size_t effective = 0;      ///< of them not at a bound: weights of 0 cost nothing
  std::vector<double> deviation;  ///< of the term's unknowns
  std::string word;               ///< named, tied, also fits, no gain, not significant, ill-conditioned, …
};

/// One term that was found.
struct Step {
  const Effect* effect = nullptr;
  std::vector<std::string> tied_with;
  std::vector<std::string> also_fit;  ///< rivals with more parameters that do no better
  std::string placed;
  std::vector<std::string> also_placed;  ///< other places at which the same effect fits as well
  Model before;
  Model after;
  std::vector<Ranked> ranking;
  double control_gain = 0.0;  ///< held-out gain (share of rms) of the same term on surrogate data
};

struct SearchResult {
  Model base;     ///< free parameters refitted, nothing added
  Model initial;  ///< as given
  Model final;
  std::vector<Step> steps;
  std::vector<Ranked> refused;  ///< the ranking of the round in which nothing earned its place
  std::vector<Sign> structure;  ///< what still points to something missing
  NoiseFloor floor;
  double train_rms = 0.0;  ///< of the final model, over what the search scored
  bool stopped = false;
  std::vector<std::string> notes;
};

/// The search described in docs/gap.md: shortlist, fit in place, accept or refuse, look again.
SearchResult search(const chain::Chain& base, const Experiments& train, const Experiments& holdout,
                    const SearchOptions& options);

/// rms over the scored samples.
double rms_of(const Model& model, const Experiments& experiments);

}  // namespace bodesmith::gap
