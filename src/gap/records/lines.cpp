#include "gap/records/lines.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <complex>
#include <utility>

#include "base/units.hpp"
#include "numeric/index.hpp"
#include "numeric/linear_algebra/dense.hpp"

namespace bodesmith::gap {
namespace {

/// sin and cos at `hz` over samples `from` … `end` - 1, by turning a pointer.
std::pair<std::vector<double>, std::vector<double>> sine_and_cosine(double hz, const TimeRecord& record,
                                                                    std::size_t from, std::size_t end) {
  const double w = Hertz{hz}.rad_s().value;
  const auto turn = std::polar(1.0, w * record.step_s);
  auto pointer = std::polar(1.0, w * record.time_s(from));
  std::pair<std::vector<double>, std::vector<double>> out;
  out.first.reserve(end - from);
  out.second.reserve(end - from);
  for (std::size_t i = from; i < end; ++i) {
    out.first.push_back(pointer.imag());
    out.second.push_back(pointer.real());
    pointer *= turn;
  }
  return out;
}

}  // namespace

Directions directions_of_lines(std::span<const double> frequencies_hz, const TimeRecord& record,
                               std::size_t from, std::size_t end) {
  Directions directions;
  for (double hz : frequencies_hz) {
    auto [sine, cosine] = sine_and_cosine(hz, record, from, end);
    directions.add(std::move(sine));
    directions.add(std::move(cosine));
  }
  return directions;
}

std::vector<FittedLine> fit_lines(std::span<const double> frequencies_hz, const TimeRecord& record,
                                  std::size_t from, std::span<const double> residual) {
  const auto n = eigen_index(residual.size());
  Eigen::MatrixXd x(n, eigen_index(2 * frequencies_hz.size()));
  for (std::size_t k = 0; k < frequencies_hz.size(); ++k) {
    const auto [sine, cosine] = sine_and_cosine(frequencies_hz[k], record, from, from + residual.size());
    x.col(eigen_index(2 * k)) = as_eigen(sine);
    x.col(eigen_index(2 * k + 1)) = as_eigen(cosine);
  }
  Eigen::MatrixXd normal = gram(x);
  normal.diagonal().array() *= 1.0 + 1e-12;  // two lines at one place share it
  const Eigen::VectorXd weight =
      solve_ldlt(normal, transpose_times(x, Eigen::Map<const Eigen::VectorXd>(residual.data(), n)));
  std::vector<FittedLine> lines;
  for (Eigen::Index k = 0; k + 1 < weight.size(); k += 2) {
    lines.push_back({std::hypot(weight(k), weight(k + 1)), to_degrees(std::atan2(weight(k + 1), weight(k)))});
  }
  return lines;
}

}  // namespace bodesmith::gap
