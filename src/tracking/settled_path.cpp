#include "tracking/settled_path.hpp"

#include <algorithm>

#include "numeric/index.hpp"
#include "numeric/linear_algebra/dense.hpp"
#include "simulate/hold_response.hpp"

namespace bodesmith::tracking {
namespace {

using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// From sample to sample; N: as many states, or any number.
template <int N>
void follow(const StateSpace& system, const simulate::HoldResponse& hold, std::span<const double> u,
            SettledPath& out, double repeat_s) {
  using Vector = Eigen::Matrix<double, N, 1>;
  const Eigen::Index n = eigen_index(system.order());
  const Eigen::Matrix<double, N, N> e = Eigen::Map<const RowMatrix>(hold.e.data(), n, n);
  const RowMatrix g = Eigen::Map<const RowMatrix>(hold.g[0].data(), n, 2);
  const Vector now = g.col(0), ahead = g.col(1);
  Vector state = Vector::Zero(n), next(n);
  const auto move = [&](std::size_t i) {
    next.noalias() = e * state;
    state = next + now * u[i] + ahead * u[i + 1 < u.size() ? i + 1 : 0];
  };
  // What is left of a state after so many samples does not count beside it: the samples before make none of the last one.
  std::size_t from = u.size();
  Eigen::Matrix<double, N, N> left = Eigen::Matrix<double, N, N>::Identity(n, n);
  for (; from > 0 && left.cwiseAbs().sum() > 1e-20; --from) left = left * e;
  for (std::size_t i = from; i < u.size(); ++i) move(i);
  // What a repeat leaves of the states that it began with comes on top.
  state = solve_lu(forgotten(system, repeat_s), Eigen::VectorXd(state));
  std::copy_n(state.data(), out.states.size(), out.states.begin());
  for (std::size_t i = 0; i < u.size(); ++i) {
    out.output[i] = output(system, u[i], state.data());
    move(i);
  }
}

}  // namespace

Eigen::MatrixXd forgotten(const StateSpace& system, double repeat_s) {
  const Eigen::Index n = eigen_index(system.order());
  const Eigen::MatrixXd a = Eigen::Map<const RowMatrix>(system.a.data(), n, n);
  return Eigen::MatrixXd::Identity(n, n) - matrix_exponential(Eigen::MatrixXd(a * repeat_s));
}

SettledPath settled_path(const StateSpace& system, std::span<const double> u, double step_s) {
  SettledPath out{std::vector<double>(system.order()), std::vector<double>(u.size())};
  if (system.order() == 0) {
    for (std::size_t i = 0; i < u.size(); ++i) out.output[i] = output(system, u[i], nullptr);
    return out;
  }
  const double* b = system.b.data();
  simulate::HoldResponse hold;
  simulate::HoldResponseSolver().solve({system.order(), system.a.data(), {&b, 1}}, step_s,
                                       simulate::hold_nodes(1), 1.0, hold);
  const double repeat_s = step_s * static_cast<double>(u.size());
  // A stage has an amplifier's pole, and a damping compensator's and a resonance's.
  if (system.order() == 1)
    follow<1>(system, hold, u, out, repeat_s);
  else if (system.order() == 4)
    follow<4>(system, hold, u, out, repeat_s);
  else
    follow<Eigen::Dynamic>(system, hold, u, out, repeat_s);
  return out;
}

}  // namespace bodesmith::tracking
