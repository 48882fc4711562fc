#include "gap/search/stretches.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "base/whole_number.hpp"
#include "gap/runner.hpp"
#include "signal/statistics.hpp"

namespace bodesmith::gap {
namespace {

/// It is moved to where this much more is left (mean square).
constexpr double kFarMore = 2.0;
/// A stretch's model does what it does in the whole record: parts of what it leaves.
constexpr double kSettled = 0.05;

/// Samples begin … end - 1 of a record.
struct Part {
  std::size_t begin = 0;
  std::size_t end = 0;
};

TimeRecord cut(const TimeRecord& record, const Part& part) {
  TimeRecord out;
  out.file = record.file;
  out.step_s = record.step_s;
  out.start_s = record.time_s(part.begin);
  const auto kept = [&](const std::vector<double>& v) {
    const auto samples = std::span(v).subspan(part.begin, part.end - part.begin);
    return std::vector<double>(samples.begin(), samples.end());
  };
  out.u = kept(record.u);
  out.y = kept(record.y);
  return out;
}

/// `samples` with most energy and `lead` before them, of a signal.
Part liveliest(std::span<const double> signal, std::size_t lead, std::size_t samples) {
  const std::size_t end = signal.size();
  if (end <= lead + samples + samples / 4) return {0, end};
  std::vector<double> energy(end + 1, 0.0);
  for (std::size_t i = 0; i < end; ++i) energy[i + 1] = energy[i] + signal[i] * signal[i];
  std::size_t best = 0;
  double most = -1.0;
  for (std::size_t from = 0; from + lead + samples <= end; from += std::max<std::size_t>(1, samples / 8)) {
    const double e = energy[from + lead + samples] - energy[from + lead];
    if (e > most) {
      most = e;
      best = from;
    }
  }
  return {best, best + lead + samples};
}

/// The record's output about its middle, as far as it is scored.
std::vector<double> about_middle(const TimeExperiment& experiment) {
  std::vector<double> y(experiment.record().y.begin(),
                        experiment.record().y.begin() + static_cast<std::ptrdiff_t>(experiment.end()));
  const double middle = mean(y);
  for (double& v : y) v -= middle;
  return y;
}

TimeExperiment stretch_of(const TimeRecord& record, const Part& part, std::size_t lead) {
  TimeExperiment stretch(cut(record, part), lead);
  stretch.set_coarse();
  return stretch;
}

/// A stretch, and where it lies in its record.
struct Placed {
  Part part;
  std::size_t scored_from = 0;
};

Placed place_of(const TimeExperiment& stretch, const TimeRecord& record) {
  const auto begin = nearest_whole<std::size_t>((stretch.record().start_s - record.start_s) / record.step_s);
  return {{begin, begin + stretch.record().size()}, begin + stretch.first()};
}

/// Whether a stretch is followed as the whole record is; one that cannot be run is not asked.
bool is_settled_in(const TimeExperiment& stretch, const Placed& at, const TimeRecord& record,
                   const std::vector<double>& whole, const Model& model) {
  const auto own = output_of(model, stretch);
  if (own.size() < at.part.end - at.part.begin || whole.size() < at.part.end) return true;
  double difference = 0.0;
  double left = 0.0;
  for (std::size_t i = at.scored_from; i < at.part.end; ++i) {
    difference += std::pow(own[i - at.part.begin] - whole[i], 2);
    left += std::pow(record.y[i] - whole[i], 2);
  }
  return difference <= kSettled * kSettled * left;
}

/// A longer lead where the model needs one; `output`: its own, of the whole record.
void lengthen_lead(TimeExperiment& stretch, const TimeExperiment& whole, const std::vector<double>& output,
                   const Model& model) {
  const TimeRecord& record = whole.record();
  const Placed at = place_of(stretch, record);
  if (at.part.begin == 0 || is_settled_in(stretch, at, record, output, model)) return;
  stretch = stretch_of(record, {0, at.part.end}, at.scored_from);
}

/// To where the model leaves far more than in the stretch.
void move_to_what_is_left(TimeExperiment& stretch, const TimeExperiment& whole,
                          const std::vector<double>& output, std::size_t lead) {
  const TimeRecord& record = whole.record();
  const Placed at = place_of(stretch, record);
  std::vector<double> left(whole.end());
  for (std::size_t i = whole.start(); i < left.size(); ++i) left[i] = record.y[i] - output[i];
  const auto left_of = [&](std::size_t from, std::size_t to) {
    const double part = rms(std::span(left).subspan(from, to - from));
    return part * part;
  };
  const Part best = liveliest(left, lead, at.part.end - at.scored_from);
  if (left_of(best.begin + lead, best.end) > kFarMore * left_of(at.scored_from, at.part.end))
    stretch = stretch_of(record, best, lead);
}

}  // namespace

Experiments stretches_of(const Experiments& train, const StretchOptions& options) {
  Experiments stretches;
  if (scored_samples(train) <= 3 * options.samples / 2) return stretches;
  const std::size_t each = options.samples / train.size();
  for (const auto& e : train) {
    const auto* time = std::get_if<TimeExperiment>(&e);
    if (time == nullptr) {
      stretches.push_back(e);
      continue;
    }
    const std::size_t lead = std::max(time->start(), options.min_lead);
    stretches.emplace_back(stretch_of(time->record(), liveliest(about_middle(*time), lead, each), lead));
  }
  return stretches;
}

void lengthen_leads(Experiments& stretches, const Experiments& train, const Model& model) {
  for (std::size_t k = 0; k < stretches.size(); ++k) {
    auto* stretch = std::get_if<TimeExperiment>(&stretches[k]);
    if (stretch == nullptr) continue;
    const auto& whole = std::get<TimeExperiment>(train[k]);
    if (place_of(*stretch, whole.record()).part.begin == 0) continue;
    lengthen_lead(*stretch, whole, output_of(model, whole), model);
  }
}

void follow_what_is_left(Experiments& stretches, const Experiments& train, const Model& model,
                         const StretchOptions& options) {
  for (std::size_t k = 0; k < stretches.size(); ++k) {
    auto* stretch = std::get_if<TimeExperiment>(&stretches[k]);
    if (stretch == nullptr) continue;
    const auto& whole = std::get<TimeExperiment>(train[k]);
    const auto output = output_of(model, whole);
    if (output.size() < whole.end()) continue;  // it cannot be run
    move_to_what_is_left(*stretch, whole, output, std::max(whole.start(), options.min_lead));
    lengthen_lead(*stretch, whole, output, model);
  }
}

}  // namespace bodesmith::gap
