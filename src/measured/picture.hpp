#pragma once

#include <string>
#include <vector>

#include "report/plot.hpp"

namespace bodesmith::measured {

/// gap.svg: the gap before and with what was found, and beneath it what the hardware did and what next/ will do.
struct GapPicture {
  std::string x_label;
  bool logarithmic = false;
  std::vector<double> x;
  std::vector<double> gap, left;      ///< percent
  std::vector<double> before, after;  ///< percent; empty: not known
  std::string what;                   ///< of those: "error of tracking"

  std::string svg() const;
};

}  // namespace bodesmith::measured
