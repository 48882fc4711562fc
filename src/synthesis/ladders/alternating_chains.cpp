#include "synthesis/ladders/alternating_chains.hpp"

#include <algorithm>
#include <utility>

namespace bodesmith::synthesis {
namespace {

struct Corner {
  double at;
  bool pole;
};
using CornerChain = std::vector<Corner>;

CornerChain sorted_corners(const std::vector<double>& poles, const std::vector<double>& zeros) {
  CornerChain out;
  for (const double at : poles) out.push_back({at, true});
  for (const double at : zeros) out.push_back({at, false});
  std::ranges::stable_sort(out, {}, &Corner::at);
  return out;
}

std::vector<CornerChain> grouped(const CornerChain& corners) {
  std::vector<CornerChain> chains;
  std::vector<std::size_t> by_age;  // the one extended last is last
  for (const Corner& corner : corners) {
    auto place = std::find_if(by_age.rbegin(), by_age.rend(),
                              [&](std::size_t chain) { return chains[chain].back().pole != corner.pole; });
    if (place == by_age.rend()) {
      by_age.push_back(chains.size());
      chains.push_back({corner});
    } else {
      const auto found = place.base() - 1;
      std::rotate(found, found + 1, by_age.end());
      chains[by_age.back()].push_back(corner);
    }
  }
  return chains;
}

/// Chains left with an end too many: as many end with a pole as with a zero. Two of them make a pair.
void pair_lone_ends(std::vector<CornerChain>& chains) {
  CornerChain lone_poles, lone_zeros;
  for (CornerChain& chain : chains) {
    if (chain.size() % 2 == 0) continue;
    (chain.back().pole ? lone_poles : lone_zeros).push_back(chain.back());
    chain.pop_back();
  }
  for (std::size_t i = 0; i < lone_poles.size(); ++i) {
    chains.push_back({lone_poles[i], lone_zeros[i]});
    if (chains.back()[1].at < chains.back()[0].at) std::swap(chains.back()[0], chains.back()[1]);
  }
}

}  // namespace

std::vector<AlternatingChain> alternating_chains(const std::vector<double>& poles,
                                                 const std::vector<double>& zeros) {
  std::vector<CornerChain> chains = grouped(sorted_corners(poles, zeros));
  pair_lone_ends(chains);
  std::vector<AlternatingChain> out;
  for (const CornerChain& chain : chains) {
    if (chain.empty()) continue;
    AlternatingChain one;
    one.lag = chain.front().pole;
    for (const Corner& corner : chain) (corner.pole ? one.poles : one.zeros).push_back(corner.at);
    out.push_back(std::move(one));
  }
  return out;
}

}  // namespace bodesmith::synthesis
