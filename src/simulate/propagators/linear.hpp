#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "chain/kernel.hpp"
#include "simulate/hold_response.hpp"
#include "simulate/propagators/modal.hpp"

namespace bodesmith::simulate {

/// A linear system with delay, run over holds of equal length: exact for inputs that are polynomials of the
/// hold's degree. Systems of some size go by their modes where these are well conditioned, others by the full matrix.
class LinearPropagator {
 public:
  /// `keeps_states`: run() leaves the states at the end in x, to go on from; not by modes then.
  void prepare(const chain::LinearKernel& system, double h, const HoldNodes& nodes,
               bool keeps_states = false);

  /// u and y hold `holds` blocks of degree+1 node values and must not overlap. `x` starts the run and is used up.
  /// Before the delay has passed the output is `before`.
  void run(const double* u, double* y, std::size_t holds, double* x, double before);

  /// The output at the samples of an input that is straight between them (prepared with degree 1, a hold a sample
  /// interval, no delay), in place.
  void run_samples(double* signal, std::size_t count, const double* x);

  /// Of what was prepared: how many times larger than the output its parts are, and its slowest rate (0: unknown).
  double condition() const { return by_modes_ ? modal_.modes().condition : 1.0; }
  double slowest_rad_s() const { return by_modes_ ? modal_.modes().slowest_rad_s : 0.0; }

 private:
  /// Where an output node looks: `shift` holds earlier, part s of that hold.
  struct Source {
    std::size_t shift = 0;
    double s = 0.0;
  };
  Source source_of(std::size_t node, double delay, const HoldNodes& nodes) const;
  bool prepare_modes(const chain::LinearKernel& system, double h, const HoldNodes& nodes);
  void set_row(std::size_t node, const chain::LinearKernel& system, const double* weights,
               const HoldResponse& response);
  template <std::size_t N, std::size_t P>
  void run_fixed(const double* u, double* y, std::size_t holds, double* x);
  /// False when there is no fixed size for this order and degree.
  bool run_fixed_size(const double* u, double* y, std::size_t holds, double* x);
  void run_any(const double* u, double* y, std::size_t holds, double* x, double before);
  void run_modes(const double* u, double* y, std::size_t holds, const double* x, double before);
  template <std::size_t N, bool Lower>
  void run_straight(double* signal, std::size_t count, const double* x);
  template <std::size_t... N>
  void run_straight_of(std::index_sequence<N...> sizes, bool lower, double* signal, std::size_t count,
                       const double* x);
  void run_straight_any(double* signal, std::size_t count, const double* x);

  std::size_t order_ = 0;
  std::size_t degree_ = 1;
  bool delayed_ = false;
  bool by_modes_ = false;
  ModalPropagator modal_;
  double gain_ = 0.0;
  double offset_ = 0.0;
  // Row i gives node i of the output: c_rows x + d_rows u + k_rows. With a delay, that of the hold shift_[i]
  // later.
  std::vector<double> c_rows_;
  std::vector<double> d_rows_;
  std::vector<double> k_rows_;
  std::vector<std::size_t> shift_;
  std::vector<double> seen_;  ///< c of the system
  HoldResponse end_;
  HoldResponse inner_;
  HoldResponseSolver solver_;
  std::vector<double> next_;
};

/// The last few that were prepared: differences move a parameter and put it back.
class PreparedPropagators {
 public:
  LinearPropagator& of(const chain::LinearKernel& system, double h, const HoldNodes& nodes,
                       bool keeps_states = false);

 private:
  struct Prepared {
    chain::LinearKernel system;
    double h = 0.0;
    std::size_t degree = 0;
    bool keeps_states = false;
    LinearPropagator by;
  };
  std::vector<Prepared> all_;
  std::size_t oldest_ = 0;
};

}  // namespace bodesmith::simulate
