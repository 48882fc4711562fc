#include "gap/signs/signs.hpp"

#include <algorithm>
#include <functional>
#include <iterator>
#include <utility>

#include "numeric/parallel_for.hpp"

namespace bodesmith::gap {
namespace {

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
  switch (kind) {
    case SignKind::depends_on_signals:
      break;
    case SignKind::bunched_in_time:
      return "the residual is bunched in time";
    case SignKind::even_in_time:
      return "the residual keeps its size more evenly than noise does";
    case SignKind::spectral_line:
      return "a line stands in the residual's spectrum";
    case SignKind::jumps:
      return "the residual jumps";
    case SignKind::gain_varies:
      return "the gain varies with time";
    case SignKind::concentrated:
      return "the residual keeps to few stretches of time and frequency together";
    case SignKind::above_white_floor:
      return "far more is left at low frequencies than the white floor of the noise";
    case SignKind::straight_line:
      return "the residual holds a constant or a straight line";
    case SignKind::smooth_over_frequency:
      return "neighbouring frequencies err alike";
    case SignKind::stands_apart:
      return "single frequencies err far more than those around them";
    case SignKind::refused_candidate:
      return "an effect that was refused as a name would explain a good part of the residual";
    case SignKind::depends_on_amplitude:
      return "the response depends on the drive";
  }
  return "the residual can be foretold from input and output";
}

std::vector<Sign> signs_of_structure(const std::vector<Leftover>& records,
                                     const std::vector<Leftover>& parts) {
  std::vector<std::function<Sign()>> looks;
  const auto consider = [&](std::function<Sign()> look) { looks.push_back(std::move(look)); };
  for (std::size_t a = 0; a < parts.size(); ++a) {
    for (std::size_t b = a + 1; b < parts.size(); ++b) {
      if (parts[a].response.empty() && parts[b].response.empty())
        consider([&parts, a, b] { return depends_either_way(parts[a], parts[b]); });
    }
  }
  for (const auto& r : records) {
    if (!r.response.empty()) {
      consider([&r] { return smooth_over_frequency(r); });
      consider([&r] { return stands_apart(r); });
      continue;
    }
    consider([&r] { return jumps(r); });
    consider([&r] { return gain_varies(r); });
    consider([&r] { return bunched_in_time(r); });
    consider([&r] { return even_in_time(r); });
    consider([&r] { return spectral_line(r); });
    consider([&r] { return concentrated(r); });
    consider([&r] { return above_white_floor(r); });
    consider([&r] { return straight_line(r); });
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
