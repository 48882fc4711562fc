#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "base/units.hpp"
#include "gap/model/model.hpp"
#include "gap/records/experiment.hpp"

namespace bodesmith::gap {

/// Of what a look at the residual finds (peaks, modes, lines, clocks) so many are gone on from, the best.
constexpr std::size_t kMostFound = 6;

/// The best of what was found, best first, that are not near a better one.
template <class Found, class Near>
std::vector<Found> best_apart(const std::vector<Found>& sorted, Near near, std::size_t most = kMostFound) {
  std::vector<Found> kept;
  for (const Found& one : sorted) {
    if (kept.size() == most) break;
    if (std::none_of(kept.begin(), kept.end(), [&](const Found& other) { return near(one, other); }))
      kept.push_back(one);
  }
  return kept;
}

/// What is known about a signal at a boundary between two blocks.
struct Signal {
  std::vector<double> values;  ///< in the record that is looked at
  // In all records for fitting:
  double low = 0.0;
  double high = 0.0;
  std::vector<double> sorted_slopes;  ///< |change| per second, rising
  double span() const { return high - low; }
  double size() const;  ///< largest |value|
  double slope_quantile(double q) const;
  void add_range_of(const Signal& other);
};

/// The present model and its residual, as an effect sees them when it proposes itself.
struct Scene {
  const Model* model = nullptr;
  std::size_t records =
      1;  ///< for fitting; what is below is of the one of which most is left, or of the first response
  bool frequency_only = false;  ///< the records are frequency responses: no signals, linear effects only
  double step_s = 0.0;
  double duration_s = 0.0;
  double low_hz = 0.0;                    ///< where the input has its power: little below,
  double band_hz = 0.0;                   ///< and above
  double top_hz = 0.0;                    ///< Nyquist, or the highest frequency of a response
  std::vector<Signal> boundary;           ///< in front of each block, the last one: the output
  std::vector<double> residual;           ///< measured - model, whole record
  std::vector<double> residual_peaks_hz;  ///< strongest frequencies of the residual
  std::vector<Hertz> frequency;           ///< where a response was measured

  /// One boundary of each class of places that a linear effect cannot tell apart.
  std::vector<std::size_t> linear_places() const;
  /// The same for a memoryless or rate-independent effect.
  std::vector<std::size_t> static_places() const;
  /// Behind all blocks but lines.
  std::size_t end() const { return model->end(); }
  /// The base model's blocks (terms' blocks are not changed by other terms).
  std::vector<std::size_t> base_places() const;
};

/// What the effects look at: the training record of which most is left under the present model.
Scene make_scene(const Model& model, const Experiments& train);

}  // namespace bodesmith::gap
