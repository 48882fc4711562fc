#include "invert/steady_state.hpp"

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/whole_number.hpp"
#include "invert/local_model.hpp"
#include "signal/period.hpp"

namespace bodesmith::invert {

SteadyState steady_state_of(const chain::Chain& chain, const TimeRecord& reference, const Options& options,
                            std::optional<double> skip_s) {
  const std::size_t n = reference.size();
  if (skip_s) {
    if (!(*skip_s < reference.duration_s()))
      throw InputError("the time to skip is not shorter than the reference, expected a part of it");
    return {whole_number<std::size_t>(std::ceil(*skip_s / reference.step_s - 1e-9)),
            "after the time skipped"};
  }
  if (const auto repeats = find_repetition(reference.u); repeats && n >= 2 * repeats->samples)
    return {n - repeats->samples, "the last period"};
  std::vector<chain::Kernel> kernels;
  double slowest = 0.0;
  for (const chain::Block& block : chain.blocks) {
    kernels.push_back(block.kernel());
    slowest += 7.0 * block.slowest_time_constant_s();
  }
  double wait = total_delay_s(kernels);
  if (options.start == simulate::Start::zero) wait += slowest;
  const double samples = std::min(std::ceil(wait / reference.step_s), static_cast<double>(n / 2));
  return {std::max<std::size_t>(static_cast<std::size_t>(samples), 1), "after the start"};
}

}  // namespace bodesmith::invert
