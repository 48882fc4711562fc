#include "tracking/settled_path.hpp"

#include <algorithm>

#include "numeric/index.hpp"
#include "numeric/linear_algebra/dense.hpp"
#include "simulate/hold_response.hpp"

namespace bodesmith::tracking {
namespace {

using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

}  // namespace

Eigen::MatrixXd forgotten(const StateSpace& system, double repeat_s) {
  const Eigen::Index n = eigen_index(system.order());
  const Eigen::MatrixXd a = Eigen::Map<const RowMatrix>(system.a.data(), n, n);
  return Eigen::MatrixXd::Identity(n, n) - matrix_exponential(Eigen::MatrixXd(a * repeat_s));
}

SettledPath settled_path(const StateSpace& system, std::span<const double> u, double step_s) {
  SettledPath out{std::vector<double>(system.order()), std::vector<double>(u.size())};
  const Eigen::Index n = eigen_index(system.order());
  Eigen::VectorXd state = Eigen::VectorXd::Zero(n), next(n);
  const auto follow = [&](const auto& move) {
    for (std::size_t i = 0; i < u.size(); ++i) {
      out.output[i] = output(system, u[i], state.data());
      move(u[i], u[(i + 1) % u.size()]);
    }
  };
  if (n == 0) {
    follow([](double, double) {});
    return out;
  }
  const double* b = system.b.data();
  simulate::HoldResponse hold;
  simulate::HoldResponseSolver().solve({system.order(), system.a.data(), {&b, 1}}, step_s,
                                       simulate::hold_nodes(1), 1.0, hold);
  const Eigen::MatrixXd e = Eigen::Map<const RowMatrix>(hold.e.data(), n, n);
  const Eigen::MatrixXd g = Eigen::Map<const RowMatrix>(hold.g[0].data(), n, 2);
  const auto move = [&](double from, double to) {
    next.noalias() = e * state;
    next += g.col(0) * from + g.col(1) * to;
    state.swap(next);
  };
  follow(move);
  // What a repeat leaves of the states that it began with comes on top.
  state = solve_lu(forgotten(system, step_s * static_cast<double>(u.size())), state);
  std::copy_n(state.data(), out.states.size(), out.states.begin());
  follow(move);
  return out;
}

}  // namespace bodesmith::tracking
