#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "gap/model.hpp"

namespace bodesmith::gap {

/// What is known about a signal at a boundary between two blocks (the first record used for fitting).
struct Signal {
  std::vector<double> values;
  double low = 0.0;
  double high = 0.0;
  std::vector<double> sorted_slopes;  ///< |change| per second, rising
  double span() const { return high - low; }
  double size() const;  ///< largest |value|
  double slope_quantile(double q) const;
  double value_quantile(double q) const;
};

/// The present model and its residual, as an effect sees them when it proposes itself.
struct Scene {
  const Model* model = nullptr;
  bool frequency_only = false;  ///< the records are frequency responses: no signals, linear effects only
  double step_s = 0.0;
  double start_s = 0.0;
  double duration_s = 0.0;
  double low_hz = 0.0;                    ///< where the input has its power: 5 % below,
  double band_hz = 0.0;                   ///< 95 % below this
  double top_hz = 0.0;                    ///< Nyquist, or the highest frequency of a response
  std::vector<Signal> boundary;           ///< in front of each block, the last one: the output
  std::vector<double> residual;           ///< measured − model, whole first record
  std::vector<double> residual_peaks_hz;  ///< strongest frequencies of the residual

  bool linear(std::size_t position) const;   ///< the block there is linear and time-invariant
  bool scaling(std::size_t position) const;  ///< the block there only multiplies
  /// One boundary of each class of places that a linear effect cannot tell apart.
  std::vector<std::size_t> linear_places() const;
  /// The same for a memoryless or rate-independent effect.
  std::vector<std::size_t> static_places() const;
};

/// A candidate: the model with the effect's term as its last one, and values of the term's unknowns to start
/// from.
struct Proposal {
  Model model;
  std::vector<std::vector<double>> starts;
};

/// One kind of thing that a model can lack. Every effect is one file in effects/ and one line in
/// effect_list.cpp.
class Effect {
 public:
  virtual ~Effect() = default;
  /// As in the contract's table.
  virtual std::string_view name() const = 0;
  /// A sentence for the report: what it does to a signal.
  virtual std::string_view what() const = 0;
  /// The feature of the residual that gives it away.
  virtual std::string_view tell_tale() const = 0;
  /// Effects that leave much the same traces.
  virtual std::vector<std::string_view> confused_with() const = 0;
  /// The experiment that tells it from those.
  virtual std::string_view experiment() const = 0;
  /// Shows in a frequency response.
  virtual bool linear() const { return false; }
  /// Its start values are found in the residual, so they are worth finding from more than one model.
  virtual bool starts_from_residual() const { return false; }
  /// Every place it can sit, with start values from the data.
  virtual void propose(const Scene& scene, std::vector<Proposal>& out) const = 0;
};

/// All of them; a new one is one line in effect_list.cpp.
const std::vector<const Effect*>& effects();
const Effect* find_effect(std::string_view name);

/// Helper for effects that are one block of their own: each unknown's name is the block's parameter.
Proposal insert_block(const Scene& scene, const Effect& effect, std::size_t position, chain::Block block,
                      std::vector<Unknown> unknowns, std::vector<std::vector<double>> starts);
/// Helper for effects inside a base block: the unknowns' names are its parameters.
Proposal change_block(const Scene& scene, const Effect& effect, std::size_t position,
                      std::vector<Unknown> unknowns, std::vector<std::vector<double>> starts);

Unknown linear_unknown(std::string name, double low, double high, double scale);
Unknown logarithmic_unknown(std::string name, double low, double high);

}  // namespace bodesmith::gap
