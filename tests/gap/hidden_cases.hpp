#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "signal/time_record.hpp"

namespace hidden {

enum class Kind { effect, pair, control, outside };

/// A base model, records made by other code (hidden_stages.hpp), and the answer the workflow never sees.
struct Case {
  Kind kind = Kind::effect;
  std::string name;
  std::string base;                ///< name of the base chain
  std::string model;               ///< model.toml text
  std::vector<std::string> truth;  ///< hidden effects, empty for a control or an outside case
  double ratio = 0.0;              ///< rms of the effect over rms of the noise; 0 for a control
  double noise_rms = 0.0;
  double effect_rms = 0.0;
  bodesmith::TimeRecord train;
  bodesmith::TimeRecord holdout;
};

struct BatchOptions {
  std::uint64_t seed = 1;
  /// Sizes of the hidden effects over the noise, one set of effect cases each.
  std::vector<double> ratios = {5.0};
  int repeats = 1;        ///< variants (excitation, noise colour, parameters) of each case
  int pairs = 0;          ///< pairs of hidden effects
  double controls = 0.5;  ///< controls per effect case (0.5: a third of all)
  int outside = 0;
};

std::vector<Case> make_cases(const BatchOptions& options);

/// One named case: base chain name and effect, e.g. ("resonator", "cubic_stiffness").
Case make_effect_case(const std::string& base, const std::string& effect, double ratio, std::uint64_t seed);
Case make_pair_case(const std::string& base, const std::string& first, const std::string& second,
                    double ratio, std::uint64_t seed);
Case make_control_case(const std::string& base, const std::string& what, std::uint64_t seed);
Case make_outside_case(const std::string& base, const std::string& what, std::uint64_t seed);

/// Every (base, effect) that can be hidden there.
std::vector<std::pair<std::string, std::string>> effect_places();
const std::vector<std::string>& control_kinds();
const std::vector<std::string>& outside_kinds();

}  // namespace hidden
