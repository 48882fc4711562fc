#include "synthesis/parts/search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "base/progress.hpp"
#include "base/text.hpp"
#include "synthesis/parts/candidates.hpp"

namespace bodesmith::synthesis {
namespace {

constexpr int kPolishNeighbours = 7;

/// One or two values of a stage changed, and the stage's error then.
struct Move {
  std::vector<double> values;
  std::vector<Complex> error;
};

/// The norm of an error over the grid: its max. square, or the sum of squares, which leads over the sills
/// that the maximum has.
enum class Norm { max, sum };

/// Of error(0), error(1), …; stops once it is above `enough`.
template <class Error>
double norm_of(Norm norm, std::size_t count, double enough, Error error) {
  double out = 0.0;
  for (std::size_t k = 0; k < count && out < enough; ++k) {
    const double square = std::norm(error(k));
    out = norm == Norm::sum ? out + square : std::max(out, square);
  }
  return out;
}

class StageMoves {
 public:
  StageMoves(const StageForm& form, const RealiseOptions& options, const SearchGrid& grid)
      : form_(form), options_(options), errors_(form, grid) {}

  std::vector<Complex> error(const std::vector<double>& values) const { return errors_.logarithms(values); }

  /// Every change of one value first (`single_count` of them), then those of two.
  void make(const std::vector<double>& values) {
    moves_.clear();
    std::vector<std::vector<double>> near(values.size());
    for (std::size_t i = 0; i < values.size(); ++i) near[i] = neighbours(i, values[i]);
    std::vector<double> trial = values;
    for (std::size_t i = 0; i < values.size(); ++i) {
      for (const double a : near[i]) {
        trial[i] = a;
        moves_.push_back({trial, error(trial)});
      }
      trial[i] = values[i];
    }
    single_count_ = moves_.size();
    for (std::size_t i = 0; i < values.size(); ++i) {
      for (std::size_t j = i + 1; j < values.size(); ++j) {
        for (const double a : near[i]) {
          for (const double b : near[j]) {
            trial[i] = a;
            trial[j] = b;
            moves_.push_back({trial, error(trial)});
          }
        }
        trial[j] = values[j];
      }
      trial[i] = values[i];
    }
  }
  const std::vector<Move>& moves() const { return moves_; }
  std::size_t single_count() const { return single_count_; }

 private:
  std::vector<double> neighbours(std::size_t i, double value) const {
    std::vector<double> out;
    const StagePart& part = form_.parts()[i];
    if (part.kind != Part::Kind::resistor || part.fixed) return out;
    for (const double r : options_.resistors.nearest(value, kPolishNeighbours)) {
      if (r != value && options_.limits.allow(Part::Kind::resistor, r)) out.push_back(r);
    }
    return out;
  }

  const StageForm& form_;
  const RealiseOptions& options_;
  StageErrors errors_;
  std::vector<Move> moves_;
  std::size_t single_count_ = 0;
};

class Polish {
 public:
  Polish(const std::vector<std::unique_ptr<StageForm>>& forms, const RealiseOptions& options,
         const SearchGrid& grid, std::vector<std::vector<double>>& values)
      : values_(values), sum_(grid.at.size(), 0.0) {
    for (std::size_t i = 0; i < forms.size(); ++i) {
      stages_.emplace_back(*forms[i], options, grid);
      errors_.push_back(stages_[i].error(values[i]));
      for (std::size_t k = 0; k < grid.at.size(); ++k) sum_[k] += errors_[i][k];
      stages_[i].make(values[i]);
    }
  }

  double max_error() const {
    return std::sqrt(norm_of(Norm::max, sum_.size(), kNoLimit, [&](std::size_t k) { return sum_[k]; }));
  }

  void descend(Norm norm) {
    best_ = norm_of(norm, sum_.size(), kNoLimit, [&](std::size_t k) { return sum_[k]; });
    while (step(norm)) {
    }
  }

 private:
  static constexpr double kNoLimit = std::numeric_limits<double>::infinity();

  struct Choice {
    std::size_t stage = 0;
    const Move* move = nullptr;
  };

  bool take_if_better(double here, Choice first, Choice second) {
    if (!(here < best_ * (1.0 - 1e-9))) return false;
    best_ = here;
    chosen_[0] = first;
    chosen_[1] = second;
    return true;
  }

  /// The best of all changes; false when none is better.
  bool step(Norm norm) {
    const std::size_t count = sum_.size();
    chosen_[0] = chosen_[1] = {};
    for (std::size_t a = 0; a < stages_.size(); ++a) {
      std::vector<Complex> rest = sum_;
      for (std::size_t k = 0; k < count; ++k) rest[k] -= errors_[a][k];
      for (const Move& move : stages_[a].moves()) {
        take_if_better(norm_of(norm, count, best_, [&](std::size_t k) { return rest[k] + move.error[k]; }),
                       {a, &move}, {});
      }
      for (std::size_t b = a + 1; b < stages_.size(); ++b) {
        std::vector<Complex> both = rest;
        for (std::size_t k = 0; k < count; ++k) both[k] -= errors_[b][k];
        for (std::size_t i = 0; i < stages_[a].single_count(); ++i) {
          const Move& first = stages_[a].moves()[i];
          for (std::size_t j = 0; j < stages_[b].single_count(); ++j) {
            const Move& second = stages_[b].moves()[j];
            take_if_better(norm_of(norm, count, best_,
                                   [&](std::size_t k) { return both[k] + first.error[k] + second.error[k]; }),
                           {a, &first}, {b, &second});
          }
        }
      }
    }
    for (const Choice& choice : chosen_) {
      if (choice.move == nullptr) continue;
      const std::size_t stage = choice.stage;
      const Move move = *choice.move;
      for (std::size_t k = 0; k < count; ++k) sum_[k] += move.error[k] - errors_[stage][k];
      errors_[stage] = move.error;
      values_[stage] = move.values;
      stages_[stage].make(values_[stage]);
    }
    return chosen_[0].move != nullptr;
  }

  std::vector<std::vector<double>>& values_;
  std::vector<StageMoves> stages_;
  std::vector<std::vector<Complex>> errors_;
  std::vector<Complex> sum_;
  double best_ = 0.0;
  Choice chosen_[2];
};

/// Exchanges resistors of all stages for their neighbours in the series, two at a time (of one stage or of
/// two), while max. |ln(H/H_wanted)| (weighted) of the whole chain over the grid falls. `values`: a stage each,
/// in the order of its form's parts(). Returns that error.
double polish_parts(const std::vector<std::unique_ptr<StageForm>>& forms, const RealiseOptions& options,
                    const SearchGrid& grid, std::vector<std::vector<double>>& values) {
  Polish direct(forms, options, grid, values);
  if (options.resistors.is_exact()) return direct.max_error();
  std::vector<std::vector<double>> other = values;
  direct.descend(Norm::max);
  if (forms.size() > 3) return direct.max_error();
  Polish led(forms, options, grid, other);
  led.descend(Norm::sum);
  led.descend(Norm::max);
  if (led.max_error() < direct.max_error()) values = other;
  return std::min(led.max_error(), direct.max_error());
}

class Exchange {
 public:
  explicit Exchange(const std::vector<std::vector<StageCandidate>>& all) : all_(all) {
    points_ = all_.empty() || all_[0].empty() ? 0 : all_[0][0].error.size();
  }

  /// The best `count` choices of all starts, each once, best first.
  std::vector<std::vector<std::size_t>> best(std::size_t count) {
    std::vector<std::pair<double, std::vector<std::size_t>>> ends;
    std::mt19937_64 chance(20210901);  // fixed: the same parts every time
    const int starts = all_.size() == 1 ? static_cast<int>(count) : 24;
    for (int start = 0; start < starts; ++start) {
      std::vector<std::size_t> pick(all_.size(), 0);
      if (all_.size() == 1) {
        pick[0] = std::min<std::size_t>(static_cast<std::size_t>(start), all_[0].size() - 1);
        ends.emplace_back(worst_square(all_[0][pick[0]].error), pick);
        continue;
      }
      if (start > 0) {
        for (std::size_t i = 0; i < pick.size(); ++i) {
          pick[i] = chance() % std::min<std::size_t>(all_[i].size(), 1 + 4 * static_cast<std::size_t>(start));
        }
      }
      const double here = descend(pick);
      ends.emplace_back(here, pick);
    }
    std::ranges::sort(ends);
    ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
    std::vector<std::vector<std::size_t>> out;
    for (std::size_t i = 0; i < ends.size() && i < count; ++i) out.push_back(ends[i].second);
    return out;
  }

 private:
  double descend(std::vector<std::size_t>& pick) const {
    std::vector<Complex> sum(points_, 0.0);
    for (std::size_t i = 0; i < pick.size(); ++i) {
      for (std::size_t k = 0; k < points_; ++k) sum[k] += all_[i][pick[i]].error[k];
    }
    double best = worst_square(sum);
    for (bool better = true; better;) {
      stop_if_interrupted();
      better = false;
      for (std::size_t i = 0; i < pick.size(); ++i) {
        if (i % 16 == 15) stop_if_interrupted();
        std::vector<Complex> rest = sum;
        for (std::size_t k = 0; k < points_; ++k) rest[k] -= all_[i][pick[i]].error[k];
        std::size_t chosen = pick[i];
        for (std::size_t c = 0; c < all_[i].size(); ++c) {
          double here = 0.0;
          const auto& error = all_[i][c].error;
          for (std::size_t k = 0; k < points_ && here < best; ++k)
            here = std::max(here, std::norm(rest[k] + error[k]));
          if (here < best * (1.0 - 1e-9)) {
            best = here;
            chosen = c;
            better = true;
          }
        }
        pick[i] = chosen;
        for (std::size_t k = 0; k < points_; ++k) sum[k] = rest[k] + all_[i][chosen].error[k];
      }
    }
    return best;
  }

  const std::vector<std::vector<StageCandidate>>& all_;
  std::size_t points_ = 0;
};

/// One candidate of every stage so that max. |sum of the stages' errors| over the grid is small: descent by
/// one stage at a time from up to 24 starts (deterministic). The best `count` ends, each once, best first, as
/// places in `all`.
std::vector<std::vector<std::size_t>> best_choices(const std::vector<std::vector<StageCandidate>>& all,
                                                   std::size_t count) {
  return Exchange(all).best(count);
}

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

}  // namespace bodesmith::synthesis
