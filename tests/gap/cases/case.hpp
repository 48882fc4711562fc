#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "signal/bode_points.hpp"
#include "signal/time_record.hpp"

namespace hidden {

enum class Kind { effect, pair, control, outside };

/// Who makes the records: plain loops and closed forms in the time domain, closed forms on the jω axis, or
/// ngspice on a deck of op-amps, multipliers, switches and diodes.
enum class World { formulas, responses, ngspice };

/// What is asked for; the same specification makes the same case.
struct Specification {
  World world = World::formulas;
  Kind kind = Kind::effect;
  std::string base;               ///< name of the base chain
  std::vector<std::string> what;  ///< hidden effects, or the kind of a control or of an outside case
  double ratio = 10.0;            ///< rms of the effect over rms of the noise; no meaning for a control
  std::uint64_t seed = 1;
  std::size_t rows = 0;  ///< of all records to fit in the time domain; 0: drawn

  std::string what_text() const;  ///< "amplifier_pole+saturation"
  std::string key() const;        ///< one word for all of it
  std::uint64_t salt() const;     ///< seed of this case's random numbers; not of the ratio
};

/// A base model, records made by other code than src/, and the answer the workflow never sees.
struct Case {
  Specification specification;
  std::string model;               ///< model.toml text
  std::vector<std::string> truth;  ///< hidden effects, empty for a control or an outside case
  double noise_rms = 0.0;
  double effect_rms = 0.0;
  std::vector<bodesmith::TimeRecord> train, holdout;
  std::vector<bodesmith::FrequencyRecord> train_responses, holdout_responses;
};

const char* to_string(World world);
const char* to_string(Kind kind);

}  // namespace hidden
