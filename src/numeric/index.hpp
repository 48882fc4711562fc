#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

namespace bodesmith {

/// The standard library counts with std::size_t, Eigen with Eigen::Index. A loop counts in the type of what
/// it walks over; where the two meet, these say so (and -Wsign-conversion catches what does not).
constexpr Eigen::Index eigen_index(std::size_t n) {
  return static_cast<Eigen::Index>(n);
}
constexpr std::size_t std_index(Eigen::Index n) {
  return static_cast<std::size_t>(n);
}

/// The numbers of a vector or span, seen by Eigen, not copied.
inline Eigen::Map<Eigen::VectorXd> as_eigen(std::span<double> v) {
  return {v.data(), eigen_index(v.size())};
}
inline Eigen::Map<const Eigen::VectorXd> as_eigen(std::span<const double> v) {
  return {v.data(), eigen_index(v.size())};
}
inline Eigen::Map<Eigen::VectorXd> as_eigen(std::vector<double>& v) {
  return as_eigen(std::span<double>(v));
}
inline Eigen::Map<const Eigen::VectorXd> as_eigen(const std::vector<double>& v) {
  return as_eigen(std::span<const double>(v));
}
inline std::vector<double> to_vector(const Eigen::VectorXd& v) {
  return {v.data(), v.data() + v.size()};
}

}  // namespace bodesmith
