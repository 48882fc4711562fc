#pragma once

#include <array>
#include <string>
#include <vector>

#include "gap/cases/random.hpp"
#include "gap/cases/signals.hpp"
#include "gap/cases/stages.hpp"

namespace hidden {

/// A pole-zero section gain (1 + s/z)/(1 + s/p).
struct Section {
  double gain = 1.0;
  double zero_hz = 0.0;
  double pole_hz = 0.0;
};

/// A base chain: the true stages, its model.toml, and how it is driven.
struct TimeBase {
  std::string name;
  std::vector<Stage> stages;
  std::string model;
  double step_s = 1e-4;
  double band_hz = 300.0;
  double amplitude = 1.0;
  bool one_sided = false;  ///< input in [0, 1]
  bool free_gain = true;
  double slowest_hz = 0.0;             ///< corner or natural frequency that a wrong start shows; 0: none
  Mode inner;                          ///< of the resonator, with what was hidden in it so far
  std::size_t inner_at = 0;            ///< its place among the stages
  std::vector<Section> sections;       ///< stage i is section i
  std::array<double, 3> up{}, down{};  ///< of `branches`, stage 1
  std::array<double, 2> powers{};      ///< of `curve`: c2, c3
};

/// With `right` the model's free parameters are the true ones, otherwise up to 15 % off.
TimeBase make_time_base(const std::string& name, Random& random, bool right, std::size_t rows,
                        double min_duration_s);

/// Changes the stages so that they have the effect; sizes are taken from the signals under the input u.
void hide(TimeBase& base, std::vector<Stage>& stages, const std::string& effect, const std::vector<double>& u,
          Random& random);
/// Effects that change a stage of the base in its place.
bool changes_a_stage(const std::string& effect);
/// The same for things that no effect of the catalogue is.
void hide_outsider(const TimeBase& base, std::vector<Stage>& stages, const std::string& what,
                   const std::vector<double>& u, Random& random);

std::vector<double> play_chain(const std::vector<Stage>& stages, const std::vector<double>& u, double step_s);

/// A block of a base model, its parameters free.
std::string resonator_text(double gain, double hz, double damping);
std::string gain_text(double gain);

}  // namespace hidden
