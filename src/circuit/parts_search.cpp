#include "circuit/parts_search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "base/error.hpp"
#include "base/text.hpp"
#include "circuit/parts_polish.hpp"

namespace bodesmith::circuit {
namespace {

using Complex = std::complex<double>;

struct Candidate {
  std::vector<double> values;
  std::vector<Complex> error;  ///< ln(H/H_wanted) of this stage over the grid
  double rank = 0.0;
};

double worst(const std::vector<Complex>& error) {
  double out = 0.0;
  for (const Complex e : error) out = std::max(out, std::norm(e));
  return out;
}

/// Greatest |error| with the best constant gain taken out: what no other stage can make good.
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
  StageSearch(const StageForm& form, const RealiseOptions& options, const std::vector<Hertz>& grid,
              size_t stages)
      : form_(form),
        options_(options),
        alone_(stages == 1),
        few_stages_(stages <= 3),
        neighbours_(stages == 1 ? 6 : (stages == 2 ? 4 : 2)) {
    for (const Hertz f : grid) {
      w_.push_back(f.rad_s());
      wanted_.push_back(form.wanted().response(f.rad_s()));
    }
    for (const StagePart& part : form.parts()) {
      resistors_ += part.kind == Part::Kind::resistor && !part.fixed ? 1 : 0;
    }
  }

  std::vector<Candidate> all() {
    // A decade of capacitors from the least; a decade up where that leaves some resistor out of its limits.
    for (shift_ = 1.0; found_.empty() && shift_ < 1e5; shift_ *= 10.0) {
      std::vector<double> chosen;
      choose(chosen);
    }
    const size_t most = 400;
    for (Candidate& one : found_) one.rank = alone_ ? worst(one.error) : worst_shape(one.error);
    std::stable_sort(found_.begin(), found_.end(),
                     [](const Candidate& a, const Candidate& b) { return a.rank < b.rank; });
    if (found_.size() > most) found_.resize(most);
    return std::move(found_);
  }

 private:
  /// Smallest capacitor that keeps the resistor at this frequency within limits.
  double least_capacitor(size_t i) const {
    const double w = form_.capacitor_frequencies()[i].value;
    return std::max(options_.least_f, 1.0 / (w * options_.greatest_ohm));
  }

  std::vector<double> choices(size_t i, const std::vector<double>& chosen) const {
    const double w = form_.capacitor_frequencies()[i].value;
    const double most = std::min(options_.greatest_f, 1.0 / (w * options_.least_ohm));
    double low = least_capacitor(i);
    double high = 0.0;
    if (i == 0) {
      // Small capacitors: they load the stage before. But where even small ones leave modest resistors, there
      // is no need to go down to where stray capacitance counts.
      low = std::max(low, std::min(kPleasant, 1.0 / (w * kModestOhm)));
      for (size_t j = 1; j < form_.capacitor_frequencies().size(); ++j) {
        low = std::max(low, least_capacitor(j) * form_.capacitor_ratios()[0] / form_.capacitor_ratios()[j]);
      }
      low *= shift_;
      high = low * 10.0;
    } else {
      const double target = chosen[0] * form_.capacitor_ratios()[i] / form_.capacitor_ratios()[0];
      const bool coarse = options_.capacitors.name() == "E3" || options_.capacitors.name() == "E6";
      // A drawer may hold one value a decade: take what comes near.
      // Few parts have nothing else to make good with than other ratios of their capacitors.
      const double usual =
          options_.capacitors.is_stock() || (few_stages_ && resistors_ <= 3) ? 3.3 : (coarse ? 1.6 : 1.3);
      const double slack = std::max(usual, form_.capacitor_slacks()[i]);
      low = std::max(low, target / slack);
      high = target * slack;
    }
    high = std::min(high, most);
    if (high < low * (1.0 - 1e-9)) return {};
    if (!options_.capacitors.is_exact()) return options_.capacitors.values(low, high);
    // Exact parts still begin at a round value where one is free.
    if (i > 0)
      return {std::clamp(chosen[0] * form_.capacitor_ratios()[i] / form_.capacitor_ratios()[0], low, high)};
    const std::vector<double> round = Series::named("E12").values(low, high);
    return round.empty() ? std::vector<double>{std::sqrt(low * high)} : round;
  }

  void choose(std::vector<double>& chosen) {
    if (chosen.size() == form_.capacitor_frequencies().size()) {
      std::vector<double> values;
      if (form_.design(chosen, values)) round(values);
      return;
    }
    for (const double c : choices(chosen.size(), chosen)) {
      chosen.push_back(c);
      choose(chosen);
      chosen.pop_back();
    }
  }

  bool is_resistor(size_t i) const { return form_.parts()[i].kind == Part::Kind::resistor; }

  void round(const std::vector<double>& exact) {
    std::vector<std::vector<double>> near(exact.size());
    for (size_t i = 0; i < exact.size(); ++i) {
      if (!std::isfinite(exact[i]) || !(exact[i] > 0.0)) return;
      if (!is_resistor(i) || form_.parts()[i].fixed) {
        near[i] = {is_resistor(i) ? options_.resistors.nearest(exact[i]) : exact[i]};
        continue;
      }
      for (const double r :
           options_.resistors.nearest(exact[i], resistors_ <= 3 ? neighbours_ : (resistors_ <= 7 ? 7 : 5))) {
        if (r >= options_.least_ohm * (1 - 1e-9) && r <= options_.greatest_ohm * (1 + 1e-9))
          near[i].push_back(r);
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

  void every(const std::vector<std::vector<double>>& near, std::vector<double>& values, size_t i) {
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
    std::vector<double> values;
    for (const auto& list : near) values.push_back(list.front());
    descend(near, values);
    // A few other starts: exchange ends where no pair helps, which need not be the best there is.
    std::vector<double> best = values;
    double least = miss(values);
    std::mt19937_64 chance(46);
    // Only where these capacitors promise something.
    const int starts = least <= 2.0 * least_exchanged_ ? kStarts : 0;
    for (int start = 0; start < starts; ++start) {
      for (size_t i = 0; i < values.size(); ++i)
        values[i] = near[i][chance() % std::min<size_t>(near[i].size(), 3)];
      descend(near, values);
      if (const double here = miss(values); here < least) {
        least = here;
        best = values;
      }
    }
    least_exchanged_ = std::min(least_exchanged_, least);
    keep(best);
    for (size_t i = 0; i < best.size(); ++i) {
      for (const double a : near[i]) {
        if (a == best[i]) continue;
        std::vector<double> trial = best;
        trial[i] = a;
        keep(trial);
      }
    }
  }

  void descend(const std::vector<std::vector<double>>& near, std::vector<double>& values) const {
    double best = miss(values);
    std::vector<double> trial;
    for (bool better = true; better;) {
      better = false;
      for (size_t i = 0; i < values.size(); ++i) {
        for (const double a : near[i]) {
          for (size_t j = i + 1; j < values.size(); ++j) {
            if (near[j].size() == 1) continue;
            for (const double b : near[j]) {
              trial = values;
              trial[i] = a;
              trial[j] = b;
              const double here = miss(trial, best);
              if (here < best * (1.0 - 1e-9)) {
                best = here;
                values = trial;
                better = true;
              }
            }
          }
        }
      }
    }
  }

  /// Greatest |H/H_wanted - 1|^2; stops looking once it is above `enough`.
  double miss(const std::vector<double>& values,
              double enough = std::numeric_limits<double>::infinity()) const {
    const Biquad h = form_.aim(values);
    double out = 0.0;
    for (size_t i = 0; i < w_.size() && out <= enough; ++i) {
      const double w = w_[i].value;
      const Complex numerator(h.b0 - w * w * h.b2, w * h.b1), denominator(h.a0 - w * w * h.a2, w * h.a1);
      out = std::max(out,
                     std::norm(numerator - wanted_[i] * denominator) / std::norm(wanted_[i] * denominator));
    }
    return out;
  }

  std::vector<Complex> error_of(const std::vector<double>& values) const {
    const Biquad h = form_.aim(values);
    std::vector<Complex> out(w_.size());
    for (size_t i = 0; i < w_.size(); ++i) out[i] = std::log(h.response(w_[i]) / wanted_[i]);
    return out;
  }

  void keep(const std::vector<double>& values) {
    if (alone_) {
      // No other stage makes good what this one misses.
      const double here = miss(values);
      if (here > 4.0 * least_) return;
      least_ = std::min(least_, here);
    }
    found_.push_back({values, error_of(values)});
  }

  static constexpr double kPleasant = 1e-9;
  static constexpr double kModestOhm = 20e3;
  static constexpr int kStarts = 6;

  const StageForm& form_;
  const RealiseOptions& options_;
  bool alone_;
  bool few_stages_;
  int neighbours_;
  double shift_ = 1.0;
  double least_exchanged_ = std::numeric_limits<double>::infinity();
  double least_ = std::numeric_limits<double>::infinity();
  int resistors_ = 0;
  std::vector<RadPerSecond> w_;
  std::vector<Complex> wanted_;
  std::vector<Candidate> found_;
};

/// Least greatest error of the sum over the stages; a large even norm leads the way, the greatest value
/// decides.
class Exchange {
 public:
  explicit Exchange(const std::vector<std::vector<Candidate>>& all) : all_(all) {
    points_ = all_.empty() || all_[0].empty() ? 0 : all_[0][0].error.size();
  }

  /// The best `count` choices of all starts, each once, best first.
  std::vector<std::vector<size_t>> best(size_t count) {
    std::vector<std::pair<double, std::vector<size_t>>> ends;
    std::mt19937_64 chance(20210901);  // fixed: the same parts every time
    const int starts = all_.size() == 1 ? static_cast<int>(count) : 24;
    for (int start = 0; start < starts; ++start) {
      std::vector<size_t> pick(all_.size(), 0);
      if (all_.size() == 1) {
        pick[0] = std::min<size_t>(static_cast<size_t>(start), all_[0].size() - 1);
        ends.emplace_back(worst(all_[0][pick[0]].error), pick);
        continue;
      }
      if (start > 0) {
        for (size_t i = 0; i < pick.size(); ++i) {
          pick[i] = chance() % std::min<size_t>(all_[i].size(), 1 + 4 * static_cast<size_t>(start));
        }
      }
      const double here = descend(pick);
      ends.emplace_back(here, pick);
    }
    std::sort(ends.begin(), ends.end());
    ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
    std::vector<std::vector<size_t>> out;
    for (size_t i = 0; i < ends.size() && i < count; ++i) out.push_back(ends[i].second);
    return out;
  }

 private:
  double descend(std::vector<size_t>& pick) const {
    std::vector<Complex> sum(points_, 0.0);
    for (size_t i = 0; i < pick.size(); ++i) {
      for (size_t k = 0; k < points_; ++k) sum[k] += all_[i][pick[i]].error[k];
    }
    double best = worst(sum);
    for (bool better = true; better;) {
      better = false;
      for (size_t i = 0; i < pick.size(); ++i) {
        std::vector<Complex> rest = sum;
        for (size_t k = 0; k < points_; ++k) rest[k] -= all_[i][pick[i]].error[k];
        size_t chosen = pick[i];
        for (size_t c = 0; c < all_[i].size(); ++c) {
          double here = 0.0;
          const auto& error = all_[i][c].error;
          for (size_t k = 0; k < points_ && here < best; ++k)
            here = std::max(here, std::norm(rest[k] + error[k]));
          if (here < best * (1.0 - 1e-9)) {
            best = here;
            chosen = c;
            better = true;
          }
        }
        pick[i] = chosen;
        for (size_t k = 0; k < points_; ++k) sum[k] = rest[k] + all_[i][chosen].error[k];
      }
    }
    return best;
  }

  const std::vector<std::vector<Candidate>>& all_;
  size_t points_ = 0;
};

/// Other candidates of single stages, polished again, until the goal is met: for stages with many resistors,
/// whose first candidates are only the ends of descents.
void improve(PartsFound& found, const std::vector<std::vector<Candidate>>& all,
             const std::vector<std::unique_ptr<StageForm>>& forms, const RealiseOptions& options,
             const std::vector<Hertz>& grid) {
  constexpr double kGoalPercent = 0.2;
  constexpr int kTrials = 10;
  constexpr size_t kAmong = 60;
  if (options.resistors.is_exact()) return;
  std::mt19937_64 chance(20210902);  // fixed: the same parts every time
  for (int trial = 0; trial < kTrials && found.worst_complex_percent > kGoalPercent; ++trial) {
    std::vector<std::vector<double>> values = found.values;
    const size_t stage = chance() % all.size();
    values[stage] = all[stage][chance() % std::min(all[stage].size(), kAmong)].values;
    const double percent = 100.0 * polish_parts(forms, options, grid, values);
    if (percent < found.worst_complex_percent) {
      found.worst_complex_percent = percent;
      found.values = std::move(values);
    }
  }
}

}  // namespace

PartsFound search_parts(const std::vector<std::unique_ptr<StageForm>>& forms,
                        const std::vector<std::string>& titles, const RealiseOptions& options,
                        const std::vector<Hertz>& grid) {
  std::vector<std::vector<Candidate>> all;
  for (size_t i = 0; i < forms.size(); ++i) {
    all.push_back(StageSearch(*forms[i], options, grid, forms.size()).all());
    if (all.back().empty()) {
      throw DesignError(
          fmt::format("stage {} ({}) cannot be made with resistors of {} to {} ohm and capacitors of {} to "
                      "{} F, expected wider "
                      "limits",
                      i + 1, titles[i], rounded_text(options.least_ohm), rounded_text(options.greatest_ohm),
                      rounded_text(options.least_f), rounded_text(options.greatest_f)));
    }
  }
  Exchange exchange(all);
  PartsFound out;
  out.worst_complex_percent = std::numeric_limits<double>::infinity();
  // Many stages have so many ways to make good for each other that one start is enough.
  const bool few_stages = forms.size() <= 3;
  for (const std::vector<size_t>& pick : exchange.best(few_stages ? 6 : 1)) {
    std::vector<std::vector<double>> values;
    for (size_t i = 0; i < pick.size(); ++i) values.push_back(all[i][pick[i]].values);
    const double percent = 100.0 * polish_parts(forms, options, grid, values);
    if (percent < out.worst_complex_percent) {
      out.worst_complex_percent = percent;
      out.values = std::move(values);
    }
  }
  if (few_stages) improve(out, all, forms, options, grid);
  return out;
}

}  // namespace bodesmith::circuit
