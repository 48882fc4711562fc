#include "simulate/record/exact_propagator.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "count_allocations.hpp"

namespace bodesmith::simulate {
namespace {

constexpr double kPi = std::numbers::pi;

/// Eight real pole-zero pairs between 2 and 100 Hz, as in the seed.
Sections eight_poles() {
  const double zeros[] = {48.79, 14.8, 107.6, 63.68, 380.2, 221.6, 400.0, 365.6};
  const double poles[] = {47.49, 13.99, 126.4, 102.2, 214.9, 124.8, 625.1, 589.4};
  Sections s;
  s.gain = 0.918 * 1.885 * 0.318 * 2.628;
  for (int i = 0; i < 8; ++i) s.sections.push_back({1.0, {-zeros[i]}, {-poles[i]}});
  return s;
}

/// Switched cubics on a triangle of frequency f: one segment a half period.
std::vector<ExactPropagator::Segment> switched_cubic(double f, double seconds) {
  std::vector<ExactPropagator::Segment> out;
  const int halves = static_cast<int>(std::lround(2.0 * f * seconds));
  for (int i = 0; i < halves; ++i) {
    ExactPropagator::Segment s;
    s.begin = i / (2.0 * f);
    s.end = (i + 1) / (2.0 * f);
    s.degree = 3;
    if (i % 2 == 0) {
      s.coefficients[1] = 0.3546, s.coefficients[2] = -0.6433, s.coefficients[3] = 0.2887;
    } else {  // x = 1 - s
      const double a = -0.2398, b = 0.0838, c = 0.156;
      s.coefficients[0] = a + b + c;
      s.coefficients[1] = -a - 2.0 * b - 3.0 * c;
      s.coefficients[2] = b + 3.0 * c;
      s.coefficients[3] = -c;
    }
    out.push_back(s);
  }
  return out;
}

/// The same by long double Runge-Kutta of order 4 on the cascade of first-order sections.
std::vector<long double> by_runge_kutta(const Sections& sections,
                                        const std::vector<ExactPropagator::Segment>& segments, int parts) {
  using Real = long double;
  const std::size_t n = sections.sections.size();
  std::vector<Real> x(n, 0.0L);
  const auto rates = [&](Real u, const std::vector<Real>& state, std::vector<Real>& out) {
    for (std::size_t i = 0; i < n; ++i) {
      const Real p = -static_cast<Real>(sections.sections[i].poles[0].real());
      const Real z = -static_cast<Real>(sections.sections[i].zeros[0].real());
      out[i] = u - p * state[i];
      u = u + (z - p) * state[i];
    }
    return u * static_cast<Real>(sections.gain);
  };
  std::vector<long double> ends;
  std::vector<Real> k1(n), k2(n), k3(n), k4(n), y(n);
  for (const auto& s : segments) {
    const auto input = [&](Real part) {
      Real v = 0.0L;
      for (int m = s.degree; m >= 0; --m) v = v * part + static_cast<Real>(s.coefficients[m]);
      return v;
    };
    const Real h = (static_cast<Real>(s.end) - static_cast<Real>(s.begin)) / parts;
    for (int i = 0; i < parts; ++i) {
      const Real a = static_cast<Real>(i) / parts, b = (static_cast<Real>(i) + 0.5L) / parts,
                 c = static_cast<Real>(i + 1) / parts;
      rates(input(a), x, k1);
      for (std::size_t j = 0; j < n; ++j) y[j] = x[j] + 0.5L * h * k1[j];
      rates(input(b), y, k2);
      for (std::size_t j = 0; j < n; ++j) y[j] = x[j] + 0.5L * h * k2[j];
      rates(input(b), y, k3);
      for (std::size_t j = 0; j < n; ++j) y[j] = x[j] + h * k3[j];
      rates(input(c), y, k4);
      for (std::size_t j = 0; j < n; ++j) x[j] += h / 6.0L * (k1[j] + 2.0L * k2[j] + 2.0L * k3[j] + k4[j]);
    }
    ends.push_back(rates(input(1.0L), x, k1));
  }
  return ends;
}

TEST(ExactPropagator, SwitchedCubicThroughEightPolesAgainstLongDouble) {
  const auto segments = switched_cubic(100.0, 0.2);
  const ModalSystem modes = ModalSystem::from(state_space(eight_poles()));
  EXPECT_LT(modes.condition, 1e3);
  ExactPropagator exact(modes, 1e-5);
  std::vector<double> y(20001);
  EXPECT_EQ(exact.run(segments, 0.0, y), y.size());
  const auto ends = by_runge_kutta(eight_poles(), segments, 2000);
  for (std::size_t i = 0; i < ends.size(); ++i)
    EXPECT_NEAR(y[(i + 1) * 500], static_cast<double>(ends[i]), 2e-13) << i;
}

TEST(ExactPropagator, OutputDoesNotDependOnHowItIsSampled) {
  const auto segments = switched_cubic(7.0, 2.0);
  ExactPropagator fine(ModalSystem::from(state_space(eight_poles())), 1e-4);
  ExactPropagator coarse(ModalSystem::from(state_space(eight_poles())), 0.13);
  std::vector<double> a(20001), b(16);
  const std::size_t na = fine.run(segments, 0.0, a);
  EXPECT_EQ(na, 20001u);
  const std::size_t nb = coarse.run(segments, 0.0, b);
  ASSERT_EQ(nb, 16u);
  for (std::size_t i = 0; i < nb; ++i) EXPECT_NEAR(b[i], a[i * 1300], 1e-13);
}

TEST(ExactPropagator, SlowAndFastModesKeepTheirDigits) {
  // Poles from 1e-6 to 1e6 rad/s under a cubic: neither cancellation nor overflow. Closed form for one pole,
  // in long double by quadrature-free series: x' = -p x + p u with u = s^3 over [0, T].
  for (const double p : {1e-6, 1e-3, 1.0, 299.0, 301.0, 1e4, 1e6}) {
    Sections one;
    one.sections.push_back({p, {}, {-p}});
    ExactPropagator exact(ModalSystem::from(state_space(one)), 5e-3);
    ExactPropagator::Segment s;
    s.end = 5e-3;
    s.degree = 3;
    s.coefficients[3] = 1.0;
    std::vector<double> y(2);
    exact.run(std::span(&s, 1), 0.0, y);
    // x(T) = q int_0^1 e^{-q(1-s)} s^3 ds, closed or by Simpson's rule.
    const long double q = static_cast<long double>(p) * 5e-3L;
    long double wanted_long = 0.0L;
    if (q > 2.0L) {
      wanted_long = 1.0L - 3.0L / q + 6.0L / (q * q) - 6.0L / (q * q * q) * (1.0L - expl(-q));
    } else {
      const int parts = 4000;
      for (int i = 0; i <= parts; ++i) {
        const long double t = static_cast<long double>(i) / parts;
        wanted_long += (i == 0 || i == parts ? 1.0L
                        : i % 2 == 1         ? 4.0L
                                             : 2.0L) *
                       expl(-q * (1.0L - t)) * t * t * t;
      }
      wanted_long *= q / (3.0L * parts);
    }
    const double wanted = static_cast<double>(wanted_long);
    EXPECT_NEAR(y[1], wanted, 4e-15 * std::max(1.0, wanted) + 1e-14 * wanted) << p;
  }
}

TEST(ExactPropagator, ComplexModes) {
  Sections s;
  const double w = 2.0 * kPi * 50.0, zeta = 0.05;
  s.sections.push_back(
      {w * w,
       {},
       {{-zeta * w, w * std::sqrt(1 - zeta * zeta)}, {-zeta * w, -w * std::sqrt(1 - zeta * zeta)}}});
  ExactPropagator exact(ModalSystem::from(state_space(s)), 1e-3);
  ExactPropagator::Segment step;
  step.end = 0.3;
  step.coefficients[0] = 1.0;
  std::vector<double> y(301);
  exact.run(std::span(&step, 1), 0.0, y);
  const double wd = w * std::sqrt(1 - zeta * zeta);
  for (int i = 0; i <= 300; ++i) {
    const double t = 1e-3 * i;
    EXPECT_NEAR(y[static_cast<std::size_t>(i)],
                1.0 - std::exp(-zeta * w * t) *
                          (std::cos(wd * t) + zeta / std::sqrt(1 - zeta * zeta) * std::sin(wd * t)),
                1e-13);
  }
  exact.rest_under(2.0);
  step.coefficients[0] = 2.0;
  exact.run(std::span(&step, 1), 0.0, y);
  for (const double v : y) EXPECT_NEAR(v, 2.0, 1e-13);
}

TEST(ExactPropagator, EqualPolesAreRefusedByTheirCondition) {
  Sections twice;
  twice.sections = {{10.0, {}, {-10.0}}, {10.0, {}, {-10.0}}};
  EXPECT_GT(ModalSystem::from(state_space(twice)).condition, ModalSystem::kMaxCondition);
}

TEST(ExactPropagator, RunningAllocatesNothing) {
  const auto segments = switched_cubic(100.0, 0.5);
  ExactPropagator exact(ModalSystem::from(state_space(eight_poles())), 1e-5);
  std::vector<double> y(50001);
  const long before = allocations;
  exact.run(segments, 0.0, y);
  exact.rest_under(0.0);
  exact.run(segments, 0.0, y);
  EXPECT_EQ(allocations, before);
}

}  // namespace
}  // namespace bodesmith::simulate
