#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>

namespace bodesmith::gap {

// The limits of each step of a search. The numbers in brackets are the steps of docs/gap.md that explain
// them.

/// Starts of records that began in another state than rest [2].
struct StartOptions {
  double stands_out = 1.35;      ///< rms of the residual there over that of the rest
  std::size_t min_samples = 12;  ///< shorter stretches say nothing
  double max_part = 0.25;        ///< of the record; a longer start is explained by free responses instead
  std::size_t percent_with_free_start = 3;  ///< of the record that is left out even then
  double max_cost = 1.03;    ///< of the rest's rms, at which a start that fits now is scored again
  int iterations = 20;       ///< of the fit that tries whether starts fit now,
  int refit_iterations = 8;  ///< and of the one without those that do not
};

/// Long records are first fitted on their liveliest stretches [5].
struct StretchOptions {
  std::size_t samples = 8000;  ///< of all stretches together; one and a half times as many: long records
  std::size_t min_samples_each = 1500;
  std::size_t min_lead = 200;  ///< samples before each that are run but not scored
  int iterations_on_all = 4;   ///< on the whole records, after the fit on stretches
  std::size_t leaders = 4;     ///< candidates of a round that are fitted on the whole records
};

/// The base model's own free parameters [1].
struct BaseFitOptions {
  double comb_reach = 0.42;  ///< frequencies are tried this far (ln) to both sides of the given ones …
  double comb_step = 0.06;   ///< … in these steps
  double min_apart = 0.09;   ///< (ln) starts nearer to each other lead to the same place
  std::size_t max_starts = 4;
  int iterations = 40;
  double other_hill = 0.98;    ///< the given values' own neighbourhood is preferred to another hill as good
  int settle_iterations = 12;  ///< of the refits that follow a step
  double settle_gain = 0.9999;
  /// Values that serve the held-out records far better at no cost to the training records are taken.
  double far_better = 0.9;
  double no_cost = 1.01;
  /// They are looked for unless the held-out rms is below both of these: times the training rms, part of the
  /// range.
  double suspicious_ratio = 1.2;
  double suspicious_part_of_range = 0.01;
  int open_iterations = 25;        ///< of the fit to all records,
  int open_refit_iterations = 12;  ///< and of the one with free responses renewed
};

/// Rounds of candidates [4, 5].
struct RoundOptions {
  std::size_t effects = 9;             ///< fitted in each round
  std::size_t effects_from_given = 3;  ///< more in the first round, as seen from the given parameters
  double min_score = 0.003;            ///< share of the residual's energy that a candidate must promise
  int places = 2;                      ///< of each effect, one more when it is of another form
  int first_iterations = 6;            ///< that each start of a candidate gets before the best ones go on
  double first_tolerance = 1e-4;
  double worth_going_on = 1.15;  ///< times the best start's rms, at which the second best goes on too
  double tolerance = 1e-6;
  int iterations = 30;
  int iterations_when_free = 14;  ///< of terms with more than free_unknowns unknowns
  std::size_t free_unknowns = 8;
  double weakened = 8.0;  ///< factor by which the last earlier term is made weak for one more start
};

/// What a term must show [6, 7].
struct AcceptanceOptions {
  /// Of the held-out rms, that a term must earn: false terms were seen to earn 0.16 % at the most.
  double min_gain = 0.01;
  /// The same when one of few unknowns rests at a bound: a shape that only fits at the end of its range is
  /// another's.
  double min_gain_at_bound = 0.05;
  std::size_t few_unknowns = 3;
  double min_significance = 2.8;  ///< standard deviations, held-out and training gain each (colour counted)
  double min_combined = 5.0;      ///< of both together
  double control_factor = 3.0;    ///< times the gain that surrogate data show
  std::uint64_t controls = 2;     ///< sets of surrogate data
  double max_condition = 1e7;
  std::size_t max_unknowns = 99;       ///< of one term; few when nothing with another excitation is held out
  double tie_within = 0.10;            ///< a rival less than this worse is a tie
  double tie_with_more_within = 0.02;  ///< one with up to tie_more_unknowns more unknowns, less than this
  std::size_t tie_more_unknowns = 2;
  /// Fewer unknowns win when more of them buy no more than the first, and the second for each of them.
  double simpler_within = 0.01;
  double simpler_within_each = 0.004;
};

/// Two effects that hide each other [6]: trials of the most promising candidates when none earns its place
/// alone.
struct PairOptions {
  std::size_t trials = 3;
  double max_left = 0.98;  ///< of the pooled rms, by a candidate worth a trial
  double max_left_train = 0.99;
  double min_gains = 3.0;  ///< times min_gain, of both together
};

/// Earlier terms are tested again [8].
struct EliminationOptions {
  /// Less than at acceptance: a term that is in is given the benefit of the doubt.
  double min_significance = 2.0;
  double far_worse = 2.5;  ///< a rival is tried unless it was this many times worse in that term's own round
  std::size_t max_rivals = 5;
  /// A rival takes a term's place when it leaves less than this of the held-out and training rms,
  double swap_holdout = 0.97;
  double swap_train = 0.99;
  /// or, with fewer unknowns, no more than this.
  double swap_simpler = 1.01;
};

struct SearchOptions {
  int max_terms = 5;
  double enough = 1.2;        ///< times the floor: nothing more is looked for [3, 9]
  double plainly_more = 1.5;  ///< times the floor: something is left, whatever the signs [9]
  int threads = 2;
  std::uint64_t seed = 1;
  std::function<void(double)> progress;  ///< fraction of the work, roughly
  std::function<bool()> stop;            ///< true: keep the best so far and return

  StartOptions starts;
  StretchOptions stretches;
  BaseFitOptions base;
  RoundOptions round;
  AcceptanceOptions acceptance;
  PairOptions pairs;
  EliminationOptions elimination;

  bool stopped() const { return stop && stop(); }
  void report(double fraction) const {
    if (progress) progress(fraction);
  }
};

}  // namespace bodesmith::gap
