#pragma once

#include <cstddef>
#include <string>
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

/// The same of every record of a study. Training records have lines of the mains of their own; held-out ones are compared with what
/// model.toml holds, those of the first of them.
struct WholeResiduals {
  std::vector<std::vector<double>> train;
  std::vector<std::vector<double>> holdout;
};
WholeResiduals whole_residuals(const Model& model, const Study& study);

/// Sizes of gaps of one study, all measured over the same samples: from the first one on, unless a record's
/// start stands out even under the final model.
class GapMeter {
 public:
  GapMeter(const Study& study, const WholeResiduals& final);

  GapSize size(const WholeResiduals& residuals) const;
  /// Where the gap of the held-out record with the largest gap lies; nowhere when the model runs away on it.
  std::vector<Cell> where(const WholeResiduals& residuals) const;
  /// The first sample of a held-out record that is scored.
  std::size_t holdout_from(std::size_t record) const { return holdout_from_[record]; }
  /// The held-out records, their starts scored where the meter scores them.
  Experiments holdout() const;
  /// Time records only.
  std::vector<ScoredFrom> scored_from() const;

 private:
  const Study& study_;
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
std::vector<ConstantOffset> constant_offsets(const GapMeter& meter, const WholeResiduals& final,
                                             const Study& study);

/// One sentence for a person.
std::string to_text(const ConstantOffset& offset);

}  // namespace bodesmith::gap
