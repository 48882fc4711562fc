#include "fpaa/search/whole_capacitors.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/whole_number.hpp"

namespace bodesmith::fpaa {
namespace {

using Stage = DesignStage;

/// A stage's whole capacitors at given scales of its groups; false where one does not come to a unit.
bool rounded_at(Stage& stage, const Stage& exact_stage, const std::vector<std::vector<std::size_t>>& groups,
                double node_scale, double first, double second) {
  const std::vector<double>& exact = exact_stage.c;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    if (!(exact[i] > 0.0)) continue;
    double scale = std::ranges::find(groups[0], i) != groups[0].end() ? first : second;
    if (!stage.is_first() && (i == Stage::kCA || i == Stage::kC3)) scale *= node_scale;
    const double units = std::round(exact[i] * scale);
    if (units > stage.largest_units(i)) return false;
    stage.c[i] = units < 1.0 && exact_stage.may_be_left_out(i) ? 0.0 : std::max(1.0, units);
  }
  return true;
}

/// Whole capacitors of a stage and what they cost: as they are, and where other stages make up for the gain.
struct WholeStage {
  std::vector<double> c;
  double cost = 0.0;  ///< squared
  double cost_but_gain = 0.0;
};

/// What it costs that a stage adds `got` to the weighted output where the exact one, with these errors, adds `exact`.
WholeStage cost_of(const std::vector<Complex>& errors, const std::vector<Complex>& exact,
                   const std::vector<Complex>& got) {
  WholeStage out{{}, 0.0, 0.0};
  double over = 0.0;
  double under = 0.0;
  for (std::size_t k = 0; k < got.size(); ++k) {
    over += got[k].real() * exact[k].real() + got[k].imag() * exact[k].imag();
    under += std::norm(got[k]);
  }
  const double gain = under > 0.0 ? over / under : 1.0;
  for (std::size_t k = 0; k < got.size(); ++k) {
    out.cost = std::max(out.cost, std::norm(errors[k] + got[k] - exact[k]));
    out.cost_but_gain = std::max(out.cost_but_gain, std::norm(errors[k] + gain * got[k] - exact[k]));
  }
  return out;
}

/// A stage's first op-amp against what its own output or input has at most; over 1: it clips first.
class InnerHeadroom {
 public:
  InnerHeadroom(const DesignResponse& response, std::size_t s)
      : clock_(response.table().clock(response.design().stages[s].divisor)) {
    // Any other node may be as large as the largest of the signal's ends.
    for (std::size_t k = 0; k < response.table().pairs(); ++k) in_.push_back(response.input_of(s, 0, k));
    for (std::size_t k = 0; k < response.table().points(); ++k)
      most_ = std::max({most_, std::abs(response.output(k)), std::abs(in_[k / 2].end1.at(k % 2))});
  }

  /// What it costs, as a factor on the error: half of it more for each factor of two.
  double cost(const Stage& stage) const {
    constexpr double kOfTwo = 0.5;
    double inner = 0.0;
    for (std::size_t k = 0; k < in_.size(); ++k) {
      inner = std::max(inner, first_opamp(stage, clock_[k], in_[k]).largest());
    }
    return inner > most_ ? 1.0 + kOfTwo * std::log2(inner / most_) : 1.0;
  }

 private:
  const std::vector<ClockFactors>& clock_;
  std::vector<Parts> in_;
  double most_ = 1.0;
};

/// Whole capacitors of a second-order stage whose resonance is nearest to the exact one: the `count` best. Rounding
/// each capacitor by itself leaves some 1/C of each; a sharp resonance needs more, and there are many sets:
///   low Q:   C4/CB and C2 C3/(CA CB);   high Q:   C4/C2 and C2 C3/(CA CB)
/// The mismatch of the four that place it counts in addition to that (in part: the judge counts it whole): CA and CB as large as their banks.
/// Complex zeros likewise: C1 C3/(Cpp CA), at whatever gain these come out best (other stages take it back).
std::vector<std::vector<double>> nearest_resonances(const Stage& exact, std::size_t count,
                                                    const MismatchModel& mismatch) {
  constexpr double kRatioOff = 0.015;
  constexpr double kLeastGain = 0.7;
  constexpr double kSpreadShare =
      0.3;  // of 0, .3, .5 and 1 that with which most kinds of filter keep what is wanted
  const bool high = exact.kind == Stage::Kind::second_high;
  const auto& e = exact.c;
  const double product = e[Stage::kC2] * e[Stage::kC3] / (e[Stage::kCA] * e[Stage::kCB]);
  const double ratio = e[Stage::kC4] / e[high ? Stage::kC2 : Stage::kCB];
  std::vector<std::pair<double, std::vector<double>>> found;
  const auto add = [&](double c2, double c3, double c4, double ca, double cb) {
    double off = std::abs(c2 * c3 / (ca * cb) / product - 1.0) +
                 std::abs(c4 / (high ? c2 : cb) / ratio - 1.0) / (high ? 4.0 : 1.0);
    double variance = 0.0;
    for (const double units : {c2, c3, ca, cb}) variance += std::pow(mismatch.relative_sigma(units), 2);
    off = snapped(error_of_95_percent(off, kSpreadShare * std::sqrt(variance)));
    if (found.size() == count && off >= found.back().first) return;
    std::vector<double> c = e;
    c[Stage::kC2] = c2;
    c[Stage::kC3] = c3;
    c[Stage::kC4] = c4;
    c[Stage::kCA] = ca;
    c[Stage::kCB] = cb;
    // Numerators over the same: C1 C3, Cp CA (high Q: Cp C3) and Cpp CA against CA CB.
    const double store = ca * cb / (e[Stage::kCA] * e[Stage::kCB]);
    const double scales[] = {store * e[Stage::kC3] / c3,
                             store * (high ? e[Stage::kC3] / c3 : e[Stage::kCA] / ca),
                             store * e[Stage::kCA] / ca};
    double gain = 1.0;
    if (e[Stage::kC1] > 0.0 && e[Stage::kCpp] > 0.0) {
      const double alone = e[Stage::kC1] * scales[Stage::kC1];
      const double zeros = e[Stage::kCpp] * scales[Stage::kCpp] / alone;
      double least = 1e300;
      for (double c1 = std::max(1.0, std::ceil(kLeastGain * alone)); c1 <= alone / kLeastGain; c1 += 1.0) {
        const double cpp = std::round(zeros * c1);
        const double wide = std::abs(cpp / (zeros * c1) - 1.0);
        if (cpp < 1.0 || cpp > kMostUnits || !(wide < least)) continue;
        least = wide;
        gain = c1 / alone;
      }
      off = snapped(off + std::min(least, 1.0));
      if (found.size() == count && off >= found.back().first) return;
    }
    for (const int i : {Stage::kC1, Stage::kCp, Stage::kCpp}) {
      const auto at = static_cast<std::size_t>(i);
      c[at] = std::round(e[at] * scales[i] * gain);
      if (c[at] > kMostUnits) return;
    }
    const auto at = std::ranges::find_if(found, [&](const auto& other) { return off < other.first; });
    found.insert(at, {off, std::move(c)});
    if (found.size() > count) found.pop_back();
  };
  const auto bank = static_cast<int>(exact.largest_units(Stage::kCA));
  for (int c2 = 1; c2 <= kMostUnits; c2 += c2 < 40 ? 1 : 3) {
    const double c4_high = std::round(ratio * c2);
    if (high && (c4_high > kMostUnits || std::abs(c4_high / c2 / ratio - 1.0) > kRatioOff)) continue;
    // What CA and CB of at least a quarter and half of the largest leave for C3.
    const double most = std::min<double>(kMostUnits, product * bank * bank / c2);
    const auto least = whole_number<int>(product * bank * bank / (8.0 * c2), 1);
    for (int c3 = least; c3 <= most; c3 += c3 < 40 ? 1 : 7) {
      for (int cb = bank / 2; cb <= bank; cb += (high ? 1 : 3) * bank / kMostUnits) {
        const double ca = std::round(c2 * c3 / (product * cb));
        if (ca < bank / 4.0 || ca > bank) continue;
        const double c4 = high ? c4_high : std::round(ratio * cb);
        if (c4 > kMostUnits || std::abs(c4 / (high ? c2 : cb) / ratio - 1.0) > kRatioOff) continue;
        add(c2, c3, c4, ca, cb);
      }
    }
  }
  std::vector<std::vector<double>> out;
  for (auto& [off, c] : found) out.push_back(std::move(c));
  return out;
}

/// Keeps the `count` cheapest by one of the costs.
void keep_cheapest(std::vector<WholeStage>& list, const WholeStage& next, std::size_t count,
                   double WholeStage::*cost) {
  if (list.size() == count && !(next.*cost < list.back().*cost)) return;
  const auto at = std::ranges::find_if(list, [&](const WholeStage& w) { return next.*cost < w.*cost; });
  list.insert(at, next);
  if (list.size() > count) list.pop_back();
}

/// What 95 % of boards keep in addition to the error, by the mismatch of one stage's own capacitors.
class StageSpread {
 public:
  StageSpread(const StagePlace& place, const Stage& exact, const std::vector<double>& weight,
              const MismatchModel& mismatch)
      : mismatch_(mismatch) {
    std::vector<Complex> slopes(exact.c.size() * place.points());
    place.slopes(exact, slopes.data());
    for (std::size_t c = 0; c < exact.c.size(); ++c) {
      std::vector<double> squares;
      for (std::size_t k = 0; exact.c[c] > 0.0 && k < place.points(); k += kEvery) {
        if (weight[k] >= 1.0) squares.push_back(std::norm(slopes[c * place.points() + k]));
      }
      squares_.push_back(std::move(squares));
      points_ = std::max(points_, squares_.back().size());
    }
  }

  double of(const std::vector<double>& c) const {
    std::vector<double> variance(points_, 0.0);
    for (std::size_t i = 0; i < c.size(); ++i) {
      if (!(c[i] > 0.0)) continue;
      const double sigma = mismatch_.relative_sigma(c[i]);
      for (std::size_t k = 0; k < squares_[i].size(); ++k) variance[k] += squares_[i][k] * sigma * sigma;
    }
    return error_of_95_percent(0.0, std::sqrt(*std::ranges::max_element(variance)));
  }

 private:
  static constexpr std::size_t kEvery = 3;
  MismatchModel mismatch_;
  std::vector<std::vector<double>> squares_;  ///< [capacitor][point]
  std::size_t points_ = 0;
};

/// Whole capacitors over a grid of scales of the groups: the cheapest as they are first, then those that are
/// cheapest when the gain is left to the others.
std::vector<std::vector<double>> whole_stages(const Design& design, std::size_t s,
                                              const StageFactorTable& table, const RoundingWidth& width) {
  const std::size_t choices = width.choices;
  Stage stage = design.stages[s];
  const std::vector<double> exact = stage.c;
  const DesignResponse response(design, table);
  const StagePlace place(response, response.ways(), s);
  const std::vector<Complex> errors = response.errors();
  const bool second_order = stage.kind != Stage::Kind::first;
  const auto largest_scale = [&](const std::vector<std::size_t>& group, double node_scale) {
    double out = 1e300;
    for (const std::size_t i : group) {
      const bool inner = second_order && (i == Stage::kCA || i == Stage::kC3);
      if (exact[i] > 0.0)
        out = std::min(out, stage.largest_units(i) / (exact[i] * (inner ? node_scale : 1.0)));
    }
    return out;
  };
  std::vector<WholeStage> as_is, but_gain;
  const InnerHeadroom headroom(response, s);
  const StageSpread spread(place, stage, table.target().weight, width.mismatch);
  std::vector<Complex> share, rounded;
  place.share_of(stage, share);
  const auto judge = [&] {
    place.share_of(stage, rounded);
    WholeStage whole = cost_of(errors, share, rounded);
    const double random = spread.of(stage.c);
    whole.cost = snapped(std::pow(std::sqrt(whole.cost) + random, 2));
    whole.cost_but_gain = snapped(std::pow(std::sqrt(whole.cost_but_gain) + random, 2));
    const bool enters = as_is.size() < choices || but_gain.size() < choices ||
                        whole.cost < as_is.back().cost || whole.cost_but_gain < but_gain.back().cost_but_gain;
    if (!enters) return;
    whole.c = stage.c;
    if (second_order) {
      const double clipping = headroom.cost(stage);
      whole.cost = snapped(whole.cost * clipping * clipping);
      whole.cost_but_gain = snapped(whole.cost_but_gain * clipping * clipping);
    }
    keep_cheapest(as_is, whole, choices, &WholeStage::cost);
    keep_cheapest(but_gain, whole, choices, &WholeStage::cost_but_gain);
  };
  const auto groups = scale_groups(stage);
  const int scales = second_order ? 8 : 48;
  const double smallest = second_order ? 0.35 : 0.4;
  for (int node = second_order ? -4 : 0; node <= (second_order ? 7 : 0); ++node) {
    const double node_scale = std::pow(2.0, node / 3.0);
    for (int a = 0; a < scales; ++a) {
      const double first =
          largest_scale(groups[0], node_scale) * std::pow(smallest, static_cast<double>(a) / scales);
      for (int b = 0; b < (second_order ? scales : 1); ++b) {
        const double second = second_order ? largest_scale(groups[1], node_scale) *
                                                 std::pow(smallest, static_cast<double>(b) / scales)
                                           : 1.0;
        if (!rounded_at(stage, design.stages[s], groups, node_scale, first, second) || !stage.is_stable())
          continue;
        judge();
      }
    }
  }
  if (second_order) {
    constexpr std::size_t kResonances = 120;
    stage.c = exact;
    for (std::vector<double>& c : nearest_resonances(stage, kResonances, width.mismatch)) {
      stage.c = std::move(c);
      if (stage.is_stable()) judge();
    }
  }
  std::vector<std::vector<double>> out;
  for (std::size_t i = 0; i < as_is.size(); ++i) {
    for (const WholeStage* whole : {&as_is[i], &but_gain[i]}) {
      if (out.size() < choices && std::ranges::find(out, whole->c) == out.end()) out.push_back(whole->c);
    }
  }
  return out;
}

/// Of a partly whole design: the largest error, and the share of the spread by mismatch of what is whole.
double error_with_mismatch(const Design& design, const StageFactorTable& table, const RoundingWidth& width) {
  const DesignResponse response(design, table);
  CapacitorEffects effects = capacitor_effects(response);
  std::erase_if(effects.list, [&](const CapacitorEffect& e) { return !design.stages[e.stage].whole; });
  double out = 0.0;
  for (const double here : errors_of_95_percent(response.errors(), effects, design, width.mismatch)) {
    if (!(here <= out)) out = here;
  }
  return out;
}

}  // namespace

std::vector<std::vector<std::size_t>> scale_groups(const Stage& stage) {
  if (stage.kind == Stage::Kind::first) {
    std::vector<std::size_t> all(stage.c.size());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
    return {all};
  }
  if (stage.kind == Stage::Kind::second_low) {
    return {{Stage::kC1, Stage::kC2, Stage::kCA},
            {Stage::kCp, Stage::kCpp, Stage::kC3, Stage::kC4, Stage::kCB}};
  }
  return {{Stage::kC1, Stage::kCp, Stage::kC2, Stage::kC4, Stage::kCA},
          {Stage::kCpp, Stage::kC3, Stage::kCB}};
}

bool make_whole(Design& design, const StageFactorTable& table, RoundingWidth width) {
  struct Partly {
    Design design;
    double error = 0.0;
  };
  std::vector<Partly> kept{{design, 0.0}};
  for (std::size_t s = 0; s < design.stages.size(); ++s) {
    std::vector<Partly> next;
    for (const Partly& from : kept) {
      for (const std::vector<double>& c : whole_stages(from.design, s, table, width)) {
        Partly to{from.design, 0.0};
        to.design.stages[s].c = c;
        to.design.stages[s].whole = true;
        fit_design(to.design, table, 8);
        if (width.designs > 1) to.error = snapped(error_with_mismatch(to.design, table, width));
        next.push_back(std::move(to));
      }
    }
    if (next.empty()) return false;
    std::ranges::stable_sort(next, {}, &Partly::error);
    if (next.size() > width.designs) next.resize(width.designs);
    kept = std::move(next);
  }
  design = std::move(kept.front().design);
  return true;
}

}  // namespace bodesmith::fpaa
