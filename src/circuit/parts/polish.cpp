#include "circuit/parts/polish.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "circuit/parts/stage_errors.hpp"

namespace bodesmith::circuit {
namespace {

constexpr int kPolishNeighbours = 7;

/// One or two values of a stage changed, and the stage's error then.
struct Move {
  std::vector<double> values;
  std::vector<std::complex<double>> error;
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

  std::vector<std::complex<double>> error(const std::vector<double>& values) const {
    return errors_.logarithms(values);
  }

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
      std::vector<std::complex<double>> rest = sum_;
      for (std::size_t k = 0; k < count; ++k) rest[k] -= errors_[a][k];
      for (const Move& move : stages_[a].moves()) {
        take_if_better(norm_of(norm, count, best_, [&](std::size_t k) { return rest[k] + move.error[k]; }),
                       {a, &move}, {});
      }
      for (std::size_t b = a + 1; b < stages_.size(); ++b) {
        std::vector<std::complex<double>> both = rest;
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
  std::vector<std::vector<std::complex<double>>> errors_;
  std::vector<std::complex<double>> sum_;
  double best_ = 0.0;
  Choice chosen_[2];
};

}  // namespace

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

}  // namespace bodesmith::circuit
