#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "signal/bode_points.hpp"
#include "signal/time_record.hpp"

namespace bodesmith::gap {

/// Fewer samples of a record say too little, as do those of a drive.
constexpr std::size_t kLeastSamples = 64;

/// A time record and which of its samples are run and scored. A value: copies share the samples of the record
/// and nothing else.
///
///     0 ........ used_from ........ first ........ end ........ size
///     another use |   the start     |    scored    |  not run
///
/// A record should begin at rest; where it began in another state, its start (as long as the model needs to
/// forget that state) is left out of the score.
class TimeExperiment {
 public:
  /// All of the record is used. The first `start` samples are its start; they are left out until
  /// score_start().
  explicit TimeExperiment(TimeRecord record, std::size_t start = 0);

  const TimeRecord& record() const { return *record_; }
  const std::string& file() const { return record_->file; }
  /// max - min of what is measured.
  double range() const;

  /// The first sample that is scored.
  std::size_t first() const { return used_from_ + left_out_; }
  /// Behind the last sample that is run and scored.
  std::size_t end() const { return end_; }
  std::size_t scored() const { return end_ - first(); }
  /// The scored samples of a signal that is as long as the record, or at least as long as end().
  std::span<const double> scored_part(std::span<const double> signal) const;

  /// Only samples `from` … `end` - 1 belong to this use of the record; what comes before is run but never
  /// scored.
  void use(std::size_t from, std::size_t end);

  /// Samples of the start; 0: there is none, or it is not part of this use.
  std::size_t start() const { return start_; }
  bool start_is_left_out() const { return left_out_ > 0; }
  void score_start() { left_out_ = 0; }
  /// The record began in an unknown state: its start is not scored.
  void leave_out_start() { left_out_ = start_; }

  /// Holds of the engine to a sample (simulate::RecordOptions::oversample).
  void set_holds(std::size_t holds) { holds_ = holds; }
  std::size_t holds() const { return holds_; }
  /// Nonlinear dynamics in steps of a whole sample: about twice as fast, right to some 1e-4 of the output.
  void set_coarse() { coarse_ = true; }
  bool coarse() const { return coarse_; }

 private:
  std::shared_ptr<const TimeRecord> record_;
  std::size_t used_from_ = 0;
  std::size_t start_ = 0;
  std::size_t left_out_ = 0;
  std::size_t end_ = 0;
  std::size_t holds_ = 1;
  bool coarse_ = false;
};

/// A frequency response; the residual is H_model/H_measured - 1, real and imaginary part of each point,
/// relative. A search takes its logarithm ln(H_model/H_measured) instead: the same where it is small, but a peak that
/// the model lacks weighs as much as a notch, and not 1 at the most.
///
/// Where the record has a coherence, the residual of each point is multiplied by a weight (response_weights.hpp), so that
/// points of little coherence count less; the mean of the squared weights is 1, and an rms is a weighted one.
class FrequencyExperiment {
 public:
  explicit FrequencyExperiment(FrequencyRecord record);

  const FrequencyRecord& record() const { return *record_; }
  const std::string& file() const { return record_->file; }
  /// 1: its errors are relative.
  double range() const { return 1.0; }
  std::size_t scored() const { return 2 * record_->frequency.size(); }

  /// Of H_model/H_measured its logarithm is compared, not it less 1.
  void set_logarithmic() { logarithmic_ = true; }
  bool logarithmic() const { return logarithmic_; }
  /// One a point; empty: all are 1.
  const std::vector<double>& weights() const { return *weights_; }

 private:
  std::shared_ptr<const FrequencyRecord> record_;
  std::shared_ptr<const std::vector<double>> weights_;
  bool logarithmic_ = false;
};

/// A measured record to compare a model with. What differs between the kinds is visited.
using Experiment = std::variant<TimeExperiment, FrequencyExperiment>;
using Experiments = std::vector<Experiment>;

/// One function a kind, for std::visit.
template <class... Functions>
struct Visitor : Functions... {
  using Functions::operator()...;
};
template <class... Functions>
Visitor(Functions...) -> Visitor<Functions...>;

/// The records are frequency responses: a list of them holds one kind.
bool are_responses(const Experiments& experiments);
/// Of all time records (TimeExperiment::set_holds).
void set_holds(Experiments& experiments, std::size_t holds);
/// Theirs; 1 of responses.
std::size_t holds_of(const Experiments& experiments);
/// Samples scored in all of them.
std::size_t scored_samples(const Experiments& experiments);
/// The largest range of them.
double largest_range(const Experiments& experiments);

}  // namespace bodesmith::gap
