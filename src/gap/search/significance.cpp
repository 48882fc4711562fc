#include "gap/search/significance.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <variant>

#include "signal/red_noise.hpp"
#include "signal/statistics.hpp"

namespace bodesmith::gap {
namespace {

/// Standard deviations by spectra alone between which the likelihood is asked, and the most that it is believed.
constexpr double kLikely = 2.5;
constexpr double kSure = 5.0;
constexpr double kMostBelieved = 10.0;

/// What belongs to each record, or nothing where there are frequency responses.
std::vector<std::span<const double>> by_record(const Experiments& train, std::span<const double> residuals) {
  std::vector<std::span<const double>> parts;
  std::size_t from = 0;
  for (const auto& e : train) {
    const auto* time = std::get_if<TimeExperiment>(&e);
    if (time == nullptr || from + time->scored() > residuals.size()) return {};
    parts.push_back(residuals.subspan(from, time->scored()));
    from += time->scored();
  }
  return parts;
}

}  // namespace

double significance_of(const SearchRecords& records, const std::vector<double>& before,
                       const std::vector<double>& after, const Effect& effect) {
  const auto parts_before = by_record(records.train, before);
  const auto parts_after = by_record(records.train, after);
  const bool responses = parts_before.empty() || parts_after.empty();
  // Red noise in a short record looks like a slow effect, and the effect then leaves it white.
  const double z = improvement_z(before, after, responses ? LowBins::as_they_are : LowBins::as_octaves_above);
  if (responses || !effect.adds_one_signal() || z < kLikely || z >= kSure) return z;
  const double gain =
      most_likely_red_noise(parts_after).log_likelihood - most_likely_red_noise(parts_before).log_likelihood;
  const double by_likelihood = std::sqrt(std::max(0.0, 2.0 * gain - 1.0));

  return std::max(z, std::min(by_likelihood, kMostBelieved));
}

}  // namespace bodesmith::gap
