#include "fit/direct/root_model.hpp"

#include <algorithm>
#include <cmath>

#include "numeric/four.hpp"
#include "numeric/index.hpp"

namespace bodesmith {
namespace {

using Eigen::Index;

constexpr double kMaxDamping = 1e6;  ///< two roots twelve decades apart: beyond any band

double log_of_larger_root(double log_w0, double log_zeta) {
  const double zeta = std::exp(log_zeta);
  return zeta <= 1.0 ? log_w0 : log_w0 + std::log(zeta + std::sqrt((zeta - 1.0) * (zeta + 1.0)));
}
double log_of_smaller_root(double log_w0, double log_zeta) {
  return 2.0 * log_w0 - log_of_larger_root(log_w0, log_zeta);
}

/// One root's factors at many frequencies, real and imaginary parts apart; `n` of them, a multiple of four.
struct RootFactor {
  double corner, damping, scale, sign;
  double slope[2];  ///< of ln |factor at the reference|, by its two numbers
  bool pair;
};

/// value = (corner - w)(corner + w) + j damping w, or corner + j w.
BODESMITH_CLONES void factor_at(const RootFactor& f, const double* w, std::size_t n, double* re, double* im) {
  const Four zero = {0.0, 0.0, 0.0, 0.0};
  for (std::size_t i = 0; i < n; i += 4) {
    const Four at = *four_at(w + i);
    *four_at(re + i) = f.pair ? (f.corner - at) * (f.corner + at) : zero + f.corner;
    *four_at(im + i) = f.pair ? f.damping * at : at;
  }
}

/// side *= value * scale.
BODESMITH_CLONES void multiply_by(const double* value_re, const double* value_im, double scale, std::size_t n,
                                  double* side_re, double* side_im) {
  for (std::size_t i = 0; i < n; i += 4) {
    const ComplexFour value = four_at(value_re + i, value_im + i) * scale;
    put(four_at(side_re + i, side_im + i) * value, side_re + i, side_im + i);
  }
}

/// Derivatives of ln value by the root's numbers: re and im of the first, then of the second.
BODESMITH_CLONES void slopes_of(const RootFactor& f, const double* w, const double* value_re,
                                const double* value_im, std::size_t n, double* const* to) {
  const double by_corner = f.pair ? 2.0 * f.corner * f.corner : f.corner;
  for (std::size_t i = 0; i < n; i += 4) {
    const ComplexFour one_over = inverse(four_at(value_re + i, value_im + i));
    if (!f.pair) {
      *four_at(to[0] + i) = f.sign * (by_corner * one_over.re - f.slope[0]);
      *four_at(to[1] + i) = f.sign * (by_corner * one_over.im);
      continue;
    }
    const Four at = *four_at(w + i);
    const Four zeta_re = -f.damping * at * one_over.im, zeta_im = f.damping * at * one_over.re;
    *four_at(to[0] + i) = f.sign * (zeta_re + by_corner * one_over.re - f.slope[0]);
    *four_at(to[1] + i) = f.sign * (zeta_im + by_corner * one_over.im);
    *four_at(to[2] + i) = f.sign * (zeta_re - f.slope[1]);
    *four_at(to[3] + i) = f.sign * zeta_im;
  }
}

/// above/below, through the norm: every factor is about 1 at the reference.
BODESMITH_CLONES void divide_by(const double* below_re, const double* below_im, std::size_t n, double* re,
                                double* im) {
  for (std::size_t i = 0; i < n; i += 4) {
    const Four a = *four_at(re + i), b = *four_at(im + i);
    const Four c = *four_at(below_re + i), d = *four_at(below_im + i);
    const Four scale = 1.0 / (c * c + d * d);
    *four_at(re + i) = (a * c + b * d) * scale;
    *four_at(im + i) = (b * c - a * d) * scale;
  }
}

}  // namespace

RootResponse::RootResponse(const RootModel& model, const Eigen::VectorXd& theta) : log_gain_(theta(0)) {
  const double w = model.reference.value;
  Index at = 1;
  for (const bool zero : {true, false}) {
    const double sign = zero ? 1.0 : -1.0;
    for (int i = 0; i < (zero ? model.real_zeros : model.real_poles); ++i, ++at) {
      Root root{};
      root.pair = false;
      root.sign = sign;
      root.corner = std::exp(theta(at));
      const Complex value(root.corner, w);
      root.reference_square = std::norm(value);
      root.reference_scale = 1.0 / std::abs(value);
      root.reference_slope[0] = root.corner / value;
      roots_.push_back(root);
    }
    for (int i = 0; i < (zero ? model.zero_pairs : model.pole_pairs); ++i, at += 2) {
      Root root{};
      root.pair = true;
      root.sign = sign;
      root.corner = std::exp(theta(at));
      root.damping = 2.0 * std::exp(theta(at + 1)) * root.corner;
      const Complex value((root.corner - w) * (root.corner + w), root.damping * w);
      root.reference_square = std::norm(value);
      root.reference_scale = 1.0 / std::abs(value);
      root.reference_slope[1] = Complex(0.0, root.damping * w) / value;
      root.reference_slope[0] = root.reference_slope[1] + 2.0 * root.corner * root.corner / value;
      roots_.push_back(root);
    }
  }
}

Complex RootResponse::Root::value(RadPerSecond w) const {
  return pair ? Complex((corner - w.value) * (corner + w.value), damping * w.value)
              : Complex(corner, w.value);
}

Index RootResponse::Root::add_slope(RadPerSecond w, Complex value, Index place,
                                    Eigen::RowVectorXcd& slope) const {
  // 1/value through its norm: the general complex division guards against what cannot happen here.
  const Complex inverse = std::conj(value) / std::norm(value);
  if (!pair) {
    slope(place) = sign * (corner * inverse - reference_slope[0].real());
    return place + 1;
  }
  const Complex by_zeta(-damping * w.value * inverse.imag(), damping * w.value * inverse.real());
  slope(place) = sign * (by_zeta + 2.0 * corner * corner * inverse - reference_slope[0].real());
  slope(place + 1) = sign * (by_zeta - reference_slope[1].real());
  return place + 2;
}

void RootResponse::values(const std::vector<RadPerSecond>& w, Eigen::VectorXcd& h,
                          Eigen::MatrixXcd* slope) const {
  const std::size_t count = w.size(), n = (count + 3) / 4 * 4;
  const std::size_t columns = slope == nullptr ? 0 : std_index(slope->cols()) - 1;
  // One piece of memory: w, a value, both sides, then the slopes.
  std::vector<double> room((7 + 2 * columns) * n, 0.0);
  double* const at = room.data();
  for (std::size_t i = 0; i < n; ++i) at[i] = i < count ? w[i].value : 1.0;
  double *const re = at + n, *const im = re + n, *const above_re = im + n, *const above_im = above_re + n,
                *const below_re = above_im + n, *const below_im = below_re + n;
  std::fill_n(above_re, n, std::exp(log_gain_));
  std::fill_n(below_re, n, 1.0);
  double* column = below_im + n;
  for (const Root& root : roots_) {
    const RootFactor factor{root.corner,
                            root.damping,
                            root.reference_scale,
                            root.sign,
                            {root.reference_slope[0].real(), root.reference_slope[1].real()},
                            root.pair};
    factor_at(factor, at, n, re, im);
    multiply_by(re, im, factor.scale, n, root.sign > 0.0 ? above_re : below_re,
                root.sign > 0.0 ? above_im : below_im);
    if (slope == nullptr) continue;
    double* const to[] = {column, column + n, column + 2 * n, column + 3 * n};
    slopes_of(factor, at, re, im, n, to);
    column += (root.pair ? 4 : 2) * n;
  }
  divide_by(below_re, below_im, n, above_re, above_im);
  h.resize(eigen_index(count));
  for (std::size_t i = 0; i < count; ++i) h(eigen_index(i)) = {above_re[i], above_im[i]};
  if (slope == nullptr) return;
  slope->resize(eigen_index(count), eigen_index(columns) + 1);
  slope->col(0).setOnes();
  const double* from = below_im + n;
  for (std::size_t j = 0; j < columns; ++j, from += 2 * n) {
    for (std::size_t i = 0; i < count; ++i)
      (*slope)(eigen_index(i), eigen_index(j) + 1) = {from[i], from[n + i]};
  }
}

Complex RootResponse::at(RadPerSecond w, Eigen::RowVectorXcd* slope, bool phase) const {
  double log_size = 0.0;
  double product = 1.0;
  double angle = 0.0;
  Index place = 1;
  if (slope != nullptr) (*slope)(0) = 1.0;
  for (const Root& root : roots_) {
    const Complex value = root.value(w);
    const double ratio = std::norm(value) / root.reference_square;
    product *= root.sign > 0.0 ? ratio : 1.0 / ratio;
    // One logarithm for all factors, unless they threaten to overflow.
    if (!(product > 1e-100 && product < 1e100)) {
      log_size += 0.5 * std::log(product);
      product = 1.0;
    }
    if (phase) angle += root.sign * std::atan2(value.imag(), value.real());
    if (slope != nullptr) place = root.add_slope(w, value, place, *slope);
  }
  return {log_gain_ + log_size + 0.5 * std::log(product), angle};
}

void RootResponse::levels(const std::vector<RadPerSecond>& w, Eigen::VectorXd& log_gain,
                          Eigen::MatrixXd* slope) const {
  const Index n = eigen_index(w.size());
  Eigen::ArrayXd square(n);
  for (Index i = 0; i < n; ++i) square(i) = w[std_index(i)].value * w[std_index(i)].value;
  // |H|^2 as one quotient: no root's factor leaves (w/reference)^4 or its inverse, so a dozen of them stay in range.
  Eigen::ArrayXd top = Eigen::ArrayXd::Ones(n);
  Eigen::ArrayXd bottom = Eigen::ArrayXd::Ones(n);
  Eigen::ArrayXd norm(n), share(n);
  Index place = 1;
  if (slope != nullptr) slope->col(0).setOnes();
  for (const Root& root : roots_) {
    const double corner2 = root.corner * root.corner;
    if (root.pair) {
      share = corner2 - square;
      norm = share * share + root.damping * root.damping * square;
    } else {
      norm = corner2 + square;
    }
    (root.sign > 0.0 ? top : bottom) *= norm * (1.0 / root.reference_square);
    if (slope == nullptr) continue;
    if (root.pair) {
      const auto by_zeta = root.damping * root.damping * square / norm;
      slope->col(place) =
          root.sign * (by_zeta + 2.0 * corner2 * share / norm - root.reference_slope[0].real()).matrix();
      slope->col(place + 1) = root.sign * (by_zeta - root.reference_slope[1].real()).matrix();
      place += 2;
    } else {
      slope->col(place++) = root.sign * (corner2 / norm - root.reference_slope[0].real()).matrix();
    }
  }
  log_gain = (log_gain_ + 0.5 * (top / bottom).log()).matrix();
}

Complex RootModel::log_response(const Eigen::VectorXd& theta, RadPerSecond w,
                                Eigen::RowVectorXcd* slope) const {
  if (slope != nullptr) slope->resize(size());
  return RootResponse(*this, theta).at(w, slope, true);
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

LinearLimits trust_region_limits(const RootModel& model, const RootLimits& limits,
                                 const Eigen::VectorXd& theta, double radius) {
  const double low = std::log(limits.low.value);
  const double high = std::log(limits.high.value);
  const double min_log_damping = std::log(limits.min_damping);
  // Two rows a real root, four a pair, two a number.
  const Index roots = model.real_zeros + model.real_poles;
  const Index pairs = model.zero_pairs + model.pole_pairs;
  const Index n = theta.size();
  LinearLimits out{Eigen::MatrixXd::Zero(2 * roots + 4 * pairs + 2 * n, n),
                   Eigen::VectorXd::Ones(2 * roots + 4 * pairs + 2 * n)};
  Index row = 0;
  const auto add = [&](Index at, double factor, double room) {
    out.a(row, at) = factor;
    out.b(row++) = std::max(0.0, room) / radius;
  };
  const auto add_two = [&](Index at, double first, double second, double room) {
    out.a(row, at + 1) = second;
    add(at, first, room);
  };
  Index at = 1;
  for (const bool zero : {true, false}) {
    for (int i = 0; i < (zero ? model.real_zeros : model.real_poles); ++i, ++at) {
      add(at, 1.0, high - theta(at));
      add(at, -1.0, theta(at) - low);
    }
    for (int i = 0; i < (zero ? model.zero_pairs : model.pole_pairs); ++i, at += 2) {
      add(at + 1, -1.0, theta(at + 1) - min_log_damping);
      add(at + 1, 1.0, std::log(kMaxDamping) - theta(at + 1));
      // d ln(larger root)/d ln zeta = zeta / sqrt(zeta^2 - 1): infinite where the pair parts; a bounded slope
      // there.
      const double zeta = std::exp(theta(at + 1));
      const double bend = zeta <= 1.0 ? 0.0 : std::min(3.0, zeta / std::sqrt((zeta - 1.0) * (zeta + 1.0)));
      add_two(at, 1.0, bend, high - log_of_larger_root(theta(at), theta(at + 1)));
      add_two(at, -1.0, bend, log_of_smaller_root(theta(at), theta(at + 1)) - low);
    }
  }
  for (Index i = 0; i < n; ++i) {
    out.a(row++, i) = 1.0;
    out.a(row++, i) = -1.0;
  }
  return out;
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
      theta(at + 1) = std::clamp(theta(at + 1), std::log(limits.min_damping), std::log(kMaxDamping));
      if (log_of_larger_root(theta(at), theta(at + 1)) > high ||
          log_of_smaller_root(theta(at), theta(at + 1)) < low) {
        const double spread = std::min(high - theta(at), theta(at) - low);  // ln of larger root over w0
        theta(at + 1) = std::log(std::cosh(std::max(0.0, spread)));
      }
    }
  }
}

}  // namespace bodesmith
