#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "chain/chain.hpp"
#include "gap/least_squares.hpp"
#include "gap/model.hpp"
#include "signal/frequency_record.hpp"
#include "signal/time_record.hpp"

namespace bodesmith::gap {

/// Runs one chain structure against one record, again and again with other parameter values. One object a
/// thread.
class Bench {
 public:
  virtual ~Bench() = default;
  virtual chain::Chain& chain() = 0;
  /// Appends (model − measured) at every scored sample; false when the chain cannot be run with its present
  /// values.
  virtual bool residuals(std::vector<double>& append) = 0;
  /// The model's whole output, scored or not (time records; empty for frequency responses).
  virtual std::vector<double> output() = 0;
};

/// A measured record to compare with.
class Experiment {
 public:
  virtual ~Experiment() = default;
  virtual std::string file() const = 0;
  virtual std::unique_ptr<Bench> bench(const chain::Chain& chain) const = 0;
  virtual std::size_t scored() const = 0;
  /// Size (max − min) of what is measured; 1 for relative errors.
  virtual double range() const = 0;
};

/// A time record; samples before `skip` are not scored (start transient).
class TimeExperiment final : public Experiment {
 public:
  explicit TimeExperiment(TimeRecord record) : record_(std::move(record)), to_(record_.size()) {}
  std::string file() const override { return record_.file; }
  std::unique_ptr<Bench> bench(const chain::Chain& chain) const override;
  std::size_t scored() const override { return to_ - skip_; }
  double range() const override;

  const TimeRecord& record() const { return record_; }
  std::size_t skip() const { return skip_; }
  void set_skip(std::size_t samples) { skip_ = samples < to_ ? samples : to_ - 1; }
  /// Samples from here on are neither run nor scored (a shorter look for the shortlist).
  std::size_t to() const { return to_; }
  void set_to(std::size_t samples) { to_ = samples < record_.size() ? samples : record_.size(); }
  /// False: what comes before `skip` belongs to another use of the record and is never scored.
  bool start_may_be_scored() const { return start_may_be_scored_; }
  void never_score_start() { start_may_be_scored_ = false; }
  /// The record began in an unknown state: what orthonormal `directions` over the scored samples can explain
  /// (free responses) is taken out of the residual.
  void set_free_start(std::vector<std::vector<double>> directions) { free_start_ = std::move(directions); }
  const std::vector<std::vector<double>>& free_start() const { return free_start_; }
  void take_out_free_start(std::span<double> residual) const;
  /// Nonlinear dynamics in steps of a whole sample: about twice as fast, right to some 1e-4 of the output.
  void set_coarse() { coarse_ = true; }

 private:
  TimeRecord record_;
  std::size_t skip_ = 0;
  std::size_t to_ = 0;
  bool coarse_ = false;
  bool start_may_be_scored_ = true;
  std::vector<std::vector<double>> free_start_;
};

/// A frequency response; the residual is H_model/H_measured − 1, real and imaginary part a point, relative.
class FrequencyExperiment final : public Experiment {
 public:
  explicit FrequencyExperiment(FrequencyRecord record) : record_(std::move(record)) {}
  std::string file() const override { return record_.file; }
  std::unique_ptr<Bench> bench(const chain::Chain& chain) const override;
  std::size_t scored() const override { return 2 * record_.frequency.size(); }
  double range() const override { return 1.0; }
  const FrequencyRecord& record() const { return record_; }

 private:
  FrequencyRecord record_;
};

using Experiments = std::vector<const Experiment*>;

/// One model structure on several records: residuals for a fit.
class Runner {
 public:
  Runner(const Model& model, const Experiments& experiments);
  bool operator()(std::span<const double> values, std::vector<double>& out);
  /// Whole outputs, one a record.
  std::vector<std::vector<double>> outputs(std::span<const double> values);

 private:
  bool apply(std::span<const double> values);
  Model model_;
  std::vector<std::unique_ptr<Bench>> benches_;
};

/// The values now in a model's unknowns.
std::vector<double> current_values(const Model& model);

/// Refits all unknowns of the model on the records; the model then carries the best values. What is known
/// of them beforehand (Unknown::given) counts as one more sample each.
LeastSquaresResult fit(Model& model, const Experiments& experiments, const LeastSquaresOptions& options = {});

/// Orthonormal directions over the samples from `skip` on of what unknown initial states of the model's
/// dynamics add to its output.
std::vector<std::vector<double>> free_responses(const Model& model, const TimeExperiment& experiment,
                                                std::size_t skip);

/// Residuals with the model's present values; empty when it cannot be run.
std::vector<double> residuals_of(const Model& model, const Experiments& experiments);

}  // namespace bodesmith::gap
