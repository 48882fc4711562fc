#pragma once

#include <cstddef>
#include <limits>
#include <vector>

namespace bodesmith::synthesis {

/// Takes other values from the lists, two at a time, while error(values, enough) falls, which may stop looking once it is above `enough`.
/// The error in the end.
template <class Error>
double exchange_pairs(const std::vector<std::vector<double>>& near, std::vector<double>& values,
                      Error error) {
  double best = error(values, std::numeric_limits<double>::infinity());
  std::vector<double> trial;
  for (bool better = true; better;) {
    better = false;
    for (std::size_t i = 0; i < values.size(); ++i) {
      for (const double a : near[i]) {
        for (std::size_t j = i + 1; j < values.size(); ++j) {
          if (near[j].size() == 1) continue;
          for (const double b : near[j]) {
            trial = values;
            trial[i] = a;
            trial[j] = b;
            const double here = error(trial, best);
            if (!(here < best * (1.0 - 1e-9))) continue;
            best = here;
            values = trial;
            better = true;
          }
        }
      }
    }
  }
  return best;
}

}  // namespace bodesmith::synthesis
