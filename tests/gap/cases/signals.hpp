#pragma once

#include <string>
#include <vector>

#include "gap/cases/case.hpp"
#include "gap/cases/random.hpp"

namespace hidden {

/// Inputs that a laboratory has, of amplitude about 1 around 0.
enum class Drive {
  multisine,       ///< two to six periods, odd or all harmonics, random phases
  triangle,        ///< growing and shrinking amplitude, two rates
  sweep,           ///< logarithmic, amplitude modulated
  steps,           ///< random levels with edges of a few samples
  noise,           ///< low-passed
  two_tone,        ///< two sines of unrelated frequencies
  binary,          ///< a random binary sequence with edges of a few samples
  modulated_sine,  ///< one frequency, swelling amplitude, drifting mean
};

std::vector<double> make_drive(Drive kind, std::size_t n, double step_s, double band_hz, Random& random);
/// A kind for fitting or for holding out; with memory in the stage one whose amplitude changes.
Drive pick_drive(Random& random, bool holdout, bool memory);

enum class Colour { white, coloured, red, ringing };
/// Noise of unit rms: white, first-order coloured (0.9 and 0.99), or with a resonance.
std::vector<double> make_noise(Colour colour, std::size_t n, Random& random);

double rms(const std::vector<double>& v);
double largest(const std::vector<double>& v);

/// Outputs of one way of making the records, one vector a record.
using Outputs = std::vector<std::vector<double>>;
/// rms of what `changed` adds, beyond a rescaling of the base's output when a free gain would absorb that.
double difference(const Outputs& base, const Outputs& changed, bool free_gain);

/// Puts the records into the case, with noise of c.noise_rms added.
void finish(Case& c, double step_s, const Outputs& train_u, const Outputs& train_y, const Outputs& holdout_u,
            const Outputs& holdout_y, Colour colour, Random& random);

}  // namespace hidden
