#include "fpaa/network/clocked_network.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <numeric>

#include "base/error.hpp"
#include "numeric/linear_algebra/dense.hpp"

namespace bodesmith::fpaa {
namespace {

/// Instants at which a switch of the network moves, within the period.
std::vector<std::int64_t> switching_instants(const std::vector<std::int64_t>& ticks, std::int64_t period) {
  std::vector<std::int64_t> out;
  for (const std::int64_t clock : ticks) {
    for (std::int64_t t = 0; t < period; t += clock / 2) out.push_back(t);
  }
  std::ranges::sort(out);
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
    Interval& interval = intervals_.emplace_back();
    interval.start = t;
    interval.c = found->second.volts_q;
    interval.d = found->second.volts_u;
    interval.slowest_s = found->second.opamps.slowest_s;
  }
  for (std::size_t i = 0; i < intervals_.size(); ++i) {
    const Eigen::MatrixXd sums = regrouped(*at[(i + 1) % at.size()]);
    intervals_[i].m = times(sums, at[i]->nodes_q);
    intervals_[i].n = times(sums, at[i]->nodes_u);
    if (at[i]->late.size() > 0)
      add_lateness(intervals_[i], *at[i], *at[(i + at.size() - 1) % at.size()], sums);
    if (with_noise) add_noise(intervals_[i], *at[i], *at[(i + 1) % at.size()], sums);
  }
}

void ClockedNetwork::add_lateness(Interval& interval, const ChargeMap& here, const ChargeMap& last,
                                  const Eigen::MatrixXd& sums) const {
  const auto opamps = static_cast<Eigen::Index>(opamps_), nodes = here.nodes_u.rows();
  const Eigen::MatrixXd read = here.late.row(static_cast<Eigen::Index>(output_));
  const Eigen::MatrixXd late_charges = here.late.bottomRows(nodes);
  const Eigen::MatrixXd charges = times(sums, late_charges);
  const auto of = [&](const Eigen::MatrixXd& row, const Eigen::MatrixXd& q, const Eigen::MatrixXd& v) {
    return Eigen::MatrixXd(times(Eigen::MatrixXd(row.leftCols(nodes)), q) +
                           times(Eigen::MatrixXd(row.rightCols(opamps)), v));
  };
  interval.behind_q = of(read, here.nodes_q, here.volts_q);
  interval.behind_u = of(read, here.nodes_u, here.volts_u);
  interval.behind_last_q = of(read, last.nodes_q, last.volts_q);
  interval.behind_last_u = of(read, last.nodes_u, last.volts_u);
  interval.late_n = of(charges, here.nodes_u, here.volts_u);
}

/// Where the switches move, x leaves sums nodes x in the charges. The op-amps' outputs go on from where they were: what is
/// not x of the next interval's charges settles there. The integral of the output about the instant is
///   volts int x(t) dt before it and volts settling (x - C sums nodes x) behind it.
void ClockedNetwork::add_noise(Interval& interval, const ChargeMap& here, const ChargeMap& next,
                               const Eigen::MatrixXd& sums) const {
  const ChargeMap::OpAmpNoise& before = here.opamps;
  const ChargeMap::OpAmpNoise& after = next.opamps;
  const auto read = static_cast<Eigen::Index>(output_);
  const Eigen::MatrixXd left = times(sums, before.nodes), right = left.transpose();
  const Eigen::MatrixXd of_left = times(left, before.covariance);  // covariance of what is left with x
  const Eigen::MatrixXd to_sums = sums.transpose(), with_left = of_left.transpose();
  interval.noise = times(times(sums, here.noise), to_sums) + times(of_left, right);
  const Eigen::VectorXd volts = before.volts.row(read);
  const Eigen::VectorXd about = times(before.covariance, transpose_times(before.settling_s, volts));
  interval.direct_noise_s = 2.0 * volts.dot(about);
  const Eigen::MatrixXd goes_on =
      with_left - times(times(next.volts_q(after.of, Eigen::all), left), with_left);
  const Eigen::VectorXd settling = transpose_times(after.settling_s, after.volts.row(read));
  interval.noise_about_end_s = times(left, about) + transpose_times(goes_on, settling);
}

}  // namespace bodesmith::fpaa
