#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.hpp"
#include "chain/chain.hpp"
#include "signal/time_record.hpp"

namespace bodesmith::simulate {

/// How a chain is worked out.
enum class Engine {
  automatic,  ///< exact where the chain and its input allow it, else record, its step halved until the
              ///< tolerance is met; where a kink keeps it from that, cvode if that does better
  record,     ///< sample to sample with the step as given, see record_simulator.hpp
  exact,      ///< closed form between the corners of the input; an error where there is none
  cvode,      ///< the whole chain as an ODE with events, see ode_solve.hpp
  grunwald_letnikov,  ///< a linear chain by fractional differences, first order in the step
};
/// "automatic", "record", "exact", "cvode", "grunwald-letnikov".
std::string_view to_string(Engine engine);

using chain::Start;
using chain::to_string;

/// Where a run begins: as it was asked, else as the model says, else from zero.
inline Start start_of(const chain::Chain& model, std::optional<Start> asked) {
  return asked.value_or(model.start.value_or(Start::zero));
}

struct Options {
  Engine engine = Engine::automatic;
  std::optional<Start> start;         ///< nothing: as the model says, zero where it does not
  double relative_tolerance = 1e-8;   ///< automatic (of the largest output) and cvode
  double absolute_tolerance = 1e-10;  ///< the same, in units of the signal
  std::size_t oversample = 1;         ///< record, grunwald_letnikov: steps a sample interval
  bool estimate_error = true;         ///< run a second time at half the step (or a tenth of the tolerance)

  /// The same with a tenth of the tolerances.
  Options finer() const;
};

struct Stats {
  Engine engine = Engine::automatic;  ///< the one that did it: exact, record or cvode
  std::size_t steps = 0;              ///< steps of the solver, or holds of the record engine
  std::size_t evaluations = 0;        ///< right-hand sides (cvode)
  std::size_t restarts = 0;           ///< at corners, clock edges and events (cvode)
  std::size_t events = 0;             ///< roots found (cvode)
  std::size_t degree = 0;             ///< record: of the hold between samples, 1 where that is exact, else 3
  double compute_s = 0.0;             ///< without the error estimate
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

/// Why there is no closed form.
struct NoClosedForm {
  std::string text;
};

/// u = f + control(r - y), y = P{u}: a feed-forward signal and the loop round the plant, as the disturbance
/// paper's hybrid controllers. r and f are straight lines between samples.
struct LoopResult : Result {
  std::vector<double> drive;  ///< u; at a clock edge of a sampled controller its new value
};

/// An output beyond which a model is said to run away: sums of squares of less are doubles.
inline constexpr double kLargestOutput = 1e150;

/// The chain runs, and its output grows without bound for this input: a figure where models are compared, an error elsewhere.
class RunsAway : public InputError {
 public:
  using InputError::InputError;
};

/// The input of a TimeRecord, or of samples that lie elsewhere; a view.
struct SampledInput {
  double start_s = 0.0;
  double step_s = 0.0;
  std::span<const double> u;

  SampledInput(double start, double step, std::span<const double> samples)
      : start_s(start), step_s(step), u(samples) {}
  SampledInput(const TimeRecord& record) : SampledInput(record.start_s, record.step_s, record.u) {}

  std::size_t size() const { return u.size(); }
};

/// A clock of more edges than this in one record (some seconds of computing) is a slip of the pen.
inline constexpr double kMostEdges = 1e8;
/// Steps of an adaptive solver after which a record is given up: minutes.
inline constexpr std::size_t kMostSolverSteps = 50'000'000;

/// InputError naming `what` (the clock and its value) when there would be more.
void require_few_edges(double edges, std::string_view what, double most = kMostEdges);

}  // namespace bodesmith::simulate
