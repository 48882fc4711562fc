#include <algorithm>
#include <functional>
#include <numeric>

#include "gap/signs/signs.hpp"
#include "signal/statistics.hpp"

namespace bodesmith::gap {
namespace {

/// Of the samples. They hold a twelfth of the energy of Gaussian noise, a fifth where its tails are Student's of four degrees.
constexpr std::size_t kOneIn = 100;
/// Of the energy: most of it.
constexpr double kMost = 0.5;

}  // namespace

Sign few_samples(const Leftover& record) {
  std::vector<double> energy = record.residual;
  const double middle = median(energy);
  for (double& e : energy) e = (e - middle) * (e - middle);
  const auto few = static_cast<std::ptrdiff_t>(energy.size() / kOneIn);
  std::nth_element(energy.begin(), energy.begin() + few, energy.end(), std::greater<>());
  const double of_few = std::accumulate(energy.begin(), energy.begin() + few, 0.0);
  const double all = std::accumulate(energy.begin() + few, energy.end(), of_few);
  return {SignKind::few_samples, all > 0.0 ? of_few / all / kMost : 0.0};
}

}  // namespace bodesmith::gap
