#include "numeric/least_squares.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bodesmith {

NnlsResult nnls(const Eigen::MatrixXd& gram, const Eigen::VectorXd& rhs, const std::vector<bool>& free_sign,
                double tolerance) {
  const Eigen::Index n = rhs.size();
  NnlsResult out;
  // Columns scaled to unit length: the tolerance then means the same for all.
  Eigen::VectorXd scale(n);
  for (Eigen::Index i = 0; i < n; ++i) scale(i) = gram(i, i) > 0.0 ? 1.0 / std::sqrt(gram(i, i)) : 0.0;
  const Eigen::MatrixXd g = scale.asDiagonal() * gram * scale.asDiagonal();
  const Eigen::VectorXd c = scale.asDiagonal() * rhs;
  const double limit = tolerance * std::max(c.cwiseAbs().maxCoeff(), std::numeric_limits<double>::min());

  std::vector<bool> passive(static_cast<std::size_t>(n), false);
  const auto is_free = [&](Eigen::Index i) {
    return !free_sign.empty() && free_sign[static_cast<std::size_t>(i)];
  };
  for (Eigen::Index i = 0; i < n; ++i) passive[static_cast<std::size_t>(i)] = is_free(i) && scale(i) > 0.0;
  Eigen::VectorXd x = Eigen::VectorXd::Zero(n);

  const auto solve_passive = [&](Eigen::VectorXd& z) {
    std::vector<Eigen::Index> index;
    for (Eigen::Index i = 0; i < n; ++i)
      if (passive[static_cast<std::size_t>(i)]) index.push_back(i);
    z = Eigen::VectorXd::Zero(n);
    if (index.empty()) return;
    const auto m = static_cast<Eigen::Index>(index.size());
    Eigen::MatrixXd sub(m, m);
    Eigen::VectorXd part(m);
    for (Eigen::Index a = 0; a < m; ++a) {
      part(a) = c(index[static_cast<std::size_t>(a)]);
      for (Eigen::Index b = 0; b < m; ++b)
        sub(a, b) = g(index[static_cast<std::size_t>(a)], index[static_cast<std::size_t>(b)]);
      sub(a, a) += 1e-14;  // two equal columns share the weight instead of making it infinite
    }
    const Eigen::VectorXd solved = sub.ldlt().solve(part);
    for (Eigen::Index a = 0; a < m; ++a) z(index[static_cast<std::size_t>(a)]) = solved(a);
  };

  Eigen::VectorXd z;
  solve_passive(x);
  for (Eigen::Index exchange = 0; exchange < 3 * n + 10; ++exchange) {
    const Eigen::VectorXd gradient = c - g * x;
    Eigen::Index entering = -1;
    double best = limit;
    for (Eigen::Index i = 0; i < n; ++i) {
      if (!passive[static_cast<std::size_t>(i)] && scale(i) > 0.0 && !is_free(i) && gradient(i) > best) {
        best = gradient(i);
        entering = i;
      }
    }
    if (entering < 0) {
      out.x = scale.asDiagonal() * x;
      return out;
    }
    passive[static_cast<std::size_t>(entering)] = true;
    for (;;) {
      solve_passive(z);
      double alpha = 1.0;
      Eigen::Index leaving = -1;
      for (Eigen::Index i = 0; i < n; ++i) {
        if (passive[static_cast<std::size_t>(i)] && !is_free(i) && z(i) <= 0.0) {
          const double way = x(i) - z(i);
          const double ratio = way > 0.0 ? x(i) / way : 0.0;
          if (leaving < 0 || ratio < alpha) {
            alpha = ratio;
            leaving = i;
          }
        }
      }
      if (leaving < 0) break;
      x += alpha * (z - x);
      x(leaving) = 0.0;
      passive[static_cast<std::size_t>(leaving)] = false;
    }
    x = z;
  }
  out.x = scale.asDiagonal() * x;
  out.converged = false;
  return out;
}

Eigen::VectorXd parameter_deviation(const Eigen::MatrixXd& gram, const Eigen::VectorXd& residual) {
  const Eigen::Index n = gram.rows();
  const Eigen::Index samples = residual.size();
  const double infinite = std::numeric_limits<double>::infinity();
  if (samples <= n + 1) return Eigen::VectorXd::Constant(n, infinite);
  const double mean = residual.mean();
  double around = 0.0;
  double neighbour = 0.0;
  for (Eigen::Index i = 0; i < samples; ++i) {
    around += (residual(i) - mean) * (residual(i) - mean);
    if (i > 0) neighbour += (residual(i) - mean) * (residual(i - 1) - mean);
  }
  const double correlation = around > 0.0 ? std::clamp(neighbour / around, 0.0, 0.999) : 0.0;
  const double variance =
      residual.squaredNorm() / static_cast<double>(samples - n) * (1.0 + correlation) / (1.0 - correlation);
  Eigen::VectorXd scale(n);
  for (Eigen::Index i = 0; i < n; ++i) scale(i) = gram(i, i) > 0.0 ? 1.0 / std::sqrt(gram(i, i)) : 0.0;
  const Eigen::MatrixXd scaled = scale.asDiagonal() * gram * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled);
  Eigen::VectorXd out(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    double sum = scale(i) > 0.0 ? 0.0 : infinite;
    for (Eigen::Index k = 0; k < n && std::isfinite(sum); ++k) {
      const double part = eigen.eigenvectors()(i, k) * eigen.eigenvectors()(i, k);
      if (eigen.eigenvalues()(k) <= 1e-13) {
        if (part > 1e-6) sum = infinite;
      } else {
        sum += part / eigen.eigenvalues()(k);
      }
    }
    out(i) = scale(i) * std::sqrt(variance * sum);
    if (!(scale(i) > 0.0)) out(i) = infinite;
  }
  return out;
}

LeastSquaresResult least_squares(const std::function<void(const Eigen::VectorXd&, Eigen::VectorXd&)>& f,
                                 const Eigen::VectorXd& start, const Eigen::VectorXd& lower,
                                 const Eigen::VectorXd& upper, const Eigen::VectorXd& typical,
                                 int iterations) {
  const Eigen::Index n = start.size();
  LeastSquaresResult out;
  out.x = start.cwiseMax(lower).cwiseMin(upper);
  Eigen::VectorXd residual;
  f(out.x, residual);
  out.evaluations = 1;
  out.cost = residual.squaredNorm();
  Eigen::MatrixXd jacobian(residual.size(), n);
  Eigen::VectorXd moved;
  Eigen::MatrixXd gram;
  double damping = 1e-3;
  for (int iteration = 0; iteration < iterations; ++iteration) {
    for (Eigen::Index i = 0; i < n; ++i) {
      double h = 1e-6 * std::max(std::abs(out.x(i)), std::abs(typical(i)));
      if (out.x(i) + h > upper(i)) h = -h;
      Eigen::VectorXd at = out.x;
      at(i) += h;
      f(at, moved);
      ++out.evaluations;
      jacobian.col(i) = (moved - residual) / (at(i) - out.x(i));
    }
    gram = jacobian.transpose() * jacobian;
    const Eigen::VectorXd gradient = jacobian.transpose() * residual;
    // Parameters pressed against a bound stay there in this step.
    std::vector<Eigen::Index> open;
    for (Eigen::Index i = 0; i < n; ++i) {
      const bool pressed =
          (out.x(i) <= lower(i) && gradient(i) > 0.0) || (out.x(i) >= upper(i) && gradient(i) < 0.0);
      if (!pressed && gram(i, i) > 0.0) open.push_back(i);
    }
    if (open.empty()) {
      out.converged = true;
      break;
    }
    const auto m = static_cast<Eigen::Index>(open.size());
    bool better = false;
    double gain = 0.0;
    for (int attempt = 0; attempt < 12 && !better; ++attempt) {
      Eigen::MatrixXd system(m, m);
      Eigen::VectorXd part(m);
      for (Eigen::Index a = 0; a < m; ++a) {
        for (Eigen::Index b = 0; b < m; ++b)
          system(a, b) = gram(open[static_cast<std::size_t>(a)], open[static_cast<std::size_t>(b)]);
        system(a, a) *= 1.0 + damping;
        part(a) = -gradient(open[static_cast<std::size_t>(a)]);
      }
      const Eigen::VectorXd step = system.ldlt().solve(part);
      Eigen::VectorXd at = out.x;
      for (Eigen::Index a = 0; a < m; ++a) at(open[static_cast<std::size_t>(a)]) += step(a);
      at = at.cwiseMax(lower).cwiseMin(upper);
      if (!at.allFinite()) {
        damping *= 10.0;
        continue;
      }
      f(at, moved);
      ++out.evaluations;
      const double cost = moved.squaredNorm();
      if (cost < out.cost) {
        gain = (out.cost - cost) / out.cost;
        out.cost = cost;
        out.x = at;
        residual = moved;
        damping = std::max(damping * 0.2, 1e-12);
        better = true;
      } else {
        damping *= 6.0;
      }
    }
    if (!better || gain < 1e-10 || out.cost == 0.0) {
      out.converged = true;
      break;
    }
  }
  out.deviation = gram.size() > 0
                      ? parameter_deviation(gram, residual)
                      : Eigen::VectorXd::Constant(n, std::numeric_limits<double>::infinity()).eval();
  return out;
}

}  // namespace bodesmith
