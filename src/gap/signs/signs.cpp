#include "gap/signs/signs.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <iterator>
#include <utility>

#include "gap/evidence/noise_floor.hpp"
#include "gap/records/experiment.hpp"
#include "numeric/parallel_for.hpp"
#include "signal/statistics.hpp"

namespace bodesmith::gap {
namespace {

bool tells(const Leftover& r) {
  if (!r.response.empty()) return true;
  if (r.residual.size() < kLeastSamples) return false;
  const auto [low, high] = std::minmax_element(r.output.begin(), r.output.end());
  return rms(r.residual) > kLeastRest * (*high - *low);
}

}  // namespace

std::string to_string(SignKind kind) {
  constexpr std::array kWords = {"the residual depends on input and output",
                                 "a line stands in the residual's spectrum",
                                 "the residual jumps",
                                 "the gain varies with time",
                                 "neighbouring frequencies err alike",
                                 "single frequencies err far more than those around them",
                                 "the response depends on the drive"};
  return kWords.at(static_cast<std::size_t>(kind));
}

std::vector<Sign> signs_of_structure(std::vector<Leftover> records) {
  std::erase_if(records, [](const Leftover& r) { return !tells(r); });
  std::vector<std::function<Sign()>> looks;
  const auto consider = [&](std::function<Sign()> look) { looks.push_back(std::move(look)); };
  if (!records.empty() && records.front().response.empty())
    consider([&] { return depends_on_signals(records); });
  for (const auto& r : records) {
    if (!r.response.empty()) {
      for (const auto look : {smooth_over_frequency, stands_apart}) consider([&r, look] { return look(r); });
    } else {
      for (const auto look : {jumps, gain_varies, spectral_line}) consider([&r, look] { return look(r); });
    }
  }
  std::vector<Sign> all(looks.size());
  parallel_for(looks.size(), allowed_threads(), [&](std::size_t i) { all[i] = looks[i](); });
  std::vector<Sign> signs;
  std::copy_if(all.begin(), all.end(), std::back_inserter(signs), [](const Sign& s) { return s.found(); });
  std::stable_sort(signs.begin(), signs.end(),
                   [](const Sign& a, const Sign& b) { return a.strength > b.strength; });
  return signs;
}

}  // namespace bodesmith::gap
