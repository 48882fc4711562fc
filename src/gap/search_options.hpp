#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>

#include "gap/drive_request.hpp"
#include "gap/effect.hpp"

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
};

/// Rounds of candidates [4, 5].
struct RoundOptions {
  std::size_t effects = 9;             ///< fitted in each round
  std::size_t effects_from_given = 3;  ///< more in the first round, as seen from the given parameters
  /// Forms and places of an effect that are fitted beyond Effect::places_a_round in responses, where a fit is quick.
  int more_forms_of_response = 2;
  double min_score = 0.003;          ///< share of the residual's energy that a candidate must promise,
  double min_score_of_little = 0.3;  ///< and when less is left than a later term must explain
  /// Standard deviations of that promise, without earlier terms and with them.
  double min_promise = 2.0;
  double min_promise_later = 4.0;
  double in_the_running = 1.5;  ///< times the best candidate's rms, within which folds are looked at
  int first_iterations = 3;     ///< that each start of a candidate gets before the best ones go on
  double first_tolerance = 1e-3;
  std::size_t few_unknowns = 4;  ///< of terms whose several starts are tried
  double worth_going_on = 1.15;  ///< times the best start's rms, at which the second best goes on too
  double tolerance = 1e-6;
  int iterations_a_stage = 5;
  int stages = 6;
  double far_behind = 3.0;  ///< times the leader's rms: such a fit stays where it is,
  double behind = 1.1;      ///< and so does one behind by this
  double no_nearer = 0.95;  ///< whose last stage left more than this of its rms
  double far_ahead = 0.8;  ///< times a fit's rms: another place of a linear effect whose values it then gets,
  int stages_of_shared = 3;  ///< for so many stages
  double weakened = 8.0;     ///< factor by which the last earlier term is made weak for one more start
};

/// What a term must show [6, 7]. Gains are those on folds of the training records that did not choose its
/// values.
struct AcceptanceOptions {
  /// Of the rms: false terms were seen to earn 0.16 % at the most, and what earns less than this beside a
  /// floor is of no use.
  double min_gain = 0.04;
  /// The same when one of few unknowns rests at a bound: a shape that only fits at the end of its range is
  /// another's.
  double min_gain_at_bound = 0.08;
  std::size_t few_unknowns = 3;
  /// What later terms must explain, as a part of the first gap's rms, and the same for each unknown beyond the
  /// first, to the largest: less is the first one's form. A few unknowns are not counted when their gain is plain.
  double min_part_of_gap = 0.08;
  double min_part_each = 0.02;
  double max_min_part = 0.2;
  std::size_t few_plain_unknowns = 4;
  double plain_significance = 30.0;
  /// What takes so much of what is left, beyond that significance, is a name however large the first gap was.
  double most_of_rest = 0.5;
  double min_significance = 5.0;  ///< standard deviations of the gain (colour counted), on folds and on all
  double min_significance_of_signal = 4.0;  ///< the same of one known signal (Effect::adds_one_signal)
  double max_condition = 1e7;
  std::size_t max_unknowns = 99;     ///< of one term; few when there is one excitation only
  double tie_within = 0.10;          ///< a rival less than this worse may be a tie: when it is
  double tie_significance = 2.0;     ///< less than so many standard deviations worse,
  double tie_surely_within = 0.002;  ///< or by less than this part of the rms,
  double tie_within_chance = 0.25;   ///< or by less than this part of it
  double chance_significance = 1.0;  ///< and so many standard deviations
  /// A rival with up to so many unknowns more must be better by so many standard deviations.
  std::size_t tie_more_unknowns = 2;
  double freedom_significance = 3.0;
  /// A name that is not far-fetched wins when it leaves no more than this part more, with so many unknowns more.
  double at_hand_within = 0.02;
  std::size_t at_hand_more_unknowns = 2;

  double needed_significance(const Effect& effect) const {
    return effect.adds_one_signal() ? std::min(min_significance, min_significance_of_signal)
                                    : min_significance;
  }
};

/// Two effects that hide each other [6]: trials of the most promising candidates when none earns its place
/// alone.
struct PairOptions {
  std::size_t trials = 3;
  double max_left = 0.98;        ///< of the pooled rms, by a candidate worth a trial
  double max_left_train = 0.99;  ///< of the records' rms, by a first name of pairs at once
  double min_gains = 2.0;        ///< times min_gain, of both together
  /// Of pairs at once: first names, of them those that leave all but the same, second names beside each, pairs that are
  /// fitted, and those that are gone on from.
  std::size_t firsts_at_once = 8;
  std::size_t alike_at_once = 2;
  std::size_t seconds_at_once = 4;
  std::size_t fits_at_once = 20;
  std::size_t best_at_once = 2;
};

/// Earlier terms are tested again [8].
struct EliminationOptions {
  double far_worse = 2.5;  ///< a rival is tried unless it was this many times worse in that term's own round
  std::size_t max_rivals = 5;
  std::size_t successors = 5;  ///< effects that are fitted in a term's place when all may take it
  /// A rival takes a term's place when it leaves less than this of the rms,
  double swap_gain = 0.98;
  double swap_gain_each = 0.01;  ///< (less, for each unknown that it has more)
  /// or, with fewer unknowns, no more than this.
  double swap_simpler = 1.01;
};

/// A search that came to no end is begun again with two names at once [6].
struct OtherWaysOptions {
  std::size_t few_terms = 2;        ///< with more of them another way is tried in any case
  double as_far = 1.02;             ///< rms over the other way's: it came as far,
  double further = 0.8;             ///< or further
  std::size_t family_unknowns = 5;  ///< a name with so many may be others with fewer,
  std::size_t family_spares = 3;    ///< by so many at the least
  std::size_t max_partners = 3;     ///< terms each of which is tried against every effect,
  std::size_t max_exchanges = 3;    ///< so many times, as long as that leads to another one
};

struct SearchOptions {
  int max_terms = 5;
  double enough = 1.2;        ///< times the floor: nothing more is looked for [3, 9]
  double plainly_more = 1.5;  ///< times the floor: something is left, whatever the signs [9]
  int threads = 2;
  std::function<void(double)> progress;  ///< fraction of the work, roughly
  std::function<bool()> stop;            ///< true: keep the best so far and return
  std::function<bool()> late;            ///< true: judge what has been fitted, and begin nothing new

  StartOptions starts;
  StretchOptions stretches;
  BaseFitOptions base;
  RoundOptions round;
  AcceptanceOptions acceptance;
  PairOptions pairs;
  OtherWaysOptions other_ways;
  EliminationOptions elimination;
  DriveRequest drive;  ///< what experiment.csv may be

  bool stopped() const { return stop && stop(); }
  bool is_late() const { return stopped() || (late && late()); }
  void report(double fraction) const {
    if (progress) progress(fraction);
  }
};

}  // namespace bodesmith::gap
