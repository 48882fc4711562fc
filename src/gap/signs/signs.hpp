#pragma once

#include <string>
#include <vector>

#include "chain/chain.hpp"

namespace bodesmith::gap {

/// What a model leaves of one record, scored samples only: what signs of structure are looked for in.
struct Leftover {
  std::vector<double> residual;
  std::vector<double> input;
  std::vector<double> output;
  double step_s = 0.0;
  chain::Chain dynamics;  ///< the model's linear blocks
  /// Of a frequency response instead: relative residual, real and imaginary part point by point.
  std::vector<double> response;
};

enum class SignKind {
  depends_on_signals,
  spectral_line,
  jumps,
  gain_varies,
  smooth_over_frequency,
  stands_apart,
  depends_on_amplitude,  ///< of responses at several drives
};
/// For a person: "the residual jumps", ...
std::string to_string(SignKind kind);

/// A sign that a residual is more than noise, whatever its colour. Of records of a few hundred samples and more.
struct Sign {
  SignKind kind = SignKind::depends_on_signals;
  double strength = 0.0;  ///< over what chance reaches, 1: at the limit
  bool found() const { return strength > 1.0; }
};

/// The residual depends on input and output: weights of their features (gap/signs/signal_features.hpp) make what is left likelier as
/// autoregressive noise than noise alone, in all records at once, and by far more than chance would: n ln of the ratio of the innovations'
/// variances is chi squared with as many degrees of freedom as there are weights (Wilks, Ann. Math. Stat. 9 (1938) 60), fewer where the
/// weights' prior holds them.
Sign depends_on_signals(const std::vector<Leftover>& records);

/// A line stands in the spectrum, narrower and higher than noise makes them.
Sign spectral_line(const Leftover& record);

/// The residual jumps: means of a few samples on both sides of an instant differ far more than elsewhere.
Sign jumps(const Leftover& record);

/// The residual is a slowly changing multiple of the output: a gain that varies with time.
Sign gain_varies(const Leftover& record);

/// Neighbouring points of a frequency response err alike, which noise of separate points does not.
Sign smooth_over_frequency(const Leftover& record);

/// Single points of a frequency response err far more than those around them (a narrow notch).
Sign stands_apart(const Leftover& record);

/// All signs that hold, strongest first: of each record alone, and of what all depend on. The records are all in time or all responses.
std::vector<Sign> signs_of_structure(std::vector<Leftover> records);

}  // namespace bodesmith::gap
