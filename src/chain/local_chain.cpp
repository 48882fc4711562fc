#include "chain/local_chain.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/progress.hpp"
#include "numeric/index.hpp"
#include "numeric/linear_algebra/dense.hpp"

namespace bodesmith::chain {
namespace {

constexpr std::size_t kWindow = 8000;
constexpr std::size_t kOverlap = 1000;
/// Rounds of the alternating direction method of multipliers.
constexpr int kRounds = 120;

/// `now` and `next`: the signal at both ends of a step, as rows over (z, next input).
struct Rows {
  Eigen::RowVectorXd now;
  Eigen::RowVectorXd next;
};

const SampledSystem& system_at(const std::vector<SampledSystem>& systems, std::size_t i) {
  return systems[std::min(i, systems.size() - 1)];
}

double slope_at(const std::vector<double>& slopes, std::size_t i) {
  return slopes[std::min(i, slopes.size() - 1)];
}

std::vector<double> part(const std::vector<double>& v, std::size_t first, std::size_t count) {
  const auto from = v.begin() + static_cast<std::ptrdiff_t>(first);
  return {from, from + static_cast<std::ptrdiff_t>(count)};
}

/// One window of a goal, its system at hand.
class WindowSearch {
 public:
  WindowSearch(const PreviewSystem& system, const LocalGoal& goal, std::size_t first, std::size_t count,
               double step_s)
      : goal_(goal), first_(first), count_(count), step_s_(step_s), system_(system) {
    targets_.e = part(goal.change, first, count);
    targets_.d.resize(count);
    const std::vector<double>& u = goal.drive;
    for (std::size_t i = 0; i + 1 < count; ++i) {
      const std::size_t k = first + i;
      targets_.d[i] = u[k + 1] - 2.0 * u[k] + u[k > 0 ? k - 1 : 0];
    }
  }

  std::vector<double> run(const Eigen::VectorXd& start, const Eigen::VectorXd& fixed) const {
    const PreviewTracking free(system_, weights(0.0, 0.0));
    std::vector<double> out = free.solve(targets_, start, fixed);
    if (goal_.limits.any() && !goal_.limits.kept(drive_with(out), step_s_)) out = bounded(out, start, fixed);
    return out;
  }

 private:
  PreviewWeights weights(double value, double rate) const {
    const double curvature = goal_.smoothing * goal_.gain;
    return {part(goal_.weight, first_, count_), curvature * curvature, value, rate};
  }
  std::vector<double> drive_with(const std::vector<double>& change) const {
    std::vector<double> u = part(goal_.drive, first_, count_);
    for (std::size_t i = 0; i < count_; ++i) u[i] += change[i];
    return u;
  }
  /// Limits as sets: the drive near its projection onto each of them, which moves until both agree (alternating
  /// directions: Boyd, Parikh, Chu, Peleato, Eckstein, Found. Trends Mach. Learn. 3 (2011) 1, section 5).
  std::vector<double> bounded(std::vector<double> change, const Eigen::VectorXd& start,
                              const Eigen::VectorXd& fixed) const {
    const DriveLimits& limits = goal_.limits;
    const double square = goal_.gain * goal_.gain;
    const double rate_weight = limits.max_rate_per_s ? 1e3 * square : 0.0;
    const double value_weight = limits.lower || limits.upper ? 0.1 * square : 0.0;
    const PreviewTracking held(system_, weights(value_weight, rate_weight));
    const double low = limits.lower.value_or(-INFINITY);
    const double high = limits.upper.value_or(INFINITY);
    const double reach = limits.max_rate_per_s ? *limits.max_rate_per_s * step_s_ : INFINITY;
    std::vector<double> lag_value(count_, 0.0);
    std::vector<double> lag_rate(count_, 0.0);
    PreviewTargets targets = targets_;
    targets.v.resize(count_);
    targets.w.resize(count_);
    for (int round = 0; round < kRounds; ++round) {
      stop_if_interrupted();
      const std::vector<double> u = drive_with(change);
      const double* base = goal_.drive.data() + first_;
      for (std::size_t i = 0; i < count_; ++i) {
        const double near = std::clamp(u[i] + lag_value[i], low, high);
        lag_value[i] += u[i] - near;
        targets.v[i] = near - lag_value[i] - base[i];
        if (i + 1 == count_) break;
        const double move = u[i + 1] - u[i];
        const double slow = std::clamp(move + lag_rate[i], -reach, reach);
        lag_rate[i] += move - slow;
        targets.w[i] = slow - lag_rate[i] - (base[i + 1] - base[i]);
      }
      change = held.solve(targets, start, fixed);
    }
    return change;
  }

  const LocalGoal& goal_;
  std::size_t first_;
  std::size_t count_;
  double step_s_;
  const PreviewSystem& system_;
  PreviewTargets targets_;
};

}  // namespace

SampledSystem sampled(const StateSpace& system, double step_s) {
  const Eigen::Index n = eigen_index(system.order());
  // x' = h (A x + b (u + s t)), u' = s, over t from 0 to 1.
  Eigen::MatrixXd m = Eigen::MatrixXd::Zero(n + 2, n + 2);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) m(i, j) = step_s * system.a[std_index(i * n + j)];
    m(i, n) = step_s * system.b[std_index(i)];
  }
  m(n, n + 1) = 1.0;
  const Eigen::MatrixXd e = matrix_exponential(m);
  SampledSystem out;
  out.phi = e.topLeftCorner(n, n);
  out.to = e.col(n + 1).head(n);
  out.from = e.col(n).head(n) - out.to;
  out.c = as_eigen(system.c);
  out.d = system.d;
  return out;
}

double slowest_gain(const StateSpace& system, double step_s, std::size_t samples) {
  const double rate = 2.0 * std::numbers::pi / (step_s * static_cast<double>(samples));
  return std::max(std::abs(response(system, {0.0, rate})), std::numeric_limits<double>::min());
}

bool DriveLimits::kept(std::span<const double> u, double step_s) const {
  std::vector<double> held(u.begin(), u.end());
  hold(held, step_s);
  for (std::size_t i = 0; i < u.size(); ++i) {
    if (std::abs(held[i] - u[i]) > 1e-12 * std::abs(u[i])) return false;
  }
  return true;
}

void DriveLimits::hold(std::span<double> u, double step_s) const {
  for (double& v : u) v = std::clamp(v, lower.value_or(-INFINITY), upper.value_or(INFINITY));
  if (!max_rate_per_s || u.empty()) return;
  // Half way between the highest slow signal below u and the lowest one above it.
  const double reach = *max_rate_per_s * step_s;
  std::vector<double> below(u.begin(), u.end());
  std::vector<double> above = below;
  for (std::size_t i = 1; i < u.size(); ++i) {
    below[i] = std::min(below[i], below[i - 1] + reach);
    above[i] = std::max(above[i], above[i - 1] - reach);
  }
  for (std::size_t i = u.size() - 1; i-- > 0;) {
    below[i] = std::min(below[i], below[i + 1] + reach);
    above[i] = std::max(above[i], above[i + 1] - reach);
  }
  for (std::size_t i = 0; i < u.size(); ++i) {
    u[i] = 0.5 * (below[i] + above[i]);
    // The last digit of a difference counts, too.
    if (i > 0) u[i] = std::clamp(u[i], u[i - 1] - reach, u[i - 1] + reach);
  }
}

void LocalChain::add(SampledSystem system) {
  elements_.emplace_back(Systems{std::move(system)});
}

void LocalChain::add(std::vector<SampledSystem> one_a_step) {
  elements_.emplace_back(std::move(one_a_step));
}

void LocalChain::add(std::vector<double> slopes) {
  elements_.emplace_back(std::move(slopes));
}

std::size_t LocalChain::order() const {
  std::size_t out = 0;
  for (const Element& element : elements_) {
    if (const auto* systems = std::get_if<Systems>(&element)) out += std_index((*systems)[0].phi.rows());
  }
  return out;
}

bool LocalChain::varies() const {
  return std::ranges::any_of(elements_, [](const Element& element) {
    return std::visit([](const auto& list) { return list.size() > 1; }, element);
  });
}

PreviewSystem LocalChain::system(std::size_t first, std::size_t count) const {
  const Eigen::Index m = eigen_index(order()) + 2;
  PreviewSystem out;
  const std::size_t steps = varies() ? count : 1;
  for (std::size_t i = 0; i < steps; ++i) {
    const std::size_t k = first + i;
    Eigen::MatrixXd step = Eigen::MatrixXd::Zero(m, m + 1);
    Rows signal{Eigen::RowVectorXd::Zero(m + 1), Eigen::RowVectorXd::Zero(m + 1)};
    signal.now(m - 2) = 1.0;
    signal.next(m) = 1.0;
    step.row(m - 2) = signal.next;
    step.row(m - 1) = signal.now;
    Eigen::Index at = 0;
    for (const Element& element : elements_) {
      if (const auto* slopes = std::get_if<std::vector<double>>(&element)) {
        signal.now *= slope_at(*slopes, k);
        signal.next *= slope_at(*slopes, k + 1);
        continue;
      }
      const SampledSystem& s = system_at(std::get<Systems>(element), k);
      const Eigen::Index n = s.phi.rows();
      step.middleRows(at, n) = s.from * signal.now + s.to * signal.next;
      step.block(at, at, n, n) += s.phi;
      signal.now = (s.d * signal.now).eval();
      signal.now.segment(at, n) += s.c.transpose();
      signal.next = (s.c.transpose() * step.middleRows(at, n) + s.d * signal.next).eval();
      at += n;
    }
    out.g.emplace_back(signal.now.head(m).transpose());
    if (i + 1 == steps && steps > 1) break;
    out.a.emplace_back(step.leftCols(m));
    out.b.emplace_back(step.col(m));
  }
  return out;
}

Eigen::VectorXd LocalChain::at_rest() const {
  const Eigen::Index m = eigen_index(order()) + 2;
  Eigen::VectorXd out = Eigen::VectorXd::Zero(m);
  double signal = 1.0;
  Eigen::Index at = 0;
  for (const Element& element : elements_) {
    if (const auto* slopes = std::get_if<std::vector<double>>(&element)) {
      signal *= slopes->front();
      continue;
    }
    const SampledSystem& s = std::get<Systems>(element).front();
    const Eigen::Index n = s.phi.rows();
    const Eigen::MatrixXd left = Eigen::MatrixXd::Identity(n, n) - s.phi;
    const Eigen::VectorXd x = solve_lu(left, (s.from + s.to) * signal);
    out.segment(at, n) = x;
    signal = s.c.dot(x) + s.d * signal;
    at += n;
  }
  out(m - 2) = out(m - 1) = 1.0;
  return out;
}

std::vector<double> LocalChain::change_for(const LocalGoal& goal) const {
  const Eigen::Index m = eigen_index(order()) + 2;
  Eigen::VectorXd start = at_rest();
  if (!goal.from_rest) start.head(m - 2).setZero();
  Eigen::VectorXd fixed = Eigen::VectorXd::Zero(m);
  std::vector<double> out;
  for (std::size_t first = 0; first < samples_;) {
    stop_if_interrupted();
    const bool whole = samples_ - first <= kWindow + kOverlap;
    const std::size_t count = whole ? samples_ - first : kWindow + kOverlap;
    const PreviewSystem here = system(first, count);
    const std::vector<double> change = WindowSearch(here, goal, first, count, step_s_).run(start, fixed);
    const std::size_t kept = whole ? count : kWindow;
    out.insert(out.end(), change.begin(), change.begin() + static_cast<std::ptrdiff_t>(kept));
    // The next window starts at the sample behind the last one kept, whose drive it may no longer choose.
    if (start.size() > 0) fixed = change[0] * start;
    if (!whole) fixed = here.state_after(fixed, change, kept);
    start.resize(0);
    first += kept;
  }
  return out;
}

}  // namespace bodesmith::chain
