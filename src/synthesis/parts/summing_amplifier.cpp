#include "synthesis/parts/summing_amplifier.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.hpp"
#include "base/text.hpp"
#include "synthesis/parts/exchange.hpp"

namespace bodesmith::synthesis {
namespace {

constexpr double kOffsetV = 2e-3;

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

/// Resistance that makes the conductances at both inputs equal.
void set_balance(SummingResistors& r, const std::vector<double>& wanted) {
  r.balance = 0.0;
  if (std::ranges::none_of(wanted, [](double g) { return g > 0.0; })) return;
  const double lack = 1.0 / r.feedback + sum_at(r, wanted, false) - sum_at(r, wanted, true);
  r.balance_at_plus = lack > 0.0;
  r.balance = std::abs(lack) < 1e-9 / r.feedback ? 0.0 : 1.0 / std::abs(lack);
}

/// Feedback and weights near the exact ones for the least greatest error over the rows.
class SumSearch {
 public:
  SumSearch(std::vector<double> gains, const std::vector<std::vector<double>>& rows, const Series& series)
      : gains_(std::move(gains)), rows_(rows), series_(series) {
    for (std::size_t k = 0; k < gains_.size(); ++k) {
      volts_.push_back(0.0);
      for (const std::vector<double>& row : rows) volts_[k] = std::max(volts_[k], std::abs(row[k]));
      if (std::abs(gains_[k]) * volts_[k] < kLeastV) gains_[k] = 0.0;
    }
  }
  const std::vector<double>& gains() const { return gains_; }
  double least() const { return least_; }
  const SummingResistors& best() const { return best_; }

  void from(double feedback) {
    SummingResistors trial;
    trial.feedback = feedback;
    std::vector<std::vector<double>> near;
    const auto terms = std::ranges::count_if(gains_, [](double g) { return g != 0.0; });
    for (std::size_t k = 0; k < gains_.size(); ++k) {
      const std::optional<double> weight = weight_for(gains_[k], feedback, volts_[k]);
      if (!weight) return;
      near.push_back(*weight == 0.0 ? std::vector<double>{0.0}
                                    : series_.nearest(*weight, terms <= 5 ? 7 : 5));
      trial.weights.push_back(near.back().front());
    }
    set_balance(trial, gains_);
    std::vector<double> values = trial.weights;
    if (trial.balance >= kLeastOhm && trial.balance <= kGreatestOhm) {
      near.push_back(series_.nearest(trial.balance, 7));
      values.push_back(near.back().front());
    }
    const auto taken = [&](const std::vector<double>& some) {
      trial.weights.assign(some.begin(), some.begin() + static_cast<std::ptrdiff_t>(gains_.size()));
      trial.balance = some.size() > gains_.size() ? some.back() : 0.0;
    };
    const double worst = exchange_pairs(near, values, [&](const std::vector<double>& some, double enough) {
      taken(some);
      return error(trial, enough);
    });
    if (!(worst < least_)) return;
    least_ = worst;
    taken(values);
    best_ = trial;
  }

 private:
  /// Terms that never exceed this count for nothing.
  static constexpr double kLeastV = 2e-5;

  double error(const SummingResistors& r, double enough) const {
    const std::vector<double> got = summing_gains(r, gains_);
    double worst = 0.0;
    for (std::size_t i = 0; i < rows_.size() && worst < enough; ++i) {
      double off = -rows_[i].back();
      for (std::size_t k = 0; k < gains_.size(); ++k) off += got[k] * rows_[i][k];
      worst = std::max(worst, std::abs(off));
    }
    return worst;
  }

  std::vector<double> gains_, volts_;  ///< volts: the greatest of each term
  const std::vector<std::vector<double>>& rows_;
  const Series& series_;
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

SummingDesign search_sum(const std::vector<double>& wanted, const std::vector<std::vector<double>>& rows,
                         const Series& series, const std::string& what) {
  SumSearch search(wanted, rows, series);
  const std::vector<double>& gains = search.gains();
  double largest = 0.0;
  for (const double g : gains) largest = std::max(largest, std::abs(g));
  // The largest gain's resistor is kLeastOhm or more; a decade of feedback values from there, 10 kohm if that is
  // higher.
  const double low = std::max(10e3, 2.0 * kLeastOhm * largest);
  const std::vector<double> feedbacks =
      series.is_exact() ? std::vector<double>{low} : series.values(low, 10.0 * low);
  for (const double feedback : feedbacks) search.from(feedback);
  if (!std::isfinite(search.least())) {
    throw DesignError(
        fmt::format("{}: gains up to {} next to small ones are too far apart for resistors of {} to {} ohm",
                    what, rounded_text(largest), rounded_text(kLeastOhm), rounded_text(kGreatestOhm)));
  }
  SummingDesign out;
  out.realised = out.exact = search.best();
  out.gains = summing_gains(out.realised, gains);
  for (std::size_t k = 0; k < gains.size(); ++k)
    out.exact.weights[k] = gains[k] == 0.0 ? 0.0 : out.exact.feedback / std::abs(gains[k]);
  if (out.realised.balance != 0.0) set_balance(out.exact, gains);
  return out;
}

}  // namespace bodesmith::synthesis
