#include <algorithm>
#include <cmath>

#include "fpaa/network_fit.hpp"

namespace bodesmith::fpaa {
namespace {

using Complex = std::complex<double>;
using Stage = NetworkStage;

/// Capacitors that may be scaled together without a change of the response.
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

/// A stage's whole capacitors at given scales of its groups; false where one does not come to a unit.
bool rounded_at(Stage& stage, const std::vector<double>& exact, double node_scale, double first,
                double second, int max_capacitor) {
  for (std::size_t i = 0; i < exact.size(); ++i) {
    if (!(exact[i] > 0.0)) continue;
    double scale = first;
    if (stage.kind != Stage::Kind::first) {
      const auto groups = scale_groups(stage);
      const bool in_first = std::find(groups[0].begin(), groups[0].end(), i) != groups[0].end();
      scale = in_first ? first : second;
      if (i == Stage::kCA || i == Stage::kC3) scale *= node_scale;
    }
    const double units = std::round(exact[i] * scale);
    if (units > stage.largest_units(i, max_capacitor)) return false;
    stage.c[i] = std::max(1.0, units);
  }
  return true;
}

/// Whole capacitors of a stage and what they cost: as they are, and where other stages make up for the gain.
struct WholeStage {
  std::vector<double> c;
  double cost = 0.0;  ///< squared
  double cost_but_gain = 0.0;
};

/// Judges whole capacitors of one stage by the errors that the output has with them. The output is linear in the
/// response of one stage, so this is exact while the others stay as they are.
class StageCost {
 public:
  StageCost(const Network& network, std::size_t s, const NetworkResponse& response)
      : d_(response.d_of(network.stages[s].divisor)), errors_(response.errors(network)) {
    const Stage& stage = network.stages[s];
    const NetworkTarget& target = response.target();
    const auto nodes = response.nodes(network);
    const auto onward = response.onward(network);
    for (const int from : stage.from) {
      std::vector<Complex> way = onward[s];
      for (std::size_t k = 0; k < way.size(); ++k) way[k] *= target.weight[k] * target.reciprocal[k];
      if (from != Stage::kBoardInput) {
        const auto source = static_cast<std::size_t>(from);
        const std::vector<Complex>& read = response.read_of(network.stages[source].divisor, stage.divisor);
        for (std::size_t k = 0; k < way.size(); ++k) way[k] *= read[k] * nodes[source][k];
      }
      ways_.push_back(std::move(way));
    }
    exact_ = share_of(stage);
  }

  WholeStage of(const Stage& rounded) const {
    const std::vector<Complex> got = share_of(rounded);
    WholeStage out{rounded.c, 0.0, 0.0};
    double over = 0.0;
    double under = 0.0;
    for (std::size_t k = 0; k < got.size(); ++k) {
      over += (std::conj(got[k]) * exact_[k]).real();
      under += std::norm(got[k]);
    }
    const double gain = under > 0.0 ? over / under : 1.0;
    for (std::size_t k = 0; k < got.size(); ++k) {
      out.cost = std::max(out.cost, std::norm(errors_[k] + got[k] - exact_[k]));
      out.cost_but_gain = std::max(out.cost_but_gain, std::norm(errors_[k] + gain * got[k] - exact_[k]));
    }
    return out;
  }

 private:
  /// What a stage adds to the weighted output.
  std::vector<Complex> share_of(const Stage& stage) const {
    std::vector<Complex> out(d_.size(), 0.0);
    for (std::size_t i = 0; i < ways_.size(); ++i) {
      for (std::size_t k = 0; k < d_.size(); ++k) out[k] += stage.response(i, d_[k]) * ways_[i][k];
    }
    return out;
  }

  const std::vector<Complex>& d_;
  const std::vector<Complex> errors_;
  std::vector<std::vector<Complex>> ways_;  ///< from each input's share of the stage to the weighted output
  std::vector<Complex> exact_;
};

/// Keeps the `count` cheapest by one of the costs, each set of capacitors once.
void keep_cheapest(std::vector<WholeStage>& list, const WholeStage& next, std::size_t count,
                   double WholeStage::*cost) {
  if (list.size() == count && !(next.*cost < list.back().*cost)) return;
  for (const WholeStage& w : list) {
    if (w.c == next.c) return;
  }
  const auto at =
      std::find_if(list.begin(), list.end(), [&](const WholeStage& w) { return next.*cost < w.*cost; });
  list.insert(at, next);
  if (list.size() > count) list.pop_back();
}

/// Whole capacitors over a grid of scales of the groups: the cheapest as they are first, then those that are
/// cheapest when the gain is left to the others.
std::vector<std::vector<double>> whole_stages(const Network& network, std::size_t s,
                                              const NetworkResponse& response, std::size_t choices) {
  Stage stage = network.stages[s];
  const std::vector<double> exact = stage.c;
  const StageCost judge(network, s, response);
  const int max = response.target().max_capacitor;
  const bool second_order = stage.kind != Stage::Kind::first;
  const auto largest_scale = [&](const std::vector<std::size_t>& group, double node_scale) {
    double out = 1e300;
    for (const std::size_t i : group) {
      const bool inner = second_order && (i == Stage::kCA || i == Stage::kC3);
      if (exact[i] > 0.0)
        out = std::min(out, stage.largest_units(i, max) / (exact[i] * (inner ? node_scale : 1.0)));
    }
    return out;
  };
  std::vector<WholeStage> as_is, but_gain;
  const auto groups = scale_groups(stage);
  const int scales = second_order ? 12 : 48;
  const double smallest = second_order ? 0.35 : 0.4;
  for (int node = second_order ? -5 : 0; node <= (second_order ? 5 : 0); ++node) {
    const double node_scale = std::pow(2.0, node / 3.0);
    for (int a = 0; a < scales; ++a) {
      const double first =
          largest_scale(groups[0], node_scale) * std::pow(smallest, static_cast<double>(a) / scales);
      for (int b = 0; b < (second_order ? scales : 1); ++b) {
        const double second = second_order ? largest_scale(groups[1], node_scale) *
                                                 std::pow(smallest, static_cast<double>(b) / scales)
                                           : 1.0;
        if (!rounded_at(stage, exact, node_scale, first, second, max) || !stage.is_stable()) continue;
        const WholeStage whole = judge.of(stage);
        keep_cheapest(as_is, whole, choices, &WholeStage::cost);
        keep_cheapest(but_gain, whole, choices, &WholeStage::cost_but_gain);
      }
    }
  }
  std::vector<std::vector<double>> out;
  for (std::size_t i = 0; i < as_is.size(); ++i) {
    for (const WholeStage* whole : {&as_is[i], &but_gain[std::min(i, but_gain.size() - 1)]}) {
      if (out.size() < choices && std::find(out.begin(), out.end(), whole->c) == out.end())
        out.push_back(whole->c);
    }
  }
  return out;
}

}  // namespace

bool round_network(Network& network, const NetworkResponse& response, RoundingWidth width) {
  struct Partly {
    Network network;
    double error = 0.0;
  };
  std::vector<Partly> kept{{network, 0.0}};
  for (std::size_t s = 0; s < network.stages.size(); ++s) {
    std::vector<Partly> next;
    for (const Partly& from : kept) {
      for (const std::vector<double>& c : whole_stages(from.network, s, response, width.choices)) {
        Partly to{from.network, 0.0};
        to.network.stages[s].c = c;
        std::fill(to.network.stages[s].free.begin(), to.network.stages[s].free.end(), 0);
        fit_network(to.network, response, 8);
        if (width.networks > 1) to.error = largest_error(response.errors(to.network));
        next.push_back(std::move(to));
      }
    }
    if (next.empty()) return false;
    std::stable_sort(next.begin(), next.end(),
                     [](const Partly& a, const Partly& b) { return a.error < b.error; });
    if (next.size() > width.networks) next.resize(width.networks);
    kept = std::move(next);
  }
  network = std::move(kept.front().network);
  return true;
}

}  // namespace bodesmith::fpaa
