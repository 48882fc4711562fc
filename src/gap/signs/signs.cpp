#include "gap/signs/signs.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <iterator>
#include <utility>

#include "numeric/parallel_for.hpp"

namespace bodesmith::gap {
namespace {

/// Shorter records say too little.
constexpr std::size_t kMinSamples = 200;
/// A prediction this many times beyond chance in one direction will do; else both directions must hold.
constexpr double kPlainSigns = 2.0;

/// The stronger of learning on one and applying to the other, and the reverse; nothing when it is not plain.
Sign depends_either_way(const Leftover& a, const Leftover& b) {
  const auto there = depends_on_signals(a, b);
  const auto back = depends_on_signals(b, a);
  const bool plain =
      (there.found() && back.found()) || there.strength > kPlainSigns || back.strength > kPlainSigns;
  if (!plain) return {};
  return there.strength > back.strength ? there : back;
}

}  // namespace

std::string to_string(SignKind kind) {
  constexpr std::array kWords = {"the residual can be foretold from input and output",
                                 "a line stands in the residual's spectrum",
                                 "the residual jumps",
                                 "a few samples hold most of the residual",
                                 "the gain varies with time",
                                 "far more is left at low frequencies than the white floor of the noise",
                                 "the residual holds a constant or a straight line",
                                 "neighbouring frequencies err alike",
                                 "single frequencies err far more than those around them",
                                 "the response depends on the drive",
                                 "so many curves or modes were named that they are one of another form"};
  return kWords.at(static_cast<std::size_t>(kind));
}

std::vector<Sign> signs_of_structure(const std::vector<Leftover>& records,
                                     const std::vector<Leftover>& parts) {
  std::vector<std::function<Sign()>> looks;
  const auto consider = [&](std::function<Sign()> look) { looks.push_back(std::move(look)); };
  const auto is_long = [](const Leftover& r) { return r.residual.size() >= kMinSamples; };
  for (std::size_t a = 0; a < parts.size(); ++a) {
    for (std::size_t b = a + 1; b < parts.size(); ++b) {
      if (is_long(parts[a]) && is_long(parts[b]))
        consider([&parts, a, b] { return depends_either_way(parts[a], parts[b]); });
    }
  }
  for (const auto& r : records) {
    if (!r.response.empty()) {
      for (const auto look : {smooth_over_frequency, stands_apart}) consider([&r, look] { return look(r); });
    } else if (is_long(r)) {
      for (const auto look :
           {jumps, few_samples, gain_varies, spectral_line, above_white_floor, straight_line})
        consider([&r, look] { return look(r); });
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
