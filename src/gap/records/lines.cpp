#include "gap/records/lines.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numeric>

#include "base/units.hpp"
#include "numeric/index.hpp"
#include "numeric/linear_algebra/dense.hpp"

namespace bodesmith::gap {
namespace {

/// A sine that others explain but for this part of it is no direction of its own.
constexpr double kMinOwnLine = 1e-6;

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

void take_out_direction(std::span<double> v, const std::vector<double>& direction) {
  const double part = std::inner_product(v.begin(), v.end(), direction.begin(), 0.0);
  for (std::size_t i = 0; i < v.size(); ++i) v[i] -= part * direction[i];
}

double length_of(const std::vector<double>& v) {
  return std::sqrt(std::inner_product(v.begin(), v.end(), v.begin(), 0.0));
}

}  // namespace

void LineBasis::set(std::span<const double> frequencies_hz, const TimeRecord& record, std::size_t from,
                    std::size_t end) {
  if (from == from_ && end == end_ &&
      std::equal(frequencies_hz.begin(), frequencies_hz.end(), frequencies_hz_.begin(),
                 frequencies_hz_.end()))
    return;
  frequencies_hz_.assign(frequencies_hz.begin(), frequencies_hz.end());
  from_ = from;
  end_ = end;
  directions_.clear();
  orthonormal_ = false;
  for (double hz : frequencies_hz) {
    auto [sine, cosine] = sine_and_cosine(hz, record, from, end);
    directions_.push_back(std::move(sine));
    directions_.push_back(std::move(cosine));
  }
}

void LineBasis::make_orthonormal(const Directions* beside) {
  Directions kept;
  for (auto& v : directions_) {
    const double size = length_of(v);
    for (int twice = 0; twice < 2; ++twice) {
      if (beside != nullptr) {
        for (const auto& d : *beside) take_out_direction(v, d);
      }
      for (const auto& d : kept) take_out_direction(v, d);
    }
    const double left = length_of(v);
    if (!(left > kMinOwnLine * size)) continue;
    for (double& x : v) x /= left;
    kept.push_back(std::move(v));
  }
  directions_ = std::move(kept);
  orthonormal_ = true;
}

void LineBasis::take_out(std::span<double> residual, const Directions* beside) {
  if (directions_.empty()) return;
  if (!orthonormal_) make_orthonormal(beside);
  for (const auto& d : directions_) take_out_direction(residual, d);
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
