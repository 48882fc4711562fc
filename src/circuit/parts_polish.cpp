#include "circuit/parts_polish.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bodesmith::circuit {
namespace {

using Complex = std::complex<double>;

constexpr int kNeighbours = 7;

/// One or two values of a stage changed, and the stage's error then.
struct Move {
  std::vector<double> values;
  std::vector<Complex> error;
};

/// The size of an error over the grid: its greatest square, or the sum of squares, which leads over the sills
/// that the greatest has.
enum class Size { greatest, sum };

/// Of error(0), error(1), …; stops once it is above `enough`.
template <class Error>
double size_of(Size size, size_t count, double enough, Error error) {
  double out = 0.0;
  for (size_t k = 0; k < count && out < enough; ++k) {
    const double square = std::norm(error(k));
    out = size == Size::sum ? out + square : std::max(out, square);
  }
  return out;
}

class StageMoves {
 public:
  StageMoves(const StageForm& form, const RealiseOptions& options, const std::vector<Hertz>& grid)
      : form_(form), options_(options) {
    for (const Hertz f : grid) {
      w_.push_back(f.rad_s());
      wanted_.push_back(form.wanted().response(f.rad_s()));
    }
  }

  std::vector<Complex> error(const std::vector<double>& values) const {
    const Biquad h = form_.aim(values);
    std::vector<Complex> out(w_.size());
    for (size_t k = 0; k < w_.size(); ++k) out[k] = std::log(h.response(w_[k]) / wanted_[k]);
    return out;
  }

  /// Every change of one value first (`single_count` of them), then those of two.
  void make(const std::vector<double>& values) {
    moves_.clear();
    std::vector<std::vector<double>> near(values.size());
    for (size_t i = 0; i < values.size(); ++i) near[i] = neighbours(i, values[i]);
    std::vector<double> trial = values;
    for (size_t i = 0; i < values.size(); ++i) {
      for (const double a : near[i]) {
        trial[i] = a;
        moves_.push_back({trial, error(trial)});
      }
      trial[i] = values[i];
    }
    single_count_ = moves_.size();
    for (size_t i = 0; i < values.size(); ++i) {
      for (size_t j = i + 1; j < values.size(); ++j) {
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
  size_t single_count() const { return single_count_; }

 private:
  std::vector<double> neighbours(size_t i, double value) const {
    std::vector<double> out;
    const StagePart& part = form_.parts()[i];
    if (part.kind != Part::Kind::resistor || part.fixed) return out;
    for (const double r : options_.resistors.nearest(value, kNeighbours)) {
      if (r != value && r >= options_.least_ohm * (1.0 - 1e-9) && r <= options_.greatest_ohm * (1.0 + 1e-9))
        out.push_back(r);
    }
    return out;
  }

  const StageForm& form_;
  const RealiseOptions& options_;
  std::vector<RadPerSecond> w_;
  std::vector<Complex> wanted_;
  std::vector<Move> moves_;
  size_t single_count_ = 0;
};

class Polish {
 public:
  Polish(const std::vector<std::unique_ptr<StageForm>>& forms, const RealiseOptions& options,
         const std::vector<Hertz>& grid, std::vector<std::vector<double>>& values)
      : values_(values), sum_(grid.size(), 0.0) {
    for (size_t i = 0; i < forms.size(); ++i) {
      stages_.emplace_back(*forms[i], options, grid);
      errors_.push_back(stages_[i].error(values[i]));
      for (size_t k = 0; k < grid.size(); ++k) sum_[k] += errors_[i][k];
      stages_[i].make(values[i]);
    }
  }

  double greatest() const {
    return std::sqrt(size_of(Size::greatest, sum_.size(), kNoLimit, [&](size_t k) { return sum_[k]; }));
  }

  void descend(Size size) {
    best_ = size_of(size, sum_.size(), kNoLimit, [&](size_t k) { return sum_[k]; });
    while (step(size)) {
    }
  }

 private:
  static constexpr double kNoLimit = std::numeric_limits<double>::infinity();

  struct Choice {
    size_t stage = 0;
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
  bool step(Size size) {
    const size_t count = sum_.size();
    chosen_[0] = chosen_[1] = {};
    for (size_t a = 0; a < stages_.size(); ++a) {
      std::vector<Complex> rest = sum_;
      for (size_t k = 0; k < count; ++k) rest[k] -= errors_[a][k];
      for (const Move& move : stages_[a].moves()) {
        take_if_better(size_of(size, count, best_, [&](size_t k) { return rest[k] + move.error[k]; }),
                       {a, &move}, {});
      }
      for (size_t b = a + 1; b < stages_.size(); ++b) {
        std::vector<Complex> both = rest;
        for (size_t k = 0; k < count; ++k) both[k] -= errors_[b][k];
        for (size_t i = 0; i < stages_[a].single_count(); ++i) {
          const Move& first = stages_[a].moves()[i];
          for (size_t j = 0; j < stages_[b].single_count(); ++j) {
            const Move& second = stages_[b].moves()[j];
            take_if_better(size_of(size, count, best_,
                                   [&](size_t k) { return both[k] + first.error[k] + second.error[k]; }),
                           {a, &first}, {b, &second});
          }
        }
      }
    }
    for (const Choice& choice : chosen_) {
      if (choice.move == nullptr) continue;
      const size_t stage = choice.stage;
      const Move move = *choice.move;
      for (size_t k = 0; k < count; ++k) sum_[k] += move.error[k] - errors_[stage][k];
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

}  // namespace

double polish_parts(const std::vector<std::unique_ptr<StageForm>>& forms, const RealiseOptions& options,
                    const std::vector<Hertz>& grid, std::vector<std::vector<double>>& values) {
  Polish direct(forms, options, grid, values);
  if (options.resistors.is_exact()) return direct.greatest();
  std::vector<std::vector<double>> other = values;
  direct.descend(Size::greatest);
  if (forms.size() > 3) return direct.greatest();
  Polish led(forms, options, grid, other);
  led.descend(Size::sum);
  led.descend(Size::greatest);
  if (led.greatest() < direct.greatest()) values = other;
  return std::min(led.greatest(), direct.greatest());
}

}  // namespace bodesmith::circuit
