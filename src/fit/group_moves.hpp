#pragma once

#include "fit/curve_search.hpp"
#include "fit/start_builder.hpp"

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

}  // namespace bodesmith
