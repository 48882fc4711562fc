#pragma once

#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "gap/model/model.hpp"
#include "gap/records/experiment.hpp"

namespace bodesmith::gap {

/// One model structure on several records, again and again with other values of its unknowns. From several threads at once: each call
/// takes benches that are idle, or makes others.
class Runner {
 public:
  /// Throws InputError when the model's structure and present values cannot be run at all.
  Runner(const Model& model, const Experiments& experiments);
  ~Runner();

  /// Residuals (model - measured) at some values of the model's unknowns, for a fit: false where the model cannot be run. That
  /// is an outcome of a search, not an error of the user.
  bool operator()(std::span<const double> values, std::vector<double>& out);

 private:
  struct Benches;
  std::unique_ptr<Benches> take();

  const Model model_;
  const Experiments experiments_;
  std::mutex guard_;
  std::vector<std::unique_ptr<Benches>> idle_;
};

/// Residuals with the model's present values; empty when it cannot be run.
std::vector<double> residuals_of(const Model& model, const Experiments& experiments);

/// The model with its lines as this record has them.
Model with_lines_of(Model model, const Experiment& experiment);

/// The model's whole output for one time record, its lines as the record has them; empty when it cannot be
/// run.
std::vector<double> output_of(const Model& model, const TimeExperiment& experiment);
/// The same with the lines as the model has them.
std::vector<double> bare_output_of(const Model& model, const TimeExperiment& experiment);

/// rms of the residual over the scored samples; infinite when the model cannot be run.
double rms_of(const Model& model, const Experiments& experiments);

}  // namespace bodesmith::gap
