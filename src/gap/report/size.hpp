#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "gap/model/model.hpp"
#include "gap/report/where.hpp"
#include "gap/study.hpp"

namespace bodesmith::gap {

/// The sizes of a gap. Every figure is what `simulate` finds with the model.toml of that stage.
struct GapSize {
  double train_rms = 0.0;
  double holdout_rms = 0.0;
  double holdout_percent_of_range = 0.0;
  double train_whole_rms = 0.0;  ///< from the first sample on, start transients included
  double holdout_whole_rms = 0.0;
};

/// Where the score of a record begins.
struct ScoredFrom {
  std::string file;
  bool held_out = false;
  double from_s = 0.0;
};

/// Sizes of gaps of one study, all measured over the same samples: from the first one on, unless a record's
/// start stands out even under the final model.
class GapMeter {
 public:
  GapMeter(const Study& study, const Model& final);

  GapSize size(const Model& model) const;
  /// The same of the held-out records alone.
  double holdout_rms(const Model& model) const;
  /// Works out at once, on as many threads as are allowed, what size() of the one and holdout_rms() of the others will ask for.
  void look_ahead(const std::vector<const Model*>& sized, const std::vector<const Model*>& held_out) const;
  /// Where the gap of the held-out record with the largest gap lies.
  std::vector<Cell> where(const Model& model) const;
  /// y - y_model of one held-out record over the samples that are scored, lines of the mains as size() takes them.
  std::vector<double> holdout_residual(const Model& model, std::size_t record) const;
  /// Time records only.
  std::vector<ScoredFrom> scored_from() const;

 private:
  using Key = std::pair<std::string, const Experiment*>;

  /// Of a record from its first to its last sample, as `simulate` makes it. Kept: the same few models are asked for again and again,
  /// and some take seconds.
  const std::vector<double>& residual(const Model& model, const Experiment& experiment) const;
  std::size_t scoring_start(const Model& final, const TimeExperiment& time, const Experiment& experiment,
                            bool split) const;
  std::vector<std::size_t> scoring_starts(const Model& final, const Experiments& experiments,
                                          bool split) const;
  /// rms of all records together, from their scoring starts on, and whole.
  std::pair<double, double> pooled_rms(const Model& model, const Experiments& experiments,
                                       const std::vector<std::size_t>& from, bool own_lines) const;
  std::pair<double, double> pooled_holdout_rms(const Model& model) const;

  const Study& study_;
  mutable std::map<Key, std::vector<double>> residuals_;
  std::vector<std::size_t> train_from_;
  std::vector<std::size_t> holdout_from_;
};

}  // namespace bodesmith::gap
