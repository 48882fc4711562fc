#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "simulate/record/modal_pairs.hpp"

namespace bodesmith::simulate {

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
  static constexpr std::size_t kMaxInputDegree = 8;

  struct Segment {
    double begin = 0.0;
    double end = 0.0;
    std::size_t degree = 0;
    double coefficients[kMaxInputDegree + 1] = {};  ///< of ((t - begin)/(end - begin))^k
  };

  /// Output samples are taken at start_s + i step_s.
  ExactPropagator(ModalSystem system, double step_s);

  /// All states at rest under u; without it they are 0.
  void rest_under(double u);
  /// Output at every sample from segments.front().begin to segments.back().end; a sample on a common end
  /// belongs to the earlier segment (the first sample to the first). Segments join without gaps. Returns how
  /// many samples were written.
  std::size_t run(std::span<const Segment> segments, double start_s, std::span<double> output);

 private:
  using Mode = Complex;
  static constexpr std::size_t kTaylor = 20;
  static constexpr std::size_t kBlock = 8;
  void polynomial_of(const Segment& segment);
  /// One mode over a segment: its share of the polynomial, its exponential's amplitude, its state at the end.
  void fast_mode(std::size_t k, Mode q, Mode r, const Segment& segment);
  void slow_mode(std::size_t k, Mode q, Mode r, const Segment& segment);
  void write_polynomial(double first, double scale, std::span<double> output) const;
  void add_exponentials(double first, std::size_t count, double* output) const;
  void add_real(std::size_t k, double start, std::size_t count, double* output) const;
  void add_pair(std::size_t k, Mode start, std::size_t count, double* output) const;
  /// What is below 1e-22 of where it began no longer changes a sum of doubles; stopping also keeps denormals
  /// away.
  double negligible(std::size_t k) const { return 1e-22 * std::abs(amplitude_[k]); }

  ModalSystem system_;
  double step_;
  std::vector<Mode> state_;
  std::vector<Mode> amplitude_;                  // of each fast mode's exponential; 0 for slow ones
  std::vector<double> power_real_, power_imag_;  // exp(p step j), j = 0...7, a row a mode
  std::vector<Mode> block_power_;                // exp(8 p step)
  double sum_[kTaylor + 1] = {};                 // the output's polynomial in (t - begin)/T
  std::size_t sum_degree_ = 0;
};

}  // namespace bodesmith::simulate
