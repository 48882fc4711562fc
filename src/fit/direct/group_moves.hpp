#pragma once

#include "fit/direct/curve_target.hpp"
#include "fit/direct/root_model.hpp"
#include "fit/direct/start_builder.hpp"

namespace bodesmith {

/// Exchange moves: each group of poles (one, or a pair) goes, with the zeros nearest to it, to other places, and
/// everything is improved again. Leaves valleys that no start led out of.
class GroupMoves {
 public:
  /// Moves are screened against `screening`, the best of them refined against `target`, roots placed within the
  /// settings' frequencies.
  GroupMoves(const RootModel& model, const RootLimits& limits, const StartBuilder::Settings& settings,
             const CurveTarget& screening, const CurveTarget& target, bool least_squares);

  /// Rounds of moves from `best` on, as long as they help.
  SearchResult improve(SearchResult best);
  int tried() const { return tried_; }

 private:
  /// Every pole (or pair) of one kind to every place.
  void screen_moves(const SearchResult& from, bool pairs, std::vector<SearchResult>& found);
  SearchResult refine(std::vector<SearchResult> found, SearchResult best) const;

  const RootModel& model_;
  const RootLimits& limits_;
  const StartBuilder::Settings& settings_;
  const CurveTarget& screening_;
  const CurveTarget& target_;
  bool least_squares_;
  int tried_ = 0;
};

/// Takes away poles and zeros that cancel without making the fit worse by more than a thousandth (or 1e-5 dB: rounding
/// of a fit that is exact with fewer). `value_db` is the fit's largest weighted error as its search knows it. Returns
/// how many poles went.
int drop_cancelling(RootModel::Roots& roots, const CurveTarget& target, double value_db);
/// Takes away zeros above the points, as far as the fit does not become worse by more than the same: a curve that falls
/// to the end needs none, and one at a thousand times its highest frequency can neither be built nor be seen in it.
/// Returns how many went.
int drop_distant_zeros(RootModel::Roots& roots, const CurveTarget& target, double value_db);
/// Puts zeros below the points at 0 Hz, as far as the fit does not become worse by more than the same: a curve that falls
/// to the beginning blocks direct voltages, and time constants of seconds need not be built. Returns how many went.
int move_zeros_to_origin(RootModel::Roots& roots, const CurveTarget& target, double value_db);

}  // namespace bodesmith
