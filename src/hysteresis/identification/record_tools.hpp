#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "hysteresis/inverse.hpp"
#include "hysteresis/model_type.hpp"
#include "numeric/optimisation/least_squares.hpp"
#include "signal/time_record.hpp"

namespace bodesmith::hysteresis {

/// The bounded fit of numeric/optimisation/least_squares.hpp for models that are cheap to run and smooth: a fresh Jacobian
/// every iteration, down to a relative drop of 1e-10. `typical` is the size of each parameter. The deviations are those
/// of parameter_deviation(): a residual that remembers itself tells less.
LeastSquaresResult fit_parameters(const std::function<void(const Eigen::VectorXd& x, Eigen::VectorXd& r)>& f,
                                  const Eigen::VectorXd& start, const Eigen::VectorXd& lower,
                                  const Eigen::VectorXd& upper, const Eigen::VectorXd& typical,
                                  int iterations = 100);

/// What the identifications of all models do with their records. "Counted" are the samples from skip_s on: those
/// before are simulated but not fitted (start transients).

struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  void include(double value) {
    low = value < low ? value : low;
    high = value > high ? value : high;
  }
  double width() const { return high - low; }
  double middle() const { return 0.5 * (low + high); }
};

/// Index of the first counted sample; the last sample counts always.
std::size_t first_counted(const TimeRecord& record, double skip_s);
std::size_t counted_samples(std::span<const TimeRecord> records, double skip_s);
/// Over the counted samples of all records.
Range input_range(std::span<const TimeRecord> records, double skip_s);
Range output_range(std::span<const TimeRecord> records, double skip_s);
/// input_range(), of all samples unless told. Throws InputError when the input never moves.
Range swept_range(std::span<const TimeRecord> records, double skip_s = 0.0);
/// y of the counted samples, one record after the other.
Eigen::VectorXd counted_outputs(std::span<const TimeRecord> records, double skip_s);

/// Drives the operator through every record, each from rest under its first input, and calls
/// use(output, record, i) for every counted sample.
template <class AnyOperator, class Use>
void drive(AnyOperator& op, std::span<const TimeRecord> records, double skip_s, Use&& use,
           const Scaling& input = {}) {
  for (const TimeRecord& record : records) {
    const std::size_t first = first_counted(record, skip_s);
    double y = op.reset(input(record.u[0]));
    for (std::size_t i = 0; i < record.size(); ++i) {
      if (i > 0) y = op.step(input(record.u[i]), record.step_s);
      if (i >= first) use(y, record, i);
    }
  }
}

/// Model minus record for every counted sample; every record starts at rest under its first input.
void operator_residual(Operator&& op, std::span<const TimeRecord> records, double skip_s,
                       Eigen::VectorXd& residual);

/// A branch of a record: samples first … last over which the input moves one way only.
struct Branch {
  std::size_t first = 0;
  std::size_t last = 0;
  bool rising = true;
};
/// Cuts at the turning points of the input; moves smaller than `dead` times the input's range do not count as
/// turns.
std::vector<Branch> branches(const std::vector<double>& u, double dead = 1e-3);

/// "w[0]", "w[1]", … with their values and deviations; the first of them at `from` in both.
void add_uncertainty(std::vector<ParameterUncertainty>& out, std::string_view list,
                     const Eigen::VectorXd& values, const Eigen::VectorXd& deviations, Eigen::Index from,
                     Eigen::Index count);

/// Ways to find the gain K_i between the polynomial of one frequency or amplitude and the basis one (eq.
/// 11-13).
enum class GainReading {
  /// p_i ≈ K p_1: K = Σ p_1 p_i / Σ p_1². What eq. 17 needs (the compensator multiplies the basis). The
  /// default.
  basis_times_gain,
  /// p_1 ≈ K p_i: K = Σ p_1 p_i / Σ p_i², eq. 13 as printed.
  as_printed,
};
/// Over x_k evenly spread on [0, 1], in closed form (integrals instead of sums).
double disturbance_gain(const std::array<double, 3>& basis, const std::array<double, 3>& other,
                        GainReading reading = GainReading::basis_times_gain);

/// Eq. 4, 5: a1, a2, a3 = −a1 − a2 by least squares over the samples (x_i, d_i).
struct PolynomialFit {
  std::array<double, 3> a{};
  std::array<double, 2> deviation{};  ///< standard deviation of a1 and a2
};
PolynomialFit fit_polynomial(std::span<const double> x, std::span<const double> d);
/// The amplitude of eq. 10.
double fit_sine(std::span<const double> x, std::span<const double> d);

}  // namespace bodesmith::hysteresis
