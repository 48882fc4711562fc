#pragma once

#include <optional>
#include <string_view>
#include <variant>

#include "base/registry.hpp"
#include "chain/chain.hpp"
#include "signal/time_record.hpp"
#include "simulate/types.hpp"

namespace bodesmith::simulate {

/// One way to work out a chain. Engines have no state.
class ChainEngine {
 public:
  virtual ~ChainEngine() = default;
  virtual Engine which() const = 0;
  /// How it treats a block of this kind, in a word or two for a report.
  virtual std::string_view method(const chain::Kernel& kernel) const = 0;
  /// Once, without an error estimate (but where the outcome is exact and its rounding known). InputError when the
  /// model cannot be solved for this input.
  virtual std::variant<Result, NoClosedForm> run(const chain::Chain& chain, const TimeRecord& input,
                                                 const Options& options) const = 0;
  /// By a second, finer run.
  virtual double estimate_error(const chain::Chain& chain, const TimeRecord& input, const Options& options,
                                const Result& result) const = 0;
};

const ChainEngine& record_engine();
const ChainEngine& exact_engine();
const ChainEngine& cvode_engine();
const ChainEngine& grunwald_letnikov_engine();
/// Not of Engine::automatic, which is a choice between them (simulate.cpp).
const ChainEngine& chain_engine(Engine which);

/// The record engine once, on samples where they lie.
Result run_record(const chain::Chain& chain, const SampledInput& input, const Options& options);

/// The record engine, its step halved until that no longer changes the output by more than the tolerance;
/// the finest run counts, error estimate included.
struct RefinedRecord {
  enum class Outcome {
    converged,
    smallest_step,
    corners_hidden,  ///< it no longer changed, which says nothing: corners of the input lie between the nodes of every step
  };
  Outcome outcome = Outcome::converged;
  Result result;
};
RefinedRecord run_record_refined(const chain::Chain& chain, const TimeRecord& input, const Options& options);

/// CVODE's output, and its error where options.estimate_error asks for it, which takes as long again. Nothing where it cannot be had: of
/// chains that CVODE does not solve, and beyond 100 000 samples, as it stops at every corner of the input.
std::optional<Result> second_opinion(const chain::Chain& chain, const TimeRecord& input,
                                     const Options& options);

}  // namespace bodesmith::simulate
