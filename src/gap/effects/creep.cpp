#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "base/whole_number.hpp"
#include "chain/registry.hpp"
#include "gap/effect.hpp"

namespace bodesmith::gap {
namespace {

/// Relaxations of one decade of a logarithmic creep.
constexpr int kOfDecade = 3;
/// The longest time constant, of .7 of the record or 1/low_hz: slower ones are an integral.
constexpr double kSlowest = 3.0;
/// The shortest one, of 1/top_hz: faster ones change nothing in the record.
constexpr double kFastest = 0.03;

/// y = u + c sum over decades of relaxations, equally strong at every time constant between two: after a step
/// c log10(t) (J. F. Curie's law; K. Kuhnen, 2003). In a response, where free relaxations are more than it tells, the
/// strength and the fastest one are its only unknowns; or the slowest one too.
void write_logarithmic(chain::Block& block, int count, double gain_per_decade, double fastest_s,
                       double slowest_s) {
  const double decades = std::log10(slowest_s / fastest_s);
  std::vector<double> times;
  for (int k = 0; k < count; ++k)
    times.push_back(fastest_s * std::pow(slowest_s / fastest_s, (k + 0.5) / count));
  block.set("time_constants_s", times)
      .set("gains", std::vector<double>(times.size(), gain_per_decade * decades / count));
}

void propose_logarithmic(const Scene& scene, std::size_t at, double fast, double slow, bool slowest_free,
                         std::vector<Proposal>& out) {
  const double slowest = kSlowest * slow;
  const int count = kOfDecade * whole_number<int>(std::ceil(std::log10(slowest / fast)), 1, 20);
  auto block = chain::make_block("creep");
  const std::vector<double> zeros(static_cast<std::size_t>(count), 0.0);
  block.set("gains", zeros).set("time_constants_s", std::vector<double>(zeros.size(), slow));
  std::vector<Unknown> unknowns = {linear_unknown("gain_per_decade", 0.0, 1.0, 0.05),
                                   logarithmic_unknown("fastest_s", 0.3 * fast, 0.5 * slow)};
  if (slowest_free) unknowns.push_back(logarithmic_unknown("slowest_s", 2.0 * fast, slowest));
  Starts starts;
  for (const auto& [from, to] : {std::pair(0.2, 0.55), std::pair(0.5, 0.85), std::pair(0.15, 0.85)}) {
    starts.push_back({0.02, fast * std::pow(slow / fast, from)});
    if (slowest_free) starts.back().push_back(fast * std::pow(slow / fast, to));
  }
  out.push_back(insert_block(scene, at, block, unknowns, starts,
                             [count, slowest](chain::Block& b, std::span<const double> v) {
                               // The order may be lost on the way of a fit.
                               const double last = v.size() > 2 ? std::max(v[2], 1.01 * v[1]) : slowest;
                               write_logarithmic(b, count, v[0], v[1], last);
                             }));
}

void propose_creep(const Scene& scene, std::vector<Proposal>& out) {
  const double slow = scene.frequency_only ? 1.0 / scene.low_hz : 0.7 * scene.duration_s;
  const double fast = 0.08 / scene.band_hz;
  for (std::size_t at : scene.linear_places()) {
    // One relaxation with a time constant of its own, and a logarithmic spectrum of fixed ones.
    auto one = chain::make_block("creep");
    one.set("gains", std::vector<double>{0.01})
        .set("time_constants_s", std::vector<double>{std::sqrt(fast * slow)});
    Starts starts;
    for (double part : {0.15, 0.4, 0.7, 0.95}) starts.push_back({0.01, fast * std::pow(slow / fast, part)});
    out.push_back(insert_block(scene, at, one,
                               {linear_unknown("gains[0]", 0.0, 1.0, 0.05),
                                logarithmic_unknown("time_constants_s[0]", fast, kSlowest * slow)},
                               starts));
    const double fastest = scene.frequency_only ? kFastest / scene.top_hz : fast;
    if (scene.frequency_only) propose_logarithmic(scene, at, fastest, slow, false, out);
    propose_logarithmic(scene, at, fastest, slow, true, out);
    auto many = chain::make_block("creep");
    const int count = 8;
    std::vector<double> times;
    std::vector<double> gains(count, 0.01);
    std::vector<Unknown> unknowns;
    for (int k = 0; k < count; ++k) {
      times.push_back(fast * std::pow(slow / fast, k / (count - 1.0)));
      unknowns.push_back(linear_unknown("gains[" + std::to_string(k) + "]", 0.0, 1.0, 0.05));
    }
    many.set("gains", gains).set("time_constants_s", times);
    out.push_back(insert_block(scene, at, many, unknowns, {gains}));
  }
}

}  // namespace

BODESMITH_EFFECT(creep, .what = "slow relaxation, logarithmic or of several time constants",
                 .experiment = "a long record after one step", .linear = true, .propose = propose_creep)

}  // namespace bodesmith::gap
