#pragma once

#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "gap/model/model.hpp"
#include "gap/report/where.hpp"
#include "gap/study.hpp"

namespace bodesmith::gap {

/// The sizes of a gap. Every figure is what `simulate` finds with the model.toml of that stage; infinite where that runs away.
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

/// y - y_model of one record from its first to its last sample, as `simulate` makes it: infinite where an extended model runs away. Of the
/// base model that is an InputError: its file is wrong.
std::vector<double> whole_residual(const Model& model, const TimeExperiment& experiment);

/// Sizes of gaps of one study, all measured over the same samples: from the first one on, unless a record's
/// start stands out even under the final model.
class GapMeter {
 public:
  GapMeter(const Study& study, const Model& final);

  GapSize size(const Model& model) const;
  /// Where the gap of the held-out record with the largest gap lies; nowhere when the model runs away on it.
  std::vector<Cell> where(const Model& model) const;
  /// y - y_model of one held-out record over the samples that are scored, lines of the mains as size() takes them.
  std::span<const double> holdout_residual(const Model& model, std::size_t record) const;
  /// The held-out records, their starts scored where the meter scores them.
  Experiments holdout() const;
  /// Time records only.
  std::vector<ScoredFrom> scored_from() const;

 private:
  using Key = std::pair<std::string, const Experiment*>;

  /// Of each record from its first to its last sample, as `simulate` makes it; lines of the mains as that record has them, or as the
  /// model says. Kept: the same few models are asked for again and again, and some take seconds.
  std::vector<std::span<const double>> residuals(const Model& model, const Experiments& experiments,
                                                 bool own_lines) const;
  /// Of the held-out records, lines of the mains as the first of them has them.
  std::vector<std::span<const double>> holdout_residuals(const Model& model) const;
  std::vector<std::size_t> scoring_starts(const Model& final, const Experiments& experiments,
                                          bool split) const;
  static std::pair<double, double> pooled_rms(const std::vector<std::span<const double>>& residuals,
                                              const std::vector<std::size_t>& from);

  const Study& study_;
  mutable std::map<Key, std::vector<double>> residuals_;
  std::vector<std::size_t> train_from_;
  std::vector<std::size_t> holdout_from_;
};

/// A held-out record whose gap is for the most part one constant: the mean m of the residual e = y - y_model, with
/// share = m^2 / mean(e^2) of it. A stage's zero that moved between two records (drift, creep, another preload) does
/// this, and no term of a model can know it.
struct ConstantOffset {
  std::string file;
  double value = 0.0;        ///< in the unit of y
  double share = 0.0;        ///< of the mean square of the gap
  double rms_without = 0.0;  ///< what would be left without it
};

/// The held-out time records for which that share is at least a half.
std::vector<ConstantOffset> constant_offsets(const GapMeter& meter, const Model& model, const Study& study);

/// One sentence for a person.
std::string to_text(const ConstantOffset& offset);

}  // namespace bodesmith::gap
