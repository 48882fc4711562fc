#include "synthesis/parts/candidates.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "synthesis/parts/exchange.hpp"

namespace bodesmith::synthesis {
namespace {

/// Max. |error| with the best constant gain taken out: what no other stage can make good.
double worst_shape(const std::vector<Complex>& error) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const Complex e : error) {
    low = std::min(low, e.real());
    high = std::max(high, e.real());
  }
  const double middle = 0.5 * (low + high);
  double out = 0.0;
  for (const Complex e : error) out = std::max(out, std::norm(e - middle));
  return out;
}

/// The candidates of one stage.
class StageSearch {
 public:
  StageSearch(const StageForm& form, const RealiseOptions& options, const SearchGrid& grid,
              std::size_t stages)
      : form_(form),
        options_(options),
        alone_(stages == 1),
        few_stages_(stages <= 3),
        neighbours_(stages == 1 ? 6 : (stages == 2 ? 4 : 2)),
        errors_(form, grid) {
    for (const StagePart& part : form.parts()) {
      resistors_ += part.kind == Part::Kind::resistor && !part.fixed ? 1 : 0;
    }
  }

  std::vector<StageCandidate> all() {
    // A decade of capacitors from the smallest; a decade up where that leaves some resistor out of its limits.
    for (shift_ = 1.0; found_.empty() && shift_ < 1e5; shift_ *= 10.0) {
      std::vector<double> chosen;
      choose(chosen);
    }
    for (StageCandidate& one : found_) one.rank = alone_ ? worst_square(one.error) : worst_shape(one.error);
    std::ranges::stable_sort(found_, {}, &StageCandidate::rank);
    if (found_.size() > kMaxCandidates) found_.resize(kMaxCandidates);
    return std::move(found_);
  }

 private:
  /// Smallest capacitor that keeps the resistor at this frequency within limits.
  double min_capacitor(std::size_t i) const {
    const double w = form_.capacitor_choices()[i].works_at.value;
    return std::max(options_.limits.min_f, 1.0 / (w * options_.limits.max_ohm));
  }

  std::vector<double> choices(std::size_t i, const std::vector<double>& chosen) const {
    const double w = form_.capacitor_choices()[i].works_at.value;
    const double max_f = std::min(options_.limits.max_f, 1.0 / (w * options_.limits.min_ohm));
    double low = min_capacitor(i);
    double high = 0.0;
    if (i == 0) {
      // Small capacitors: they load the stage before. But where even small ones leave modest resistors, there
      // is no need to go down to where stray capacitance counts.
      low = std::max(low, std::min(kPleasant, 1.0 / (w * kModestOhm)));
      for (std::size_t j = 1; j < form_.capacitor_choices().size(); ++j) {
        low = std::max(
            low, min_capacitor(j) * form_.capacitor_choices()[0].ratio / form_.capacitor_choices()[j].ratio);
      }
      low *= shift_;
      high = low * 10.0;
    } else {
      const double target =
          chosen[0] * form_.capacitor_choices()[i].ratio / form_.capacitor_choices()[0].ratio;
      const bool coarse = options_.capacitors.is_coarse();
      // A drawer may hold one value a decade: take what comes near.
      // Few parts have nothing else to make good with than other ratios of their capacitors.
      const double usual =
          options_.capacitors.is_stock() || (few_stages_ && resistors_ <= 3) ? 3.3 : (coarse ? 1.6 : 1.3);
      const double slack = std::max(usual, form_.capacitor_choices()[i].slack);
      low = std::max(low, target / slack);
      high = target * slack;
    }
    high = std::min(high, max_f);
    if (high < low * (1.0 - 1e-9)) return {};
    if (!options_.capacitors.is_exact()) return options_.capacitors.values(low, high);
    // Exact parts still begin at a round value where one is free.
    if (i > 0)
      return {std::clamp(chosen[0] * form_.capacitor_choices()[i].ratio / form_.capacitor_choices()[0].ratio,
                         low, high)};
    const std::vector<double> round = Series::named("E12").values(low, high);
    return round.empty() ? std::vector<double>{std::sqrt(low * high)} : round;
  }

  void choose(std::vector<double>& chosen) {
    if (chosen.size() == form_.capacitor_choices().size()) {
      if (const auto values = form_.design(chosen)) round(*values);
      return;
    }
    for (const double c : choices(chosen.size(), chosen)) {
      chosen.push_back(c);
      choose(chosen);
      chosen.pop_back();
    }
  }

  bool is_resistor(std::size_t i) const { return form_.parts()[i].kind == Part::Kind::resistor; }

  void round(const std::vector<double>& exact) {
    std::vector<std::vector<double>> near(exact.size());
    for (std::size_t i = 0; i < exact.size(); ++i) {
      if (!std::isfinite(exact[i]) || !(exact[i] > 0.0)) return;
      if (!is_resistor(i) || form_.parts()[i].fixed) {
        near[i] = {is_resistor(i) ? options_.resistors.nearest(exact[i]) : exact[i]};
        continue;
      }
      for (const double r :
           options_.resistors.nearest(exact[i], resistors_ <= 3 ? neighbours_ : (resistors_ <= 7 ? 7 : 5))) {
        if (options_.limits.allow(Part::Kind::resistor, r)) near[i].push_back(r);
      }
      if (near[i].empty()) return;
    }
    if (resistors_ <= 3) {
      std::vector<double> values(exact.size());
      every(near, values, 0);
    } else {
      exchange(near);
    }
  }

  void every(const std::vector<std::vector<double>>& near, std::vector<double>& values, std::size_t i) {
    if (i == values.size()) {
      keep(values);
      return;
    }
    for (const double value : near[i]) {
      values[i] = value;
      every(near, values, i + 1);
    }
  }

  /// Many resistors: nearest first, then one and two at a time while the shape gets better.
  void exchange(const std::vector<std::vector<double>>& near) {
    const auto error = [this](const std::vector<double>& some, double enough) {
      return errors_.worst_square(some, enough);
    };
    std::vector<double> values;
    for (const auto& list : near) values.push_back(list.front());
    double min_error = exchange_pairs(near, values, error);
    // A few other starts: exchange ends where no pair helps, which need not be the best there is.
    std::vector<double> best = values;
    std::mt19937_64 chance(46);
    // Only where these capacitors promise something.
    const int starts = min_error <= 2.0 * min_exchanged_ ? kStarts : 0;
    for (int start = 0; start < starts; ++start) {
      for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = near[i][chance() % std::min<std::size_t>(near[i].size(), 3)];
      if (const double here = exchange_pairs(near, values, error); here < min_error) {
        min_error = here;
        best = values;
      }
    }
    min_exchanged_ = std::min(min_exchanged_, min_error);
    keep(best);
    for (std::size_t i = 0; i < best.size(); ++i) {
      for (const double a : near[i]) {
        if (a == best[i]) continue;
        std::vector<double> trial = best;
        trial[i] = a;
        keep(trial);
      }
    }
  }

  void keep(const std::vector<double>& values) {
    if (alone_) {
      // No other stage makes good what this one misses.
      const double here = errors_.worst_square(values, std::numeric_limits<double>::infinity());
      if (here > 4.0 * min_alone_) return;
      min_alone_ = std::min(min_alone_, here);
    }
    found_.push_back({values, errors_.logarithms(values)});
  }

  static constexpr std::size_t kMaxCandidates = 400;
  static constexpr double kPleasant = 1e-9;
  static constexpr double kModestOhm = 20e3;
  static constexpr int kStarts = 6;

  const StageForm& form_;
  const RealiseOptions& options_;
  bool alone_;
  bool few_stages_;
  int neighbours_;
  double shift_ = 1.0;
  double min_exchanged_ = std::numeric_limits<double>::infinity();
  double min_alone_ = std::numeric_limits<double>::infinity();
  int resistors_ = 0;
  StageErrors errors_;
  std::vector<StageCandidate> found_;
};

}  // namespace

double worst_square(const std::vector<Complex>& error) {
  double out = 0.0;
  for (const Complex e : error) out = std::max(out, std::norm(e));
  return out;
}

std::vector<StageCandidate> stage_candidates(const StageForm& form, const RealiseOptions& options,
                                             const SearchGrid& grid, std::size_t stages) {
  return StageSearch(form, options, grid, stages).all();
}

}  // namespace bodesmith::synthesis
