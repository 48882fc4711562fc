#include "fit/root_model.hpp"

#include <algorithm>
#include <cmath>

namespace bodesmith {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;

constexpr double kMostDamping = 1e6;

/// ln of (c + jw), derivative by ln c.
Complex real_root(double log_corner, double w, Complex& slope) {
  const Complex value(std::exp(log_corner), w);
  slope = value.real() / value;
  return std::log(value);
}

/// ln of (jw)^2 + 2 zeta w0 jw + w0^2, derivatives by ln w0 and ln zeta; the argument runs from 0 to pi.
Complex root_pair(double log_w0, double log_zeta, double w, Complex& by_w0, Complex& by_zeta) {
  const double w0 = std::exp(log_w0);
  const double damping = 2.0 * std::exp(log_zeta) * w0 * w;
  const Complex value((w0 - w) * (w0 + w), damping);
  by_zeta = Complex(0.0, damping) / value;
  by_w0 = by_zeta + 2.0 * w0 * w0 / value;
  return {std::log(std::abs(value)), std::atan2(value.imag(), value.real())};
}

double log_of_larger_root(double log_w0, double log_zeta) {
  const double zeta = std::exp(log_zeta);
  return zeta <= 1.0 ? log_w0 : log_w0 + std::log(zeta + std::sqrt((zeta - 1.0) * (zeta + 1.0)));
}
double log_of_smaller_root(double log_w0, double log_zeta) {
  return 2.0 * log_w0 - log_of_larger_root(log_w0, log_zeta);
}

}  // namespace

Complex RootModel::log_response(const Eigen::VectorXd& theta, RadPerSecond w,
                                Eigen::RowVectorXcd* slope) const {
  if (slope != nullptr) {
    slope->resize(size());
    (*slope)(0) = 1.0;
  }
  Complex out(theta(0), 0.0);
  Index at = 1;
  for (const int sign : {1, -1}) {
    const int reals = sign > 0 ? real_zeros : real_poles;
    const int pairs = sign > 0 ? zero_pairs : pole_pairs;
    for (int i = 0; i < reals; ++i, ++at) {
      Complex here;
      Complex there;
      out += static_cast<double>(sign) * real_root(theta(at), w.value, here);
      out -= sign * real_root(theta(at), reference.value, there).real();
      if (slope != nullptr) (*slope)(at) = static_cast<double>(sign) * (here - there.real());
    }
    for (int i = 0; i < pairs; ++i, at += 2) {
      Complex here[2];
      Complex there[2];
      out += static_cast<double>(sign) * root_pair(theta(at), theta(at + 1), w.value, here[0], here[1]);
      out -= sign * root_pair(theta(at), theta(at + 1), reference.value, there[0], there[1]).real();
      if (slope != nullptr) {
        (*slope)(at) = static_cast<double>(sign) * (here[0] - there[0].real());
        (*slope)(at + 1) = static_cast<double>(sign) * (here[1] - there[1].real());
      }
    }
  }
  return out;
}

RootModel::Roots RootModel::roots(const Eigen::VectorXd& theta) const {
  Roots out;
  Index at = 1;
  double log_gain = theta(0);
  for (const int sign : {1, -1}) {
    auto& list = sign > 0 ? out.zeros : out.poles;
    const int reals = sign > 0 ? real_zeros : real_poles;
    const int pairs = sign > 0 ? zero_pairs : pole_pairs;
    for (int i = 0; i < reals; ++i, ++at) list.emplace_back(-std::exp(theta(at)), 0.0);
    for (int i = 0; i < pairs; ++i, at += 2) {
      const double w0 = std::exp(theta(at));
      const double zeta = std::exp(theta(at + 1));
      if (zeta < 1.0) {
        const Complex root(-zeta * w0, w0 * std::sqrt((1.0 - zeta) * (1.0 + zeta)));
        list.push_back(root);
        list.push_back(std::conj(root));
      } else {
        list.emplace_back(-std::exp(log_of_smaller_root(theta(at), theta(at + 1))), 0.0);
        list.emplace_back(-std::exp(log_of_larger_root(theta(at), theta(at + 1))), 0.0);
      }
    }
    const Complex s(0.0, reference.value);
    for (const Complex& root : list) log_gain -= sign * std::log(std::abs(s - root));
  }
  out.gain = std::exp(log_gain);
  return out;
}

void add_limits(const RootModel& model, const RootLimits& limits, const Eigen::VectorXd& theta,
                std::vector<Eigen::RowVectorXd>& rows, std::vector<double>& most) {
  const double low = std::log(limits.low.value);
  const double high = std::log(limits.high.value);
  const double least = std::log(limits.least_damping);
  const auto add = [&](Index at, double factor, double bound) {
    Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(theta.size());
    row(at) = factor;
    rows.push_back(std::move(row));
    most.push_back(bound);
  };
  const auto add_two = [&](Index at, double first, double second, double bound) {
    Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(theta.size());
    row(at) = first;
    row(at + 1) = second;
    rows.push_back(std::move(row));
    most.push_back(bound);
  };
  Index at = 1;
  for (const bool zero : {true, false}) {
    for (int i = 0; i < (zero ? model.real_zeros : model.real_poles); ++i, ++at) {
      add(at, 1.0, high - theta(at));
      add(at, -1.0, theta(at) - low);
    }
    for (int i = 0; i < (zero ? model.zero_pairs : model.pole_pairs); ++i, at += 2) {
      add(at + 1, -1.0, theta(at + 1) - least);
      add(at + 1, 1.0, std::log(kMostDamping) - theta(at + 1));
      // d ln(larger root)/d ln zeta = zeta / sqrt(zeta^2 - 1): infinite where the pair parts; a bounded slope
      // there.
      const double zeta = std::exp(theta(at + 1));
      const double bend = zeta <= 1.0 ? 0.0 : std::min(3.0, zeta / std::sqrt((zeta - 1.0) * (zeta + 1.0)));
      add_two(at, 1.0, bend, high - log_of_larger_root(theta(at), theta(at + 1)));
      add_two(at, -1.0, bend, log_of_smaller_root(theta(at), theta(at + 1)) - low);
    }
  }
}

void clamp(const RootModel& model, const RootLimits& limits, Eigen::VectorXd& theta) {
  const double low = std::log(limits.low.value);
  const double high = std::log(limits.high.value);
  Index at = 1;
  for (const bool zero : {true, false}) {
    for (int i = 0; i < (zero ? model.real_zeros : model.real_poles); ++i, ++at) {
      theta(at) = std::clamp(theta(at), low, high);
    }
    for (int i = 0; i < (zero ? model.zero_pairs : model.pole_pairs); ++i, at += 2) {
      theta(at) = std::clamp(theta(at), low, high);
      theta(at + 1) = std::clamp(theta(at + 1), std::log(limits.least_damping), std::log(kMostDamping));
      if (log_of_larger_root(theta(at), theta(at + 1)) > high ||
          log_of_smaller_root(theta(at), theta(at + 1)) < low) {
        const double spread = std::min(high - theta(at), theta(at) - low);  // ln of larger root over w0
        theta(at + 1) = std::log(std::cosh(std::max(0.0, spread)));
      }
    }
  }
}

}  // namespace bodesmith
