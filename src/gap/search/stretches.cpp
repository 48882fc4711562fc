#include "gap/search/stretches.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "gap/runner.hpp"

namespace bodesmith::gap {
namespace {

/// Samples begin … end - 1 of a record.
struct Part {
  std::size_t begin = 0;
  std::size_t end = 0;
};

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

/// A part of a record, its first `lead` samples run and not scored.
TimeExperiment stretch_of(const TimeExperiment& whole, const Part& part, std::size_t lead) {
  const auto kept = [&](const std::vector<double>& v) {
    const auto samples = std::span(v).subspan(part.begin, part.end - part.begin);
    return std::vector<double>(samples.begin(), samples.end());
  };
  TimeRecord record;
  record.file = whole.file();
  record.step_s = whole.record().step_s;
  record.start_s = whole.record().time_s(part.begin);
  record.u = kept(whole.record().u);
  record.y = kept(whole.record().y);
  TimeExperiment stretch(std::move(record), lead);
  stretch.set_coarse();
  stretch.set_holds(whole.holds());
  return stretch;
}

/// Whether a stretch is followed as the whole record is, of which the model makes `whole`, but for less than a name must explain of what is
/// left.
bool is_settled_in(const TimeExperiment& stretch, const Part& part, const TimeRecord& record,
                   const std::vector<double>& whole, const Model& model) {
  const auto own = output_of(model, stretch);
  if (own.size() < part.end - part.begin) return true;
  double difference = 0.0;
  double left = 0.0;
  for (std::size_t i = part.begin + stretch.first(); i < part.end; ++i) {
    difference += std::pow(own[i - part.begin] - whole[i], 2);
    left += std::pow(record.y[i] - whole[i], 2);
  }
  return difference <= kLeastShare * left;
}

}  // namespace

Experiments stretches_of(const Experiments& train, const Model& model, std::size_t samples) {
  Experiments stretches;
  if (scored_samples(train) <= 3 * samples / 2) return stretches;
  for (const auto& e : train) {
    const auto* whole = std::get_if<TimeExperiment>(&e);
    if (whole == nullptr) {
      stretches.push_back(e);
      continue;
    }
    const TimeRecord& record = whole->record();
    const auto output = output_of(model, *whole);
    const bool runs = output.size() >= whole->end();
    std::vector<double> left(whole->end(), 0.0);
    for (std::size_t i = whole->start(); i < left.size(); ++i)
      left[i] = record.y[i] - (runs ? output[i] : 0.0);
    const std::size_t lead = whole->start();
    const Part part = liveliest(left, lead, samples / train.size());
    auto stretch = stretch_of(*whole, part, lead);
    if (part.begin > 0 && runs && !is_settled_in(stretch, part, record, output, model))
      stretch = stretch_of(*whole, {0, part.end}, part.begin + lead);
    stretches.emplace_back(std::move(stretch));
  }
  return stretches;
}

}  // namespace bodesmith::gap
