#include "circuit/stages/ordering.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace bodesmith::circuit {
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
    std::fill(sum.begin(), sum.end(), 0.0);
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
  std::reverse(order.begin(), order.end());
  return order;
}

std::vector<size_t> greedy_order(const std::vector<Row>& rows) {
  std::vector<size_t> left(rows.size()), order;
  std::iota(left.begin(), left.end(), size_t{0});
  Row sum(rows[0].size(), 0.0);
  while (!left.empty()) {
    const auto best = std::min_element(left.begin(), left.end(), [&](size_t a, size_t b) {
      return peak(plus(sum, rows[a])) < peak(plus(sum, rows[b]));
    });
    sum = plus(std::move(sum), rows[*best]);
    order.push_back(*best);
    left.erase(best);
  }
  return order;
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

}  // namespace bodesmith::circuit
