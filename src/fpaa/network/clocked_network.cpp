#include "fpaa/network/clocked_network.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>

#include "base/error.hpp"

namespace bodesmith::fpaa {
namespace {

/// Instants at which a switch of the network moves, within the period.
std::vector<std::int64_t> switching_instants(const std::vector<std::int64_t>& ticks, std::int64_t period) {
  std::vector<std::int64_t> out;
  for (const std::int64_t clock : ticks) {
    for (std::int64_t t = 0; t < period; t += clock / 2) out.push_back(t);
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

}  // namespace

std::optional<std::int64_t> common_period(std::span<const std::int64_t> periods) {
  std::int64_t out = 1;
  for (const std::int64_t period : periods) {
    const std::int64_t step = period / std::gcd(out, period);
    if (out > (std::int64_t{1} << 62) / step) return std::nullopt;
    out *= step;
  }
  return out;
}

ClockedNetwork::ClockedNetwork(const SwitchedNetwork& network, std::vector<std::int64_t> ticks,
                               bool with_noise)
    : inputs_(network.inputs.size()),
      opamps_(network.opamps.size()),
      output_(static_cast<std::size_t>(network.output)) {
  const std::optional<std::int64_t> period = common_period(ticks);
  std::int64_t instants = 0;
  for (const std::int64_t clock : ticks) {
    if (period) instants += std::min(2 * (*period / clock), kMostInstants);
  }
  if (!period || instants > kMostInstants) {
    throw DesignError(
        fmt::format("the clocks have no common period of fewer than {} switching instants, expected "
                    "clocks that divide one another",
                    kMostInstants));
  }
  period_ = *period;
  // Positions of the switches come back: each is worked out once.
  std::map<std::vector<bool>, ChargeMap> maps;
  std::vector<const ChargeMap*> at;
  for (const std::int64_t t : switching_instants(ticks, period_)) {
    std::vector<bool> closed;
    for (const SwitchedNetwork::Switch& s : network.switches) {
      const std::int64_t clock = ticks[static_cast<std::size_t>(s.clock)];
      closed.push_back((2 * (t % clock) < clock) == (s.phase == 1));
    }
    auto found = maps.find(closed);
    if (found == maps.end()) found = maps.emplace(closed, charge_map(network, closed, with_noise)).first;
    at.push_back(&found->second);
    intervals_.push_back({t, found->second.volts_q, found->second.volts_u, {}, {}, {}});
  }
  for (std::size_t i = 0; i < intervals_.size(); ++i) {
    const Eigen::MatrixXd sums = regrouped(*at[(i + 1) % at.size()]);
    intervals_[i].m = sums * at[i]->nodes_q;
    intervals_[i].n = sums * at[i]->nodes_u;
    if (with_noise) intervals_[i].noise = sums * at[i]->noise * sums.transpose();
  }
}

}  // namespace bodesmith::fpaa
