#include "gap/records/directions.hpp"

#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <utility>

#include "numeric/index.hpp"

namespace bodesmith::gap {
namespace {

double length_of(const std::vector<double>& v) {
  return as_eigen(v).norm();
}

}  // namespace

void Directions::add(std::vector<double> v) {
  // Differences tell a derivative to some cube root of the rounding.
  const double least = std::cbrt(std::numeric_limits<double>::epsilon());
  const double size = length_of(v);
  if (!(size > 0.0) || !std::isfinite(size)) return;
  for (double& x : v) x /= size;
  for (int twice = 0; twice < 2; ++twice) take_out(v);
  const double left = length_of(v);
  if (left < least) return;
  for (double& x : v) x /= left;
  all_.push_back(std::move(v));
}

void Directions::take_out(std::span<double> v) const {
  Eigen::Map<Eigen::VectorXd> rest(v.data(), eigen_index(v.size()));
  for (const auto& direction : all_) rest -= as_eigen(direction) * as_eigen(direction).dot(rest);
}

}  // namespace bodesmith::gap
