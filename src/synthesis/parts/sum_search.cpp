#include "synthesis/parts/sum_search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/error.hpp"
#include "base/text.hpp"
#include "synthesis/parts/summing_amplifier.hpp"

namespace bodesmith::circuit {
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

}  // namespace bodesmith::circuit
