#pragma once

#include <string>
#include <vector>

#include "signal/time_record.hpp"

namespace bodesmith::gap {

/// Residual and model output of one record, scored samples only.
struct Leftover {
  std::vector<double> residual;
  std::vector<double> input;
  std::vector<double> output;
  double step_s = 0.0;
};

/// A sign that a residual is more than noise, whatever its colour.
struct Sign {
  bool found = false;
  double strength = 0.0;  ///< over what chance reaches, 1: at the limit
  std::string what;       ///< for a person
};

/// The residual can be foretold from input and output (cells of value, slope, branch, memory, earlier inputs)
/// by weights learned on one record and applied to the other: noise cannot, because its surrogates (same
/// spectrum, random phases) cannot.
Sign depends_on_signals(const Leftover& learn, const Leftover& apply);

/// The energy is bunched in time more than surrogates of the same spectrum ever are.
Sign bunched_in_time(const Leftover& record);

/// A line stands in the spectrum, narrower and higher than noise makes them.
Sign spectral_line(const Leftover& record);

/// All signs that hold, strongest first.
std::vector<Sign> signs_of_structure(const std::vector<Leftover>& train,
                                     const std::vector<Leftover>& holdout);

}  // namespace bodesmith::gap
