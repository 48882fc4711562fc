#pragma once

#include <string>
#include <vector>

#include "gap/hidden_cases.hpp"
#include "gap/search.hpp"
#include "gap/verdict.hpp"

namespace hidden {

struct Outcome {
  const Case* hidden_case = nullptr;
  bodesmith::gap::Verdict verdict = bodesmith::gap::Verdict::unexplained;
  std::vector<std::string> named;  ///< effect of each step
  std::vector<std::string> tied;   ///< all ties of all steps
  double closure = 0.0;            ///< share of the gap above the noise that was closed, held-out
  double noise_share = 0.0;        ///< final held-out rms over the noise that was put in
  double seconds = 0.0;
  bool right = false;  ///< all hidden effects named (or tied), or rightly silent
  bool exact = false;  ///< named first, not only tied
};

Outcome solve(const Case& c, int threads = 2);
/// Text for people: counts by kind and size, and which effect was taken for which.
std::string confusion_table(const std::vector<Outcome>& outcomes);
std::string line_of(const Outcome& o);

}  // namespace hidden
