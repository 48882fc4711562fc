#include "numeric/preview_tracking.hpp"

#include "numeric/index.hpp"

namespace bodesmith {
namespace {

/// Of a sum over its parts' sizes, after the recursion.
constexpr double kRounding = 1e-12;

double at(const std::vector<double>& v, std::size_t i) {
  return v.empty() ? 0.0 : v[i];
}

}  // namespace

Eigen::VectorXd PreviewSystem::state_after(Eigen::VectorXd z, const std::vector<double>& u,
                                           std::size_t steps) const {
  for (std::size_t i = 0; i < steps; ++i) z = (a_at(i) * z + b_at(i) * u[i + 1]).eval();
  return z;
}

PreviewTracking::PreviewTracking(const PreviewSystem& system, PreviewWeights weights)
    : system_(system), weights_(std::move(weights)) {
  const std::size_t samples = weights_.q.size();
  const Eigen::Index m = system_.a[0].rows();
  const Eigen::Index iu = m - 2;
  Eigen::VectorXd bend = Eigen::VectorXd::Zero(m);
  bend(iu) = -2.0;
  bend(m - 1) = 1.0;
  const auto measured = [&](Eigen::MatrixXd& p, std::size_t i) {
    const Eigen::VectorXd& g = system_.g_at(i);
    p.noalias() += weights_.q[i] * g * g.transpose();
  };
  Eigen::MatrixXd p = Eigen::MatrixXd::Zero(m, m);
  measured(p, samples - 1);
  h_.resize(samples - 1);
  curvature_.resize(samples - 1);
  Eigen::MatrixXd pa(m, m);
  for (std::size_t i = samples - 1; i-- > 0;) {
    const Eigen::MatrixXd& a = system_.a_at(i);
    const Eigen::VectorXd& b = system_.b_at(i);
    pa.noalias() = p * a;
    curvature_[i] = b.dot(p * b) + weights_.curvature + weights_.value + weights_.rate;
    h_[i] = pa.transpose() * b + weights_.curvature * bend;
    h_[i](iu) -= weights_.rate;
    p.noalias() = a.transpose() * pa;
    p.noalias() += weights_.curvature * bend * bend.transpose();
    p(iu, iu) += weights_.rate;
    if (curvature_[i] > 0.0) p.noalias() -= h_[i] * h_[i].transpose() / curvature_[i];
    measured(p, i);
    p = 0.5 * (p + p.transpose()).eval();
  }
  p0_ = p;
}

std::vector<double> PreviewTracking::solve(const PreviewTargets& targets, const Eigen::VectorXd& start,
                                           const Eigen::VectorXd& fixed) const {
  const std::size_t samples = weights_.q.size();
  const Eigen::Index m = p0_.rows();
  const Eigen::Index iu = m - 2;
  std::vector<double> f(samples - 1);
  const auto pull = [&](std::size_t i) { return weights_.q[i] * at(targets.e, i) * system_.g_at(i); };
  Eigen::VectorXd p = pull(samples - 1);
  for (std::size_t i = samples - 1; i-- > 0;) {
    const double d = weights_.curvature * at(targets.d, i);
    const double w = weights_.rate * at(targets.w, i);
    f[i] = system_.b_at(i).dot(p) - d + weights_.value * at(targets.v, i + 1) + w;
    p = system_.a_at(i).transpose() * p;
    p(iu) += 2.0 * d - w;
    p(m - 1) -= d;
    if (curvature_[i] > 0.0) p -= f[i] / curvature_[i] * h_[i];
    p += pull(i);
  }
  Eigen::VectorXd z = fixed;
  if (start.size() > 0) {
    const double size = start.dot(p0_ * start) + weights_.value;
    // Where no constant reaches the output (a high-pass) the first sum is rounding of its parts, and u_0 = 0 as good as any.
    const Eigen::VectorXd sizes = start.cwiseAbs();
    const double rounding = kRounding * sizes.dot(p0_.cwiseAbs() * sizes);
    const double lean = start.dot(p - p0_ * fixed) + weights_.value * at(targets.v, 0);
    if (size > rounding) z += lean / size * start;
  }
  std::vector<double> u{z(iu)};
  u.reserve(samples);
  for (std::size_t i = 0; i + 1 < samples; ++i) {
    const double next = curvature_[i] > 0.0 ? (f[i] - h_[i].dot(z)) / curvature_[i] : z(iu);
    z = (system_.a_at(i) * z + system_.b_at(i) * next).eval();
    u.push_back(next);
  }
  return u;
}

}  // namespace bodesmith
