#pragma once

#include <cstddef>
#include <vector>

#include "lti/judge_responses.hpp"
#include "tolerance/design.hpp"
#include "tolerance/yield.hpp"

namespace bodesmith::tolerance {

/// Deviations beyond these are counted as these: a null of the response, dB.
constexpr double kMaxDeviationDb = 400.0;

/// The wanted response as a judge of the worst deviations sees it, on the grid of judge_responses() next to this one: where points
/// below the floor are left out, the curve goes down to it.
class Judge {
 public:
  Judge(const Design& design, const std::vector<Hertz>& grid);

  /// A deviation at point i of the grid, all positive, by what a shift of frequency says of it where that is less.
  struct Worst {
    double db, deg, percent;
  };
  /// What is no worse than `least` is not looked at more closely.
  Worst operator()(std::size_t i, double db, double deg, const Worst& least = {}) const;

 private:
  Judge(const Design& design, const std::vector<Hertz>& grid, const std::vector<Hertz>& dense);

  std::vector<Complex> wanted_;
  FlankedCurve curve_;
  std::vector<std::size_t> place_;  ///< of the grid's points on the curve
};

/// Everything that is known before the first sample: the ranges of the histograms, the worst case and the
/// ranking of the parts, from the sensitivities.
Result expected_result(const Design& design, const Options& options, const Judge& judge);

}  // namespace bodesmith::tolerance
