#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "simulate/hold_response.hpp"
#include "simulate/record/modal_pairs.hpp"

namespace bodesmith::simulate {

/// The modes of a linear system over holds of equal length, two by two: a step costs four products a pair (two when
/// all are real) where the full matrix costs the square of the order. Exact for inputs that are polynomials of the
/// hold's degree.
class ModalPropagator {
 public:
  /// Up to this many pairs; a larger system is not for it.
  static constexpr std::size_t kMaxPairs = 6;

  /// What each output node shows: the part `at[i]` of the hold, with the input there `weights[i]` of its nodes.
  struct Output {
    double s = 1.0;
    double weights[kMaxDegree + 1] = {};
  };

  /// False, and nothing prepared, when the modes are badly conditioned or too many.
  bool prepare(const StateSpace& system, double h, const HoldNodes& nodes, std::span<const Output> outputs);

  /// From the system's states x.
  void start(const double* x) { modes_.to_modes(x, state_.data()); }
  /// `y` gets outputs.size() values a hold; the next run goes on from there.
  void run(const double* u, double* y, std::size_t holds);

  /// The output at the samples of an input that is straight between them, one hold a sample interval, in place.
  /// Prepared with degree 1, after start().
  void run_samples(double* signal, std::size_t count);

  const ModalPairs& modes() const { return modes_; }

 private:
  using Lanes = std::array<double, 2 * kMaxPairs>;

  template <std::size_t Pairs, std::size_t Degree, bool Coupled>
  void run_holds(const double* u, double* y, std::size_t holds);
  template <std::size_t Pairs, bool Coupled>
  void run_straight(double* signal, std::size_t count);

  ModalPairs modes_;
  std::size_t degree_ = 1;
  double direct_ = 0.0;
  double offset_ = 0.0;
  // A lane a state: w' = own w + other (its partner's w) + sum_j input[j] u_j + constant.
  Lanes own_{}, other_{}, constant_{};
  std::array<Lanes, kMaxDegree + 1> input_{};
  // Node i of the output: sum over lanes of see[i] w, plus sum_j direct_rows[i][j] u_j + constant_rows[i].
  std::array<Lanes, kMaxDegree + 1> see_{};
  std::array<std::array<double, kMaxDegree + 1>, kMaxDegree + 1> direct_rows_{};
  std::array<double, kMaxDegree + 1> constant_rows_{};
  Lanes state_{};
  HoldResponseSolver solver_;
  HoldResponse response_;
};

/// Two doubles that are worked on at once, as every x86-64 and ARMv8 can: a vector type of GCC and Clang.
using TwoLanes = double __attribute__((vector_size(16)));

inline TwoLanes load_lanes(const double* p) {
  return TwoLanes{p[0], p[1]};
}
inline TwoLanes both_lanes(double v) {
  return TwoLanes{v, v};
}
inline TwoLanes swapped_lanes(TwoLanes v) {
  return TwoLanes{v[1], v[0]};
}

}  // namespace bodesmith::simulate
