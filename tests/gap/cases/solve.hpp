#pragma once

#include <string>
#include <vector>

#include "gap/cases/case.hpp"

namespace hidden {

/// What the search made of a case.
struct Outcome {
  Specification specification;
  std::string verdict;
  std::vector<std::string> named;  ///< effect of each step
  std::vector<std::string> tied;   ///< all ties of all steps
  double closure = 0.0;            ///< share of the gap above the noise that was closed, held-out
  double noise_share = 0.0;        ///< final held-out rms over the noise that was put in
  double seconds = 0.0;
  std::size_t samples = 0;      ///< of all records
  bool right = false;           ///< all hidden effects named (or tied), or rightly silent
  bool exact = false;           ///< named first, not only tied
  std::size_t further() const;  ///< effects named that were not hidden
};

struct SolveOptions {
  int threads = 2;
  double max_seconds = 0.0;  ///< stop the search after these; 0: never
  int max_terms = 5;         ///< of a model
  bool explain = false;      ///< print every ranking
};

Outcome solve(const Case& c, const SolveOptions& options = {});

std::string line_of(const Outcome& outcome);

}  // namespace hidden
