#include "faults/likelihood.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/whole_number.hpp"
#include "numeric/index.hpp"
#include "numeric/linear_algebra/dense.hpp"

namespace bodesmith::faults {
namespace {

/// Deviations of ln |H| and phase of what is nothing but floor.
constexpr double kGainAtFloor = 0.6;
constexpr double kPhaseAtFloor = 1.8;
/// Times the floor.
constexpr double kNothing = 1.5;
constexpr double kAnyPhase = 1.0;

double within_half_turn(double angle) {
  return std::remainder(angle, 2.0 * std::numbers::pi);
}

double log_above_floor(double log_gain, double floor) {
  return 0.5 * std::log(std::exp(2.0 * log_gain) + floor * floor);
}

/// |ln| of what a roughly known fault changes, at most that to the floor, and no more than this counts.
constexpr double kMostChange = 1.5;
double change_of(const Board& board, const Prediction& prediction, Eigen::Index k) {
  const double floor = board.floors()[std_index(k)];
  const Complex good = prediction.reference.size() > 0 ? prediction.reference(k) : board.good_response()(k);
  const Complex got = prediction.response(k);
  return std::min(kMostChange, std::abs(Complex(std::log((std::abs(got) + floor) / (std::abs(good) + floor)),
                                                std::arg(got * std::conj(good)))));
}

/// What is not known of a fault's details is smooth: so much of it varies freely from point to point, the rest over so
/// many decades.
constexpr double kFreeShare = 0.2;
constexpr double kDecadesOfKnot = 0.5;

/// Straight lines between knots over log frequency, [point][knot].
Eigen::MatrixXd hats(const Measurement& measured) {
  Hertz lowest{1e300};
  Hertz highest{0.0};
  for (const Channel& channel : measured.channels) {
    lowest = std::min(lowest, channel.grid.front());
    highest = std::max(highest, channel.grid.back());
  }
  const double decades = std::log10(highest.value / lowest.value);
  const Eigen::Index count = whole_number<Eigen::Index>(std::ceil(decades / kDecadesOfKnot), 0, 1000) + 1;
  Eigen::MatrixXd out(eigen_index(measured.points()), count);
  Eigen::Index k = 0;
  for (const Channel& channel : measured.channels) {
    for (const Hertz f : channel.grid) {
      const double at = std::log10(f.value / lowest.value) / kDecadesOfKnot;
      for (Eigen::Index knot = 0; knot < count; ++knot)
        out(k, knot) = std::max(0.0, 1.0 - std::abs(at - static_cast<double>(knot)));
      ++k;
    }
  }
  return out;
}

/// The slopes, and behind them what a standard deviation of the model's error does at each knot to gain and phase.
Eigen::MatrixXcd with_model_error(const Board& board, const Prediction& prediction) {
  if (!(prediction.model_error > 0.0)) return prediction.slopes;
  Eigen::MatrixXd knots = hats(board.measured());
  for (Eigen::Index k = 0; k < knots.rows(); ++k)
    knots.row(k) *= prediction.model_error * change_of(board, prediction, k);
  const Eigen::Index parts = prediction.slopes.cols();
  Eigen::MatrixXcd out(prediction.slopes.rows(), parts + 2 * knots.cols());
  out.leftCols(parts) = prediction.slopes;
  out.middleCols(parts, knots.cols()) = knots.cast<Complex>();
  out.rightCols(knots.cols()) = Complex(0.0, 1.0) * knots.cast<Complex>();
  return out;
}

/// One value a row, from the real and imaginary part of one a point.
template <class Real, class Imaginary>
Eigen::VectorXd stacked(const Residual& layout, Real real, Imaginary imaginary) {
  std::vector<double> out;
  for (std::size_t k = 0; k < layout.gain.size(); ++k) out.push_back(real(k));
  for (std::size_t k = 0; k < layout.gain.size(); ++k) {
    if (layout.has_phase[k] != 0) out.push_back(imaginary(k));
  }
  return as_eigen(out);
}

}  // namespace

Eigen::VectorXd Residual::rows() const {
  return stacked(
      *this, [&](std::size_t k) { return gain[k]; }, [&](std::size_t k) { return phase[k]; });
}

Residual residual_of(const Board& board, const Eigen::VectorXcd& response) {
  Residual out;
  Eigen::Index k = 0;
  for (const Channel& channel : board.measured().channels) {
    for (std::size_t i = 0; i < channel.grid.size(); ++i, ++k) {
      const double size = std::abs(response(k));
      const double floor = board.floors()[std_index(k)];
      out.has_phase.push_back(channel.phase_rad.empty() ? 0 : 1);
      // Nothing measured, nothing predicted: the same to every explanation.
      if (std::exp(channel.log_gain[i]) < kNothing * floor && size < 2.0 * kNothing * floor) {
        out.gain.push_back(0.0);
        out.phase.push_back(0.0);
        out.below_floor.push_back(1.0);
        continue;
      }
      const double power = size * size + floor * floor;
      out.gain.push_back(log_above_floor(channel.log_gain[i], floor) - 0.5 * std::log(power));
      out.below_floor.push_back(floor * floor / power);
      if (channel.phase_rad.empty()) {
        out.phase.push_back(0.0);
        continue;
      }
      // The phase of what is nothing but floor is anything: the same to every explanation.
      const double floor_part = out.below_floor.back();
      const double phase = within_half_turn(channel.phase_rad[i] - std::arg(response(k)));
      out.phase.push_back((1.0 - floor_part) * phase + floor_part * kAnyPhase);
    }
  }
  return out;
}

std::vector<double> differences_percent(const Board& board, const Eigen::VectorXcd& response) {
  const Residual left = residual_of(board, response);
  std::vector<double> out(left.gain.size());
  for (std::size_t k = 0; k < out.size(); ++k)
    out[k] = 100.0 * std::abs(std::polar(std::exp(left.gain[k]), left.phase[k]) - 1.0);
  return out;
}

Likelihood::Likelihood(const Board& board, const Prediction& prediction, const Noise& noise,
                       double part_spread) {
  set(board, prediction, noise, part_spread, nullptr);
}

Likelihood::Likelihood(const Board& board, const Prediction& prediction, const Noise& noise,
                       double part_spread, const Eigen::VectorXd& around, const Likelihood& left) {
  set(board, prediction, noise, part_spread, &left);
  residual_ += times(slopes_, around);
}

Eigen::VectorXd Likelihood::second_order(const Board& board, const Eigen::MatrixXcd& slopes,
                                         const Likelihood* left) const {
  const Eigen::Index unknowns = eigen_index(board.unknowns());
  if (left == nullptr) return 0.5 * slopes.leftCols(unknowns).cwiseAbs2().rowwise().sum();
  Eigen::MatrixXd real = slopes.real().transpose();
  Eigen::MatrixXd imaginary = slopes.imag().transpose();
  Eigen::VectorXd others = Eigen::VectorXd::Zero(slopes.rows());
  for (Eigen::Index u = 0; u < slopes.cols(); ++u) {
    if (u < unknowns && board.is_part(std_index(u))) continue;
    if (u < unknowns) others += slopes.col(u).cwiseAbs2();
    real.row(u).setZero();
    imaginary.row(u).setZero();
  }
  real = solve_lower(left->factor_, real);
  imaginary = solve_lower(left->factor_, imaginary);
  return 0.5 * ((real.colwise().squaredNorm() + imaginary.colwise().squaredNorm()).transpose() + others);
}

void Likelihood::set(const Board& board, const Prediction& prediction, const Noise& noise, double part_spread,
                     const Likelihood* left) {
  const Residual residual = residual_of(board, prediction.response);
  residual_ = residual.rows();
  const auto above = [&](std::size_t k) { return 1.0 - residual.below_floor[k]; };
  // At the floor the gain does not vary, the phase does.
  rows_ = stacked(residual, above, [](std::size_t) { return 1.0; }).sum();
  const Eigen::Index points = prediction.response.size();
  const Eigen::Index rows = residual_.size();
  Eigen::MatrixXcd slopes = with_model_error(board, prediction);
  for (Eigen::Index u = 0; u < prediction.slopes.cols(); ++u) {
    if (part_spread != 1.0 && board.is_part(std_index(u))) slopes.col(u) *= part_spread;
  }
  for (Eigen::Index k = 0; k < points; ++k) slopes.row(k) *= 1.0 - residual.below_floor[std_index(k)];
  const Eigen::VectorXd second = second_order(board, slopes, left);
  const auto variance = [&](std::size_t k, double of_noise, double at_floor) {
    const double order = second(eigen_index(k));
    const double model = kFreeShare * prediction.model_error * change_of(board, prediction, eigen_index(k));
    return of_noise * of_noise + order * order + model * model + at_floor;
  };
  // What is added to the signal at a random angle moves gain and phase alike as long as it is small.
  const auto gain_at_floor = [&](std::size_t k) {
    return residual.below_floor[k] * kGainAtFloor * kGainAtFloor;
  };
  const auto phase_at_floor = [&](std::size_t k) {
    const double share = residual.below_floor[k];
    return (1.0 - share) * gain_at_floor(k) + share * share * kPhaseAtFloor * kPhaseAtFloor;
  };
  weight_ = stacked(
                residual, [&](std::size_t k) { return variance(k, noise.gain, gain_at_floor(k)); },
                [&](std::size_t k) { return variance(k, noise.phase, phase_at_floor(k)); })
                .cwiseInverse();
  slopes_.resize(rows, slopes.cols());
  slopes_.topRows(points) = slopes.real();
  Eigen::Index row = points;
  for (Eigen::Index k = 0; k < points; ++k) {
    if (residual.has_phase[std_index(k)] != 0) slopes_.row(row++) = slopes.imag().row(k);
  }
  weighted_ = slopes_.transpose() * weight_.asDiagonal();
  factor_ =
      cholesky_factor(Eigen::MatrixXd::Identity(slopes.cols(), slopes.cols()) + times(weighted_, slopes_));
  log_determinant_ = 2.0 * factor_.diagonal().array().log().sum() - weight_.array().log().sum() +
                     static_cast<double>(rows) * std::log(2.0 * std::numbers::pi);
}

Eigen::VectorXd Likelihood::solved(const Eigen::VectorXd& a) const {
  Eigen::VectorXd out = times(weighted_, a);
  factor_.triangularView<Eigen::Lower>().solveInPlace(out);
  return out;
}

double Likelihood::inner(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const {
  return a.dot(weight_.cwiseProduct(b)) - solved(a).dot(solved(b));
}

double Likelihood::log_density() const {
  return log_density_of(residual_);
}

double Likelihood::log_density_of(const Eigen::VectorXd& residual) const {
  const Eigen::VectorXd y = solved(residual);
  return -0.5 * (residual.dot(weight_.cwiseProduct(residual)) - y.squaredNorm() + log_determinant_);
}

Eigen::VectorXd Likelihood::errors() const {
  Eigen::VectorXd out = solved(residual_);
  factor_.triangularView<Eigen::Lower>().transpose().solveInPlace(out);
  return out;
}

Eigen::VectorXd Likelihood::remaining() const {
  return residual_ - times(slopes_, errors());
}

}  // namespace bodesmith::faults
