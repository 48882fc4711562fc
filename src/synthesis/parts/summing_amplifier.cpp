#include "synthesis/parts/summing_amplifier.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.hpp"
#include "base/text.hpp"

namespace bodesmith::synthesis {
namespace {

constexpr double kOffsetV = 2e-3;
constexpr int kPoints = 24;

double conductance(double ohm) {
  return ohm > 0.0 ? 1.0 / ohm : 0.0;
}

double sum_at(const SummingResistors& r, const std::vector<double>& signs, bool plus) {
  double out = 0.0;
  for (size_t k = 0; k < signs.size(); ++k) {
    if (signs[k] != 0.0 && (signs[k] > 0.0) == plus) out += conductance(r.weights[k]);
  }
  return out + (r.balance_at_plus == plus ? conductance(r.balance) : 0.0);
}

/// Weights exact for this feedback; balance for these weights.
SummingResistors exact_for(const std::vector<double>& wanted, double feedback) {
  SummingResistors out;
  out.feedback = feedback;
  for (const double g : wanted) out.weights.push_back(g == 0.0 ? 0.0 : feedback / std::abs(g));
  return out;
}

/// Resistance that makes the conductances at both inputs equal.
void set_balance(SummingResistors& r, const std::vector<double>& wanted) {
  r.balance = 0.0;
  if (std::none_of(wanted.begin(), wanted.end(), [](double g) { return g > 0.0; })) return;
  const double lack = 1.0 / r.feedback + sum_at(r, wanted, false) - sum_at(r, wanted, true);
  r.balance_at_plus = lack > 0.0;
  r.balance = std::abs(lack) < 1e-9 / r.feedback ? 0.0 : 1.0 / std::abs(lack);
}

class Search {
 public:
  Search(const std::vector<double>& wanted, const std::vector<double>& scale, const Series& series)
      : wanted_(wanted), scale_(scale), series_(series) {}

  double least() const { return least_; }
  const SummingResistors& best() const { return best_; }

  void from(double feedback) {
    SummingResistors trial;
    trial.feedback = feedback;
    for (std::size_t k = 0; k < wanted_.size(); ++k) {
      const std::optional<double> weight = weight_for(wanted_[k], feedback, scale_[k]);
      if (!weight) return;
      trial.weights.push_back(*weight);
    }
    const auto terms =
        std::count_if(trial.weights.begin(), trial.weights.end(), [](double r) { return r != 0.0; });
    const int neighbours = terms <= 3 ? 5 : (terms <= 5 ? 3 : 2);
    near_.clear();
    for (const double weight : trial.weights) {
      near_.push_back(weight == 0.0 ? std::vector<double>{0.0} : series_.nearest(weight, neighbours));
    }
    weights(trial, 0);
  }

 private:
  void weights(SummingResistors& trial, size_t k) {
    if (k == wanted_.size()) {
      balance(trial);
      return;
    }
    for (const double ohm : near_[k]) {
      trial.weights[k] = ohm;
      weights(trial, k + 1);
    }
  }

  void balance(SummingResistors trial) {
    set_balance(trial, wanted_);
    if (trial.balance == 0.0 || trial.balance > kGreatestOhm) {
      trial.balance = 0.0;
      consider(trial);
      return;
    }
    for (const double ohm : series_.nearest(trial.balance, 3)) {
      trial.balance = ohm;
      if (ohm >= kLeastOhm) consider(trial);
    }
  }

  void consider(const SummingResistors& trial) {
    const std::vector<double> gains = summing_gains(trial, wanted_);
    double worst = 0.0;
    for (int i = 1; i <= kPoints && worst < least_; ++i) {
      const double x = static_cast<double>(i) / kPoints;
      double error = 0.0;
      for (size_t k = wanted_.size(); k-- > 0;) error = (error + (gains[k] - wanted_[k]) * scale_[k]) * x;
      worst = std::max(worst, std::abs(error));
    }
    if (worst < least_) {
      least_ = worst;
      best_ = trial;
    }
  }

  const std::vector<double>& wanted_;
  const std::vector<double>& scale_;
  const Series& series_;
  std::vector<std::vector<double>> near_;  ///< for each weight, the values tried
  double least_ = std::numeric_limits<double>::infinity();
  SummingResistors best_;
};

}  // namespace

std::optional<double> weight_for(double gain, double feedback, double volts) {
  const double least = feedback / kGreatestOhm, size = std::abs(gain);
  if (size * kLeastOhm > feedback * 1.001) return std::nullopt;
  if (size >= 0.999 * least) return feedback / size;
  const bool none = size < 0.5 * least;
  if ((none ? size : least - size) * volts > kOffsetV) return std::nullopt;
  return none ? 0.0 : kGreatestOhm;
}

std::vector<double> summing_gains(const SummingResistors& r, const std::vector<double>& signs) {
  const double minus = sum_at(r, signs, false), plus = sum_at(r, signs, true);
  std::vector<double> out;
  for (size_t k = 0; k < signs.size(); ++k) {
    const double siemens = signs[k] == 0.0 ? 0.0 : conductance(r.weights[k]);
    out.push_back(siemens == 0.0 || signs[k] < 0.0 ? -r.feedback * siemens
                                                   : siemens / plus * (1.0 + minus * r.feedback));
  }
  return out;
}

SummingDesign search_summing_resistors(const std::vector<double>& wanted, const std::vector<double>& scale,
                                       const Series& series) {
  double largest = 0.0;
  for (const double g : wanted) largest = std::max(largest, std::abs(g));
  Search search(wanted, scale, series);
  SummingDesign out;
  // The largest gain's resistor is kLeastOhm or more; a decade of feedback values from there, 10 kohm if that is
  // higher.
  const double low = std::max(10e3, 2.0 * kLeastOhm * largest);
  if (series.is_exact()) {
    search.from(low);
  } else {
    for (const double feedback : series.values(low, 10.0 * low)) search.from(feedback);
  }
  if (!std::isfinite(search.least())) {
    throw DesignError(
        fmt::format("the gains of a sum are too far apart (greatest {}) for resistors of {} to {} ohm",
                    rounded_text(largest), rounded_text(kLeastOhm), rounded_text(kGreatestOhm)));
  }
  out.realised = search.best();
  out.gains = summing_gains(out.realised, wanted);
  out.exact = exact_for(wanted, out.realised.feedback);
  set_balance(out.exact, wanted);
  if (out.realised.balance == 0.0) out.exact.balance = 0.0;
  return out;
}

namespace {

constexpr int kNeighbours = 5;
constexpr int kSweeps = 6;

class WeightExchange {
 public:
  /// Terms that never exceed `least_v` count for nothing.
  WeightExchange(std::vector<double> gains, const std::vector<std::vector<double>>& rows,
                 const Series& series, double least_v)
      : gains_(std::move(gains)), rows_(rows), series_(series) {
    for (std::size_t k = 0; k < gains_.size(); ++k) {
      volts_.push_back(0.0);
      for (const std::vector<double>& row : rows) volts_[k] = std::max(volts_[k], std::abs(row[k]));
      if (std::abs(gains_[k]) * volts_[k] < least_v) gains_[k] = 0.0;
    }
  }
  const std::vector<double>& gains() const { return gains_; }

  /// The best near the exact weights for this feedback; infinite when they are out of reach.
  double from(double feedback, SummingResistors& best) const {
    SummingResistors trial;
    trial.feedback = feedback;
    for (std::size_t k = 0; k < gains_.size(); ++k) {
      const std::optional<double> ohm = weight_for(gains_[k], feedback, volts_[k]);
      if (!ohm) return std::numeric_limits<double>::infinity();
      trial.weights.push_back(*ohm == 0.0 ? 0.0 : series_.nearest(*ohm));
    }
    double worst = error(trial);
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
      const double before = worst;
      for (std::size_t k = 0; k < gains_.size(); ++k) exchange(trial, trial.weights[k], worst);
      if (!(worst < 0.999 * before)) break;
    }
    best = trial;
    return worst;
  }

  double error(const SummingResistors& r) const {
    const std::vector<double> got = summing_gains(r, gains_);
    double worst = 0.0;
    for (const std::vector<double>& row : rows_) {
      double off = -row.back();
      for (std::size_t k = 0; k < gains_.size(); ++k) off += got[k] * row[k];
      worst = std::max(worst, std::abs(off));
    }
    return worst;
  }

 private:
  void exchange(const SummingResistors& trial, double& ohm, double& worst) const {
    if (ohm == 0.0) return;
    const double asked = ohm;
    double best = ohm;
    for (const double other : series_.nearest(asked, kNeighbours)) {
      ohm = other;
      const double got = error(trial);
      if (got < worst) {
        worst = got;
        best = other;
      }
    }
    ohm = best;
  }

  std::vector<double> gains_, volts_;  ///< volts: the greatest of each term
  const std::vector<std::vector<double>>& rows_;
  const Series& series_;
};

}  // namespace

SumDesign search_sum(const std::vector<double>& gains, const std::vector<std::vector<double>>& rows,
                     const Series& series, double least_v, const std::string& what) {
  const WeightExchange search(gains, rows, series, least_v);
  double largest = 0.0;
  for (const double g : search.gains()) largest = std::max(largest, std::abs(g));
  const double low = std::max(10e3, 1.2 * kLeastOhm * largest);
  const std::vector<double> feedbacks =
      series.is_exact() ? std::vector<double>{low} : series.values(low, 6.0 * low);
  SummingResistors best, one;
  double worst = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < feedbacks.size(); i += 3) {
    const double got = search.from(feedbacks[i], one);
    if (got < worst) {
      worst = got;
      best = one;
    }
  }
  if (!std::isfinite(worst)) {
    throw DesignError(
        fmt::format("{}: gains up to {} beside small ones are too far apart for resistors of {} to "
                    "{} ohm",
                    what, rounded_text(largest), rounded_text(kLeastOhm), rounded_text(kGreatestOhm)));
  }
  SumDesign out;
  out.feedback = best.feedback;
  out.realised = best.weights;
  for (const double g : search.gains()) out.wanted.push_back(g == 0.0 ? 0.0 : best.feedback / std::abs(g));
  out.gains = summing_gains(best, search.gains());
  return out;
}

}  // namespace bodesmith::synthesis
