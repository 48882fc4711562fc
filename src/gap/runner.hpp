#pragma once

#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "gap/model/model.hpp"
#include "gap/records/experiment.hpp"

namespace bodesmith::gap {

/// Runs one chain structure against one record, again and again with other parameter values. One object a
/// thread.
class Bench {
 public:
  virtual ~Bench() = default;
  virtual chain::Chain& chain() = 0;
  /// Appends (model - measured) at every scored sample; false when the chain cannot be run with its present
  /// values (it runs away).
  virtual bool residuals(std::vector<double>& append) = 0;
};

/// One model structure on several records.
class Runner {
 public:
  /// Throws InputError when the model's structure and present values cannot be run at all.
  Runner(const Model& model, const Experiments& experiments);
  ~Runner();
  Runner(Runner&&) noexcept;

  /// Residuals at some values of the model's unknowns, for a fit: false where the model cannot be run. That
  /// is an outcome of a search, not an error of the user.
  bool operator()(std::span<const double> values, std::vector<double>& out);

 private:
  Model model_;
  std::vector<std::unique_ptr<Bench>> benches_;
};

/// The same from several threads at once: each call takes a runner that is idle, or makes another one.
class Runners {
 public:
  /// As of Runner.
  Runners(const Model& model, const Experiments& experiments);

  bool operator()(std::span<const double> values, std::vector<double>& out);

 private:
  Runner take();

  const Model model_;
  const Experiments experiments_;
  std::mutex guard_;
  std::vector<Runner> idle_;
};

/// The values now in a model's unknowns.
std::vector<double> current_values(const Model& model);

/// Residuals with the model's present values; empty when it cannot be run.
std::vector<double> residuals_of(const Model& model, const Experiments& experiments);

/// The model with its lines as this record has them.
Model with_lines_of(Model model, const TimeExperiment& experiment);
Model with_lines_of(Model model, const Experiment& experiment);

/// The model's whole output for one time record, its lines as the record has them; empty when it cannot be
/// run.
std::vector<double> output_of(const Model& model, const TimeExperiment& experiment);
/// The same with the lines as the model has them.
std::vector<double> bare_output_of(const Model& model, const TimeExperiment& experiment);

/// rms of the residual over the scored samples; infinite when the model cannot be run.
double rms_of(const Model& model, const Experiments& experiments);

}  // namespace bodesmith::gap
