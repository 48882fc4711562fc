#pragma once

#include <span>
#include <vector>

#include "hysteresis/model_type.hpp"

namespace bodesmith::hysteresis {

/// The ellipse model (ellipse paper, eq. 1-6): under u = u_0 + u_A sin(2πft) the output is an ellipse over the input,
///   y = y_0 + G (u − u_0) cos Δ + G u̇ sin Δ / (2πf),     G = y_A/u_A,  Δ = α2 − α1 < 0 (2), (A1)
/// with u̇ = (u_k − u_{k−1})/T_s, i.e. y_k = p1 u_k + p2 u_{k−1} + p3 (eq. 5) with
///   p1 = G (cos Δ + sin Δ/(2πf T_s)),  p2 = −G sin Δ/(2πf T_s),  p3 = y_0 − G u_0 cos Δ.
/// Not stored are p1, p2, p3 but G, Δ and y_0 as surfaces over (u_A, f): they do not depend on the sampling
/// time. Linear in u_A and in log f between the nodes, held outside. u_A and f of the running input are taken
/// from its last two turning points; before there are two, from `amplitude` and `operating_hz`. The model
/// knows sinusoids only: on other waveforms it is what a derivative can do.
///
/// Inverse (eq. 6): u_k = p1' y_k + p2' y_{k−1} + p3', the same form with 1/G and −Δ over (y_A, f). A lead,
/// hence a stable difference; the algebraic inverse of eq. 5 (u_k from u_{k−1}) would not be stable for Δ <
/// 0, as |p2/p1| > 1 once 2πf T_s < tan|Δ|. Exact on sinusoids up to the difference quotient (0.5 (2πf T_s)²
/// and half a sample).
struct Ellipse {
  double u_0 = 0.0;
  std::vector<double> u_a;           ///< amplitudes, rising
  std::vector<double> frequency_hz;  ///< rising
  std::vector<double> gain;          ///< G, row by amplitude
  std::vector<double> phase_rad;     ///< Δ
  std::vector<double> y_0;
  double amplitude = 1.0;
  double operating_hz = 1.0;

  static Ellipse from(const Parameters& values);

  /// Weights of the surfaces' nodes about an amplitude: 1 − part at `low`, part at `high`.
  struct Place {
    std::size_t low = 0;
    std::size_t high = 0;
    double part = 0.0;
  };
  Place place_of_amplitude(double amplitude_u) const;

  struct Point {
    double gain, phase_rad, y_0;
  };
  Point at(double amplitude_u, double frequency) const;
  /// The input amplitude that makes the output amplitude y_A at a frequency.
  double input_amplitude(double y_a, double frequency) const;
  /// p1, p2, p3 of eq. 5 (forward) at a sampling time.
  struct Coefficients {
    double p1, p2, p3;
  };
  Coefficients coefficients(double amplitude_u, double frequency, double sampling_s) const;
  /// p1', p2', p3' of eq. 6 over the output's amplitude.
  Coefficients inverse_coefficients(double y_a, double frequency, double sampling_s) const;
};

/// Amplitude and frequency of a signal from its last two turning points.
class WaveTracker {
 public:
  WaveTracker(double amplitude, double frequency) : amplitude_(amplitude), frequency_(frequency) {}
  void reset(double value);
  void move(double value, double dt_s);
  double amplitude() const { return amplitude_; }
  double frequency() const { return frequency_; }

 private:
  double amplitude_;
  double frequency_;
  double value_ = 0.0;
  double time_ = 0.0;
  int direction_ = 0;
  int turns_ = 0;
  double turn_value_ = 0.0;
  double turn_time_ = 0.0;
};

class EllipseOperator final : public Operator {
 public:
  explicit EllipseOperator(Ellipse model);
  double reset(double u) override;
  double step(double u, double dt_s) override;
  double peek(double u, double dt_s) const override;
  bool rate_independent() const override { return false; }

 private:
  double output(double u, double dt_s) const;
  Ellipse model_;
  WaveTracker start_;
  WaveTracker wave_;
  double u_ = 0.0;
};

class EllipseInverse final : public Inverse {
 public:
  explicit EllipseInverse(Ellipse model);
  double reset(double y) override;
  double step(double y, double dt_s) override;

 private:
  Ellipse model_;
  EllipseOperator forward_;
  WaveTracker start_;
  WaveTracker wave_;
  double y_ = 0.0;
};

/// Sine through samples at a known frequency, by least squares: mean + amplitude · sin(2πft + phase).
struct SineThrough {
  double mean = 0.0;
  double amplitude = 0.0;
  double phase_rad = 0.0;
};
SineThrough sine_through(std::span<const double> values, double step_s, double frequency_hz);

Identified identify_ellipse(std::span<const TimeRecord> records, const IdentifyOptions& options);

}  // namespace bodesmith::hysteresis
