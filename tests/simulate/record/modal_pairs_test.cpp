// A system in its modes is the same system: its equations are those of the states, its response the sum of the modes.
#include "simulate/record/modal_pairs.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <random>

#include "numeric/index.hpp"
#include "numeric/linear_algebra/dense.hpp"

namespace bodesmith::simulate {
namespace {

/// Real modes and conjugate pairs, mixed by a transform drawn at random.
StateSpace mixed(const std::vector<double>& real, const std::vector<Complex>& pairs, unsigned seed) {
  const std::size_t n = real.size() + 2 * pairs.size();
  const Eigen::Index size = eigen_index(n);
  Eigen::MatrixXd modes = Eigen::MatrixXd::Zero(size, size);
  for (std::size_t i = 0; i < real.size(); ++i) modes(eigen_index(i), eigen_index(i)) = real[i];
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const Eigen::Index at = eigen_index(real.size() + 2 * k);
    modes.block<2, 2>(at, at) << pairs[k].real(), -pairs[k].imag(), pairs[k].imag(), pairs[k].real();
  }
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  const auto draw = [&](double) { return normal(random); };
  const Eigen::MatrixXd mix =
      Eigen::MatrixXd::Identity(size, size) + 0.2 * Eigen::MatrixXd::Zero(size, size).unaryExpr(draw);
  const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> a =
      times(times(mix, modes), inverse(mix));
  StateSpace out;
  out.a.assign(a.data(), a.data() + n * n);
  for (std::size_t i = 0; i < n; ++i) {
    out.b.push_back(normal(random));
    out.c.push_back(normal(random));
    out.constant.push_back(normal(random));
  }
  out.d = 0.3;
  return out;
}

Complex response(const StateSpace& system, double w) {
  const Eigen::Index n = eigen_index(system.order());
  Eigen::MatrixXcd m =
      -Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
           system.a.data(), n, n)
           .cast<Complex>();
  m.diagonal().array() += Complex(0.0, w);
  const Eigen::VectorXcd x =
      solve_lu(m, Eigen::Map<const Eigen::VectorXd>(system.b.data(), n).cast<Complex>());
  Complex out = system.d;
  for (Eigen::Index i = 0; i < n; ++i) out += system.c[std_index(i)] * x(i);
  return out;
}

const std::vector<std::pair<std::vector<double>, std::vector<Complex>>> kModes = {
    {{-3.0}, {}},
    {{-3.0, -50.0}, {}},
    {{}, {{-2.0, 40.0}}},
    {{-3.0}, {{-2.0, 40.0}}},
    {{-3.0, -20.0, -70.0}, {{-2.0, 40.0}, {-9.0, 11.0}}},
    {{-1.0, -5.0}, {{-8.0, 100.0}}}};

TEST(ModalPairs, ObeyTheEquationsOfTheStates) {
  unsigned seed = 0;
  for (const auto& [real, pairs] : kModes) {
    const StateSpace system = mixed(real, pairs, ++seed);
    const std::size_t n = system.order();
    const auto modal = modal_pairs(system);
    ASSERT_TRUE(modal);
    const std::size_t states = modal->b.size();
    ASSERT_EQ(states, n + real.size() % 2);
    EXPECT_EQ(modal->pairs(), states / 2);
    EXPECT_EQ(modal->coupled, !pairs.empty());
    double slowest = 1e9;
    for (const double p : real) slowest = std::min(slowest, -p);
    for (const Complex p : pairs) slowest = std::min(slowest, -p.real());
    EXPECT_NEAR(modal->slowest_rad_s, slowest, 1e-9 * slowest);
    // Of any states x and input u: T (A x + b u + constant) = blocks (T x) + b u + constant, c the same output.
    std::vector<double> x, dx(n, 0.0), w(states), dw(states);
    for (std::size_t i = 0; i < n; ++i) x.push_back(std::sin(1.0 + 2.0 * static_cast<double>(i)));
    constexpr double kInput = 0.7;
    for (std::size_t i = 0; i < n; ++i) {
      dx[i] = system.b[i] * kInput + system.constant[i];
      for (std::size_t j = 0; j < n; ++j) dx[i] += system.a[i * n + j] * x[j];
    }
    modal->to_modes(x.data(), w.data());
    modal->to_modes(dx.data(), dw.data());
    double y = 0.0, own = 0.0;
    for (std::size_t i = 0; i < n; ++i) y += system.c[i] * x[i];
    for (std::size_t i = 0; i < states; ++i) {
      const std::size_t first = i - i % 2;
      double wanted = modal->b[i] * kInput + modal->constant[i];
      for (std::size_t j = 0; j < 2; ++j) wanted += modal->blocks[2 * i + j] * w[first + j];
      EXPECT_NEAR(dw[i], wanted, 1e-9 * (1.0 + std::abs(wanted))) << i;
      own += modal->c[i] * w[i];
    }
    EXPECT_NEAR(own, y, 1e-9);
  }
  EXPECT_FALSE(modal_pairs(mixed({1.0, -2.0}, {}, 1))) << "it grows";
  EXPECT_FALSE(modal_pairs(StateSpace{}));
}

TEST(ModalSystem, ItsModesAddUpToTheResponse) {
  unsigned seed = 10;
  for (const auto& [real, pairs] : kModes) {
    const StateSpace system = mixed(real, pairs, ++seed);
    const ModalSystem modes = ModalSystem::from(system);
    ASSERT_EQ(modes.poles.size(), real.size() + pairs.size());
    double size = std::abs(modes.direct);
    for (std::size_t k = 0; k < modes.poles.size(); ++k)
      size += (modes.poles[k].imag() > 0.0 ? 2.0 : 1.0) * std::abs(modes.residues[k] / modes.poles[k]);
    double most = std::abs(response(system, 0.0));
    for (const Complex p : modes.poles) most = std::max(most, std::abs(response(system, std::abs(p))));
    EXPECT_NEAR(modes.condition, size / most, 1e-9 * modes.condition);
    EXPECT_GE(modes.condition, 0.3);
    for (const double w : {0.0, 1.0, 12.0, 39.0, 300.0}) {
      Complex sum = modes.direct;
      for (std::size_t k = 0; k < modes.poles.size(); ++k) {
        sum += modes.residues[k] / (Complex(0.0, w) - modes.poles[k]);
        if (modes.poles[k].imag() > 0.0)
          sum += std::conj(modes.residues[k]) / (Complex(0.0, w) - std::conj(modes.poles[k]));
      }
      EXPECT_LT(std::abs(sum - response(system, w)), 1e-9) << w;
    }
    const auto pair = modal_pairs(system);
    ASSERT_TRUE(pair);
    EXPECT_NEAR(pair->condition, modes.condition, 1e-6 * modes.condition);
  }
}

}  // namespace
}  // namespace bodesmith::simulate
