#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "chain/chain.hpp"
#include "signal/time_record.hpp"

namespace bodesmith::simulate {

/// How a chain is worked out.
enum class Engine {
  automatic,  ///< exact where the chain and its input allow it, else record, its step halved until the
              ///< tolerance is met; where a kink keeps it from that, cvode if that does better
  record,     ///< sample to sample with the step as given, see record_simulator.hpp
  exact,      ///< closed form between the corners of the input, see exact_engine.hpp; an error where there is
              ///< none
  cvode,      ///< the whole chain as an ODE with events, see cvode_engine.hpp
};

enum class Start {
  zero,         ///< every state is zero before the first sample
  equilibrium,  ///< at rest under the first input
};

std::string_view to_string(Engine engine);
std::string_view to_string(Start start);

struct Options {
  Engine engine = Engine::automatic;
  Start start = Start::zero;
  double relative_tolerance = 1e-8;   ///< automatic (of the largest output) and cvode
  double absolute_tolerance = 1e-10;  ///< the same, in units of the signal
  int degree = 0;              ///< record: degree of the hold between samples, 1-4; 0: as the chain needs
  int oversample = 1;          ///< record: steps a sample interval
  bool estimate_error = true;  ///< run a second time at half the step (or a tenth of the tolerance)
};

struct Stats {
  std::string engine;           ///< "exact", "record" or "cvode"
  std::size_t steps = 0;        ///< steps of the solver, or holds of the record engine
  std::size_t evaluations = 0;  ///< right-hand sides (cvode)
  std::size_t restarts = 0;     ///< at corners, clock edges and events (cvode)
  std::size_t events = 0;       ///< roots found (cvode)
  int degree = 0;               ///< record
  double compute_s = 0.0;       ///< without the error estimate
};

struct Result {
  std::vector<double> y;  ///< one a sample of the input
  /// Largest difference to the second, finer run; none when it was not asked for. It covers the numerical
  /// method, and in `model_error` what a block's own approximation (a fractional term) adds at most,
  /// relative.
  std::optional<double> error_estimate;
  double model_error = 0.0;
  Stats stats;
  std::vector<std::string> notes;  ///< e.g. what an engine could only do approximately
};

/// The output of a chain for a sampled input, which is a straight line between samples. An InputError when
/// the chain cannot be simulated (a model without blocks is the identity, and can).
Result simulate(const chain::Chain& chain, const TimeRecord& input, const Options& options = {});

}  // namespace bodesmith::simulate
