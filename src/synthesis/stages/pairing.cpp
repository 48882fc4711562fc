#include "synthesis/stages/pairing.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace bodesmith::synthesis {
namespace {

constexpr int kGrid = 41;
constexpr size_t kExact = 14;

using Row = std::vector<double>;

double peak(const Row& row) {
  double out = 0.0;
  for (const double value : row) out = std::max(out, std::abs(value));
  return out;
}

Row plus(Row a, const Row& b) {
  for (size_t i = 0; i < a.size(); ++i) a[i] += b[i];
  return a;
}

/// Least greatest peak over all prefixes; the whole set's own peak is the same in any order and does not
/// count.
std::vector<size_t> best_order(const std::vector<Row>& rows) {
  const size_t n = rows.size();
  const size_t sets = size_t{1} << n;
  std::vector<float> worst(sets, std::numeric_limits<float>::infinity());
  std::vector<float> total(sets, 0.0F);
  std::vector<unsigned char> last(sets, 0);
  worst[0] = 0.0F;
  Row sum(rows[0].size());
  for (size_t set = 1; set < sets; ++set) {
    std::ranges::fill(sum, 0.0);
    for (size_t i = 0; i < n; ++i) {
      if ((set >> i & 1U) != 0) sum = plus(std::move(sum), rows[i]);
    }
    const float own = static_cast<float>(peak(sum));
    for (size_t i = 0; i < n; ++i) {
      if ((set >> i & 1U) == 0) continue;
      const size_t before = set ^ (size_t{1} << i);
      const float here = std::max(worst[before], own);
      const float there = total[before] + own;
      if (here < worst[set] || (here == worst[set] && there < total[set])) {
        worst[set] = here;
        total[set] = there;
        last[set] = static_cast<unsigned char>(i);
      }
    }
  }
  std::vector<size_t> order;
  for (size_t set = sets - 1; set != 0; set ^= size_t{1} << order.back()) order.push_back(last[set]);
  std::ranges::reverse(order);
  return order;
}

std::vector<size_t> greedy_order(const std::vector<Row>& rows) {
  std::vector<size_t> left(rows.size()), order;
  std::iota(left.begin(), left.end(), size_t{0});
  Row sum(rows[0].size(), 0.0);
  while (!left.empty()) {
    const auto best = std::ranges::min_element(
        left, [&](size_t a, size_t b) { return peak(plus(sum, rows[a])) < peak(plus(sum, rows[b])); });
    sum = plus(std::move(sum), rows[*best]);
    order.push_back(*best);
    left.erase(best);
  }
  return order;
}

bool all_real(const Section& section) {
  const auto real = [](Complex r) { return r.imag() == 0.0; };
  return std::ranges::all_of(section.zeros, real) && std::ranges::all_of(section.poles, real);
}

double distance(Complex zero, Complex pole) {
  // A zero at the origin is infinitely far from every pole: the lowest pole takes it.
  if (std::abs(zero) == 0.0) return 0.0;
  // A pole there takes the lowest zero: R and C in series round an op-amp.
  if (std::abs(pole) == 0.0) return 0.0;
  return std::abs(std::log(std::abs(zero) / std::abs(pole)));
}

/// zeros.size() <= poles.size(), both sorted. Pole of each zero.
std::vector<size_t> pair_sorted(const std::vector<Complex>& zeros, const std::vector<Complex>& poles) {
  struct Cost {
    double worst = std::numeric_limits<double>::infinity();
    double sum = std::numeric_limits<double>::infinity();
    bool operator<(const Cost& other) const {
      if (worst != other.worst) return worst < other.worst;
      return sum < other.sum;
    }
  };
  const size_t n = zeros.size(), m = poles.size();
  // best[i][j]: the first i zeros among the first j poles.
  std::vector<std::vector<Cost>> best(n + 1, std::vector<Cost>(m + 1));
  std::vector<std::vector<char>> taken(n + 1, std::vector<char>(m + 1, 0));
  for (size_t j = 0; j <= m; ++j) best[0][j] = {0.0, 0.0};
  for (size_t i = 1; i <= n; ++i) {
    for (size_t j = i; j <= m; ++j) {
      const double d = distance(zeros[i - 1], poles[j - 1]);
      const Cost with = {std::max(best[i - 1][j - 1].worst, d), best[i - 1][j - 1].sum + d};
      best[i][j] = with;
      taken[i][j] = 1;
      if (j > i && best[i][j - 1] < with) {
        best[i][j] = best[i][j - 1];
        taken[i][j] = 0;
      }
    }
  }
  std::vector<size_t> out(n);
  size_t j = m;
  for (size_t i = n; i > 0; --j) {
    if (taken[i][j] != 0) {
      out[i - 1] = j - 1;
      --i;
    }
  }
  return out;
}

}  // namespace

Ordered order_stages(const std::vector<Section>& stages, double gain, Band band) {
  Ordered out;
  if (stages.empty()) return out;
  const std::vector<Hertz> grid = log_grid(band, kGrid);
  std::vector<Row> rows;
  std::vector<double> level;
  double residual = std::log(std::abs(gain));
  for (const Section& stage : stages) {
    Row row;
    for (const Hertz f : grid) {
      // A zero on the axis may fall on a grid point; it is no level to aim at.
      row.push_back(std::log(std::max(std::abs(stage.response(f.rad_s())), 1e-300)));
    }
    const auto [low, high] = std::minmax_element(row.begin(), row.end());
    const double middle = 0.5 * (std::max(*low, *high - 10.0) + *high);
    for (double& value : row) value -= middle;
    level.push_back(-middle);
    residual += middle;
    rows.push_back(std::move(row));
  }
  const double share = residual / static_cast<double>(stages.size());
  for (size_t i = 0; i < rows.size(); ++i) {
    level[i] += share;
    for (double& value : rows[i]) value += share;
  }
  const std::vector<size_t> order = rows.size() <= kExact ? best_order(rows) : greedy_order(rows);
  Row sum(grid.size(), 0.0);
  out.highest_node_db = -std::numeric_limits<double>::infinity();
  out.lowest_node_db = std::numeric_limits<double>::infinity();
  for (const size_t i : order) {
    Section stage = stages[i];
    stage.gain *= std::exp(level[i]);
    out.stages.push_back(std::move(stage));
    sum = plus(std::move(sum), rows[i]);
    const auto [low, high] = std::minmax_element(sum.begin(), sum.end());
    out.highest_node_db = std::max(out.highest_node_db, *high * kDecibelPerNeper);
    out.lowest_node_db = std::min(out.lowest_node_db, *low * kDecibelPerNeper);
  }
  return out;
}

Split split_into_stages(const Sections& sections) {
  Split out;
  out.leading_gain = sections.gain;
  std::vector<Complex> zeros, poles;
  for (const Section& section : sections.sections) {
    out.leading_gain *= section.gain;
    if (all_real(section)) {
      zeros.insert(zeros.end(), section.zeros.begin(), section.zeros.end());
      poles.insert(poles.end(), section.poles.begin(), section.poles.end());
    } else {
      Section stage = section;
      stage.gain = 1.0;
      out.stages.push_back(std::move(stage));
    }
  }
  const auto rising = [](Complex a, Complex b) { return std::abs(a) < std::abs(b); };
  std::ranges::stable_sort(zeros, rising);
  std::ranges::stable_sort(poles, rising);
  const std::vector<size_t> pole_of = pair_sorted(zeros, poles);
  std::vector<Section> pairs(poles.size());
  for (size_t i = 0; i < poles.size(); ++i) pairs[i].poles = {poles[i]};
  for (size_t i = 0; i < zeros.size(); ++i) pairs[pole_of[i]].zeros = {zeros[i]};
  out.stages.insert(out.stages.begin(), pairs.begin(), pairs.end());
  return out;
}

Split split_into_two_pole_stages(const Sections& sections) {
  Split out = split_into_stages(sections);
  std::vector<Section> joined;
  Section open;
  for (Section& stage : out.stages) {
    if (stage.poles.size() == 2) {
      joined.push_back(std::move(stage));
    } else if (open.poles.empty()) {
      open = std::move(stage);
    } else {
      open.poles.push_back(stage.poles[0]);
      open.zeros.insert(open.zeros.end(), stage.zeros.begin(), stage.zeros.end());
      joined.push_back(std::move(open));
      open = {};
    }
  }
  if (!open.poles.empty()) joined.push_back(std::move(open));
  out.stages = std::move(joined);
  return out;
}

}  // namespace bodesmith::synthesis
