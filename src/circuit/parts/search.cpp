#include "circuit/parts/search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <random>

#include "base/text.hpp"
#include "circuit/parts/candidates.hpp"
#include "circuit/parts/exchange.hpp"
#include "circuit/parts/polish.hpp"

namespace bodesmith::circuit {
namespace {

constexpr std::size_t kFewStages = 3;

/// Other candidates of single stages, polished again, until the goal is met: for stages with many resistors,
/// whose first candidates are only the ends of descents.
void improve_few_stages(PartsFound& found, const std::vector<std::vector<StageCandidate>>& all,
                        const std::vector<std::unique_ptr<StageForm>>& forms, const RealiseOptions& options,
                        const SearchGrid& grid) {
  constexpr double kGoalPercent = 0.2;
  constexpr int kTrials = 10;
  constexpr std::size_t kAmong = 60;
  if (options.resistors.is_exact()) return;
  std::mt19937_64 chance(20210902);  // fixed: the same parts every time
  for (int trial = 0; trial < kTrials && found.worst_complex_percent > kGoalPercent; ++trial) {
    std::vector<std::vector<double>> values = found.values;
    const std::size_t stage = chance() % all.size();
    values[stage] = all[stage][chance() % std::min(all[stage].size(), kAmong)].values;
    const double percent = 100.0 * polish_parts(forms, options, grid, values);
    if (percent < found.worst_complex_percent) {
      found.worst_complex_percent = percent;
      found.values = std::move(values);
    }
  }
}

/// The candidates of every stage.
Outcome<std::vector<std::vector<StageCandidate>>> all_candidates(
    const std::vector<std::unique_ptr<StageForm>>& forms, const std::vector<std::string>& titles,
    const RealiseOptions& options, const SearchGrid& grid) {
  std::vector<std::vector<StageCandidate>> out;
  for (std::size_t i = 0; i < forms.size(); ++i) {
    out.push_back(stage_candidates(*forms[i], options, grid, forms.size()));
    if (!out.back().empty()) continue;
    const PartLimits& limits = options.limits;
    return Refusal{fmt::format(
        "stage {} ({}) cannot be made with resistors of {} to {} ohm and capacitors of {} to {} F, expected "
        "wider limits",
        i + 1, titles[i], rounded_text(limits.min_ohm), rounded_text(limits.max_ohm),
        rounded_text(limits.min_f), rounded_text(limits.max_f))};
  }
  return out;
}

}  // namespace

Outcome<PartsFound> search_parts(const std::vector<std::unique_ptr<StageForm>>& forms,
                                 const std::vector<std::string>& titles, const RealiseOptions& options,
                                 const SearchGrid& grid) {
  const auto candidates = all_candidates(forms, titles, options, grid);
  if (const Refusal* refusal = refusal_of(candidates)) return *refusal;
  const auto& all = std::get<0>(candidates);
  PartsFound out;
  out.worst_complex_percent = std::numeric_limits<double>::infinity();
  // Many stages have so many ways to make good for each other that one start is enough.
  const bool few_stages = forms.size() <= kFewStages;
  for (const std::vector<std::size_t>& pick : best_choices(all, few_stages ? 6 : 1)) {
    std::vector<std::vector<double>> values;
    for (std::size_t i = 0; i < pick.size(); ++i) values.push_back(all[i][pick[i]].values);
    const double percent = 100.0 * polish_parts(forms, options, grid, values);
    if (percent < out.worst_complex_percent) {
      out.worst_complex_percent = percent;
      out.values = std::move(values);
    }
  }
  // A zero on the axis within the grid, say, with values that no number describes.
  if (out.values.empty())
    return Refusal{"the stages' parts have no finite error over the band, expected another form"};
  if (few_stages) improve_few_stages(out, all, forms, options, grid);
  return out;
}

}  // namespace bodesmith::circuit
