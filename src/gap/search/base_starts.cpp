#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "gap/runner.hpp"
#include "gap/search/base_fit.hpp"

namespace bodesmith::gap {
namespace {

using Values = std::vector<double>;

/// Measured outputs in the order of the residuals; nothing for frequency responses, whose fits find their
/// hill alone.
std::optional<Values> measured_outputs(const Experiments& experiments) {
  Values measured;
  for (const auto& e : experiments) {
    const auto* time = std::get_if<TimeExperiment>(&e);
    if (time == nullptr) return std::nullopt;
    const auto part = time->scored_part(time->record().y);
    measured.insert(measured.end(), part.begin(), part.end());
  }
  return measured;
}

/// Sum of squares that the best multiple of a model's output leaves.
double left_by_best_gain(const Values& residual, const Values& measured) {
  double ym = 0.0;
  double yy = 0.0;
  double mm = 0.0;
  for (std::size_t i = 0; i < residual.size(); ++i) {
    const double y = residual[i] + measured[i];
    ym += y * measured[i];
    yy += y * y;
    mm += measured[i] * measured[i];
  }
  return yy > 0.0 ? mm - ym * ym / yy : mm;
}

/// The comb: the given values with the tuned ones multiplied, all together and each alone.
std::vector<Values> comb(const BaseFitOptions& options, const std::vector<Unknown>& unknowns,
                         const Values& given, const std::vector<std::size_t>& tuned) {
  std::vector<Values> all;
  for (double f = -options.comb_reach; f < options.comb_reach + 0.1 * options.comb_step;
       f += options.comb_step) {
    const auto tune = [&](Values& values, std::size_t k) {
      values[k] = std::clamp(given[k] * std::exp(f), unknowns[k].low, unknowns[k].high);
    };
    all.push_back(given);
    for (std::size_t k : tuned) tune(all.back(), k);
    if (tuned.size() < 2) continue;
    for (std::size_t k : tuned) {
      all.push_back(given);
      tune(all.back(), k);
    }
  }
  return all;
}

double apart(const Values& a, const Values& b, const std::vector<std::size_t>& tuned) {
  double most = 0.0;
  for (std::size_t k : tuned) most = std::max(most, std::abs(std::log(a[k] / b[k])));
  return most;
}

}  // namespace

std::vector<std::vector<double>> base_starts(const SearchSetting& setting, const Experiments& look) {
  const auto& options = setting.options.base;
  const auto unknowns = setting.initial.unknowns();
  const auto given = current_values(setting.initial);
  std::vector<std::size_t> tuned;
  for (std::size_t k = 0; k < unknowns.size(); ++k) {
    if (unknowns[k].is_frequency()) tuned.push_back(k);
  }
  std::vector<Values> starts = {given};
  const auto measured = measured_outputs(look);
  if (tuned.empty() || !measured) return starts;
  Runner runner(setting.initial, look);
  std::vector<std::pair<double, Values>> scored;
  Values residual;
  for (const auto& values : comb(options, unknowns, given, tuned)) {
    if (runner(values, residual)) scored.emplace_back(left_by_best_gain(residual, *measured), values);
  }
  std::stable_sort(scored.begin(), scored.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  for (const auto& each : scored) {
    const Values& values = each.second;
    // Neighbours on the comb lead to the same place.
    const bool near = std::any_of(starts.begin() + 1, starts.end(), [&](const Values& start) {
      return apart(start, values, tuned) < options.min_apart;
    });
    if (!near) starts.push_back(values);
    if (starts.size() >= options.max_starts) break;
  }
  return starts;
}

}  // namespace bodesmith::gap
