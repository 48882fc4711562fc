#include "identify/record_findings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/text.hpp"
#include "signal/period.hpp"
#include "signal/statistics.hpp"

namespace bodesmith::identify {
namespace {

constexpr std::size_t kWindows = 100;
constexpr double kUnusual = 3.0;
constexpr double kWorthADelay = 0.95;

hysteresis::IdentifyOptions play_bank(hysteresis::IdentifyOptions options) {
  options.method = "best";
  options.size = 10;
  options.asymmetric = false;
  return options;
}

const hysteresis::ModelType& plays() {
  return hysteresis::model_type_registry().get("prandtl_ishlinskii");
}

double mean_speed(const std::vector<double>& u, std::size_t begin, std::size_t end) {
  double sum = 0.0;
  for (std::size_t i = begin + 1; i < end; ++i) sum += std::abs(u[i] - u[i - 1]);
  return sum / static_cast<double>(end - begin - 1);
}

/// A drive that moves faster or slower there than later leaves another error whatever it started from: where the stage
/// depends on the rate that is a frequency of the record, and no transient to be left out.
bool is_driven_otherwise(const std::vector<double>& u, std::size_t begun) {
  constexpr double kSameSpeed = 1.5;
  if (begun < 2) return false;
  const double first = mean_speed(u, 0, begun);
  const double later = mean_speed(u, u.size() / 2, u.size());
  return first > kSameSpeed * later || later > kSameSpeed * first;
}

/// Seconds from the start of the record over which the error stays unusual; at most 40 % of it.
double transient_of(const TimeRecord& record, const std::vector<double>& model) {
  const std::size_t width = std::max<std::size_t>(record.size() / kWindows, 2);
  std::vector<double> sizes;
  for (std::size_t begin = 0; begin + width <= record.size(); begin += width) {
    std::vector<double> error;
    for (std::size_t i = begin; i < begin + width; ++i) error.push_back(model[i] - record.y[i]);
    sizes.push_back(rms(error));
  }
  if (sizes.size() < 10) return 0.0;
  const auto half = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  const double usual = median(std::vector<double>(half, sizes.end()));
  const double later = *std::max_element(half, sizes.end());
  // Errors that come back later are the model's, not the start's.
  const double limit = std::max(kUnusual * usual, 1.2 * later);
  std::size_t last = 0;
  while (last < 2 * sizes.size() / 5 && sizes[last] > limit) ++last;
  return is_driven_otherwise(record.u, last * width) ? 0.0
                                                     : static_cast<double>(last * width) * record.step_s;
}

std::optional<double> one_frequency(std::span<const TimeRecord> records) {
  std::optional<double> out;
  for (const TimeRecord& record : records) {
    const std::size_t period = find_period(record.u);
    if (period == 0) return std::nullopt;
    const double frequency = 1.0 / (static_cast<double>(period) * record.step_s);
    if (out && std::abs(*out - frequency) > 0.02 * frequency) return std::nullopt;
    out = frequency;
  }
  return out;
}

}  // namespace

RecordFindings find_in_records(std::span<const TimeRecord> records,
                               const hysteresis::IdentifyOptions& options, bool look_for_delay) {
  RecordFindings out;
  hysteresis::IdentifyOptions quick = play_bank(options);
  double shortest = records[0].duration_s();
  for (const TimeRecord& record : records) shortest = std::min(shortest, record.duration_s());
  quick.skip_s = std::max(options.skip_s, 0.5 * shortest);
  StageModel rough;
  try {
    rough = StageModel(plays().identify(records, quick), 0.0);
  } catch (const InputError&) {
    return out;  // records too poor for ten plays say nothing more
  }
  for (const TimeRecord& record : records)
    out.transient_s =
        std::max(out.transient_s, transient_of(record, rough.simulate(record.u, record.step_s)));
  if (out.transient_s > 0.0)
    out.notes.push_back(
        fmt::format("the first {} s look like a start transient: no model that starts at rest explains them",
                    rounded_text(out.transient_s)));
  if (look_for_delay) {
    quick.skip_s = std::max(options.skip_s, out.transient_s);
    const double found = best_delay(records, quick, false);
    StageFitOptions with;
    with.identify = quick;
    const double without_delay = fit_stage(&plays(), records, {}, with).training.rms;
    with.delay_s = found;
    const double with_delay = fit_stage(&plays(), records, {}, with).training.rms;
    if (found > 0.0 && with_delay < kWorthADelay * without_delay) {
      out.delay_s = found;
      out.notes.push_back(
          fmt::format("the output is late by {} s: with that delay a bank of plays misses {} instead of {}",
                      rounded_text(found), rounded_text(with_delay), rounded_text(without_delay)));
    }
  }
  out.frequency_hz = one_frequency(records);
  if (out.frequency_hz)
    out.notes.push_back(
        fmt::format("every record repeats at {} Hz: how the stage depends on frequency they do not say",
                    rounded_text(*out.frequency_hz)));
  return out;
}

}  // namespace bodesmith::identify
