#pragma once

#include "gap/model/model_fit.hpp"
#include "gap/records/experiment.hpp"
#include "gap/search_options.hpp"

namespace bodesmith::gap {

/// What stays the same during a search.
struct SearchSetting {
  const SearchOptions& options;
  double first_gap = 0.0;  ///< rms that the base model leaves of the training records, refitted
};

/// The records of a search: the training records alone.
struct SearchRecords {
  Experiments train;
  Experiments stretches;  ///< the liveliest parts of long training records; empty when they are not long

  bool are_long() const { return !stretches.empty(); }
  void set_holds(std::size_t holds) {
    gap::set_holds(train, holds);
    gap::set_holds(stretches, holds);
  }
  /// What is looked at first.
  const Experiments& look() const { return are_long() ? stretches : train; }
};

/// As searches score them: whole, their starts included; responses by their logarithm.
Experiments as_searched(Experiments experiments);

/// All starts scored, as a search begins; stretches with the leads that `model` needs.
SearchRecords make_records(const Experiments& train, const Model& model);

/// Holds of the engine to a sample with which its own error is no part of what the model leaves: one, but where a branch switches
/// between samples in front of something fast.
std::size_t enough_holds(const Model& model, const Experiments& train);

LeastSquaresOptions fit_options(const SearchOptions& options);
/// A few steps alone.
LeastSquaresOptions few_steps(const SearchOptions& options);

/// Fits on the stretches first when the records are long, then on the training records.
FittedModel fit_in_turn(const SearchSetting& setting, const SearchRecords& records, Model model);

}  // namespace bodesmith::gap
