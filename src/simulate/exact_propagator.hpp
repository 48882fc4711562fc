#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "lti/state_space.hpp"

namespace bodesmith::simulate {

/// A stable linear system H(s) = d + sum_k r_k/(s - p_k), pole by pole (a conjugate pair counts as one
/// complex mode).
struct ModalSystem {
  double direct = 0.0;
  std::vector<std::complex<double>> poles;  ///< one of each pair, imaginary part >= 0
  std::vector<std::complex<double>> residues;
  /// sum |r_k/p_k| over the largest |H| seen at its own corners: how many times larger the modes are than
  /// what they add up to. Rounding is that much worse; near-equal poles make it large.
  double condition = 1.0;

  /// Products over the roots, cost n^2. Poles that are exactly equal give an infinite condition.
  static ModalSystem from(const Sections& sections);
  /// Eigenvalues of a state space (its offset and constant are left to the caller).
  static ModalSystem from(const StateSpace& system);
  /// Above it an engine should not use the modes.
  static constexpr double kMostCondition = 1e6;
};

/// The exact output of a modal system under an input that is a polynomial on each of a few long segments, at
/// many evenly spaced times.
///
/// On a segment of length T every mode x' = p x + u has a closed form. With |p T| > 1.5 it is a polynomial
/// (the particular solution) plus one exponential; with |p T| <= 1.5 its Taylor series to degree 20 is exact
/// to rounding and cannot cancel. So the output is ONE polynomial plus one exponential a fast mode, which run
/// eight samples at a time, until they have died away. Cost: per segment about 25 operations a mode, per
/// sample one or two a living mode. run() allocates nothing.
class ExactPropagator {
 public:
  static constexpr int kMostInputDegree = 8;

  struct Segment {
    double begin = 0.0;
    double end = 0.0;
    int degree = 0;
    double coefficients[kMostInputDegree + 1] = {};  ///< of ((t - begin)/(end - begin))^k
  };

  /// Output samples are taken at start_s + i step_s.
  ExactPropagator(ModalSystem system, double step_s);

  /// All states 0, or at rest under u.
  void reset();
  void rest_under(double u);
  /// Output at every sample from segments.front().begin to segments.back().end; a sample on a common end
  /// belongs to the earlier segment (the first sample to the first). Segments join without gaps. Returns how
  /// many samples were written.
  std::size_t run(std::span<const Segment> segments, double start_s, std::span<double> output);

  const ModalSystem& system() const { return system_; }

 private:
  static constexpr int kTaylor = 20;
  static constexpr int kBlock = 8;
  void polynomial_of(const Segment& segment);
  void add_exponentials(double first, std::size_t count, double* output);

  ModalSystem system_;
  double step_;
  std::vector<double> pole_real_, pole_imag_;
  std::vector<std::complex<double>> state_;
  std::vector<std::complex<double>> amplitude_;    // of each fast mode's exponential; 0 for slow ones
  std::vector<double> power_real_, power_imag_;    // exp(p step j), j = 0...7, a row a mode
  std::vector<std::complex<double>> block_power_;  // exp(8 p step)
  double sum_[kTaylor + 1] = {};                   // the output's polynomial in (t - begin)/T
  int sum_degree_ = 0;
};

}  // namespace bodesmith::simulate
