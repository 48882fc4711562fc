#include "faults/finding.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>

#include "numeric/index.hpp"
#include "numeric/linear_algebra/dense.hpp"

namespace bodesmith::faults {
namespace {

constexpr int kTeeth = 17;
constexpr int kSteps = 8;
constexpr double kDifference = 1e-3;
constexpr double kEnough = 1e-3;  ///< of a logarithm of the density

/// One rough value for each size of noise, relative to what was estimated, and its weight (log-normal, 0.5).
constexpr double kNoiseFactors[] = {0.5, 0.71, 1.0, 1.41, 2.0, 2.83, 4.0, 8.0};
constexpr double kNoiseSpread = 0.5;

Effect effect_of(const std::vector<const Fault*>& faults, const std::vector<double>& sizes) {
  Effect out;
  for (std::size_t i = 0; i < faults.size(); ++i) out = joined(out, faults[i]->effect(sizes[i]));
  return out;
}

double clamped(const Fault& fault, double t) {
  return std::clamp(t, fault.from, fault.to);
}

/// d rows / d size of every fault that has one.
Eigen::MatrixXd directions(const Board& board, const Finding& at, const Eigen::VectorXd& residual) {
  std::vector<Eigen::VectorXd> columns;
  for (std::size_t i = 0; i < at.faults.size(); ++i) {
    if (!at.faults[i]->has_size()) continue;
    std::vector<double> sizes = at.sizes;
    const double step = sizes[i] + kDifference > at.faults[i]->to ? -kDifference : kDifference;
    sizes[i] += step;
    const Eigen::VectorXd moved = residual_of(board, board.response(effect_of(at.faults, sizes))).rows();
    columns.push_back((residual - moved) / step);
  }
  Eigen::MatrixXd out(residual.size(), eigen_index(columns.size()));
  for (std::size_t i = 0; i < columns.size(); ++i) out.col(eigen_index(i)) = columns[i];
  return out;
}

struct Normal {
  Eigen::MatrixXd matrix;
  Eigen::VectorXd step;
};

Normal normal_equations(const Likelihood& likelihood, const Eigen::MatrixXd& directions) {
  const Eigen::Index n = directions.cols();
  Normal out{Eigen::MatrixXd(n, n), Eigen::VectorXd(n)};
  Eigen::VectorXd right(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    right(i) = likelihood.inner(directions.col(i), likelihood.residual());
    for (Eigen::Index j = 0; j <= i; ++j)
      out.matrix(i, j) = out.matrix(j, i) = likelihood.inner(directions.col(i), directions.col(j));
  }
  Eigen::MatrixXd damped = out.matrix;
  damped.diagonal().array() = damped.diagonal().array() * (1.0 + 1e-9) + 1e-9;
  out.step = solve_ldlt(damped, right);
  return out;
}

/// Sizes moved along a step, within their bounds.
std::vector<double> moved(const Finding& at, const Eigen::VectorXd& step, double share) {
  std::vector<double> out = at.sizes;
  Eigen::Index column = 0;
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (at.faults[i]->has_size())
      out[i] = clamped(*at.faults[i], out[i] + std::clamp(share * step(column++), -1.0, 1.0));
  }
  return out;
}

/// ln of the share of the prior that the peak over the sizes fills.
double log_width(const Finding& at, const Eigen::MatrixXd& curvature) {
  double out = 0.0;
  Eigen::Index column = 0;
  for (const Fault* fault : at.faults) {
    if (!fault->has_size()) continue;
    const double width = std::sqrt(2.0 * std::numbers::pi / std::max(curvature(column, column), 1e-12)) /
                         (fault->to - fault->from);
    out += std::min(0.0, std::log(width));
    ++column;
  }
  return out;
}

}  // namespace

Effect Finding::effect() const {
  return effect_of(faults, sizes);
}

std::string Finding::site() const {
  std::string out;
  for (const Fault* fault : faults) out += (out.empty() ? "" : " + ") + fault->site;
  return out;
}

std::vector<double> comb(const Fault& fault, int count) {
  if (!fault.has_size()) return {0.0};
  std::vector<double> out;
  for (int i = 0; i < count; ++i) out.push_back(fault.from + (fault.to - fault.from) * i / (count - 1.0));
  return out;
}

Finding polished(const Board& board, Finding start, const Noise& noise) {
  const auto judged = [&](const std::vector<double>& sizes) {
    return Likelihood(board, board.predict(effect_of(start.faults, sizes)), noise, start.part_spread);
  };
  Likelihood now = judged(start.sizes);
  double density = now.log_density();
  const bool free = std::ranges::any_of(start.faults, [](const Fault* f) { return f->has_size(); });
  Eigen::MatrixXd curvature;
  for (int i = 0; free && i < kSteps; ++i) {
    const Normal normal = normal_equations(now, directions(board, start, now.residual()));
    curvature = normal.matrix;
    bool better = false;
    for (double share = 1.0; share > 0.05 && !better; share *= 0.4) {
      const std::vector<double> sizes = moved(start, normal.step, share);
      Likelihood next = judged(sizes);
      const double gained = next.log_density() - density;
      if (!(gained > kEnough)) continue;
      better = true;
      density += gained;
      start.sizes = sizes;
      now = std::move(next);
    }
    if (!better) break;
  }
  start.log_evidence = density + (free ? log_width(start, curvature) : 0.0);
  start.misfit = now.misfit();
  start.rows = now.rows();
  return start;
}

Finding fitted(const Board& board, const std::vector<const Fault*>& faults, double log_prior,
               const Noise& noise) {
  Finding best;
  best.faults = faults;
  best.log_prior = log_prior;
  if (faults.size() == 1 && faults[0]->has_size()) {
    double largest = -INFINITY;
    for (const double t : comb(*faults[0], kTeeth)) {
      const double density = Likelihood(board, board.predict(faults[0]->effect(t)), noise).log_density();
      if (best.sizes.empty() || density > largest) {
        best.sizes = {t};
        largest = density;
      }
    }
  } else {
    for (const Fault* fault : faults) best.sizes.push_back(0.5 * (fault->from + fault->to));
  }
  return polished(board, std::move(best), noise);
}

namespace {

/// The finding's faults on a board of other parts; nothing where that board cannot have them.
std::optional<Effect> effect_on(const Board& board, const Finding& finding,
                                const std::vector<Fault>& faults) {
  const std::vector<Fault> there = board.faults();
  const auto same = [](const Fault& a, const Fault& b) { return a.kind == b.kind && a.parts == b.parts; };
  Effect out;
  for (std::size_t i = 0; i < finding.faults.size(); ++i) {
    const Fault& fault = *finding.faults[i];
    // A kind may have several faults of the same part: the first, the second of them.
    auto left =
        std::count_if(faults.data(), finding.faults[i], [&](const Fault& f) { return same(f, fault); });
    const auto at =
        std::ranges::find_if(there, [&](const Fault& f) { return same(f, fault) && left-- == 0; });
    if (at == there.end()) return std::nullopt;
    out = joined(out, at->effect(finding.sizes[i]));
  }
  return out;
}

/// ln of the mean density over sizes of the noise; `judge` gives it for one.
double over_noise(const Noise& noise, const std::function<double(const Noise&)>& judge) {
  std::vector<double> terms;
  double weights = 0.0;
  for (const double factor : kNoiseFactors) {
    const double x = std::log(factor) / kNoiseSpread;
    weights += std::exp(-0.5 * x * x);
    terms.push_back(-0.5 * x * x + judge({noise.gain * factor, noise.phase * factor}));
  }
  const double largest = *std::ranges::max_element(terms);
  double sum = 0.0;
  for (const double term : terms) sum += std::exp(term - largest);
  return largest + std::log(sum / weights);
}

}  // namespace

Finding refined(const Board& board, Finding finding, const std::vector<Fault>& faults, const Noise& noise) {
  const Prediction first = board.predict(finding.effect());
  const Likelihood linear(board, first, noise, finding.part_spread);
  Eigen::VectorXd around = linear.errors();
  // Errors beyond what any part has would make another board of it: a dead one, on which no error costs anything.
  constexpr double kMostErrors = 5.0;
  for (Eigen::Index u = 0; u < around.size(); ++u)
    around(u) = std_index(u) < board.unknowns() && board.is_part(std_index(u))
                    ? std::clamp(around(u), -kMostErrors, kMostErrors)
                    : 0.0;
  double density = over_noise(noise, [&](const Noise& one) {
    return Likelihood(board, first, one, finding.part_spread).log_density();
  });
  const std::unique_ptr<Board> moved = board.with_parts(finding.part_spread * around);
  const std::optional<Effect> effect = moved ? effect_on(*moved, finding, faults) : std::nullopt;
  if (effect) {
    const Prediction there = moved->predict(*effect);
    const double again = over_noise(noise, [&](const Noise& one) {
      return Likelihood(*moved, there, one, finding.part_spread, around, linear).log_density();
    });
    // Where the linear form led far astray, what it says itself is the better of the two.
    if (again > density) {
      density = again;
      const Likelihood at_noise(*moved, there, noise, finding.part_spread, around, linear);
      finding.misfit = at_noise.misfit();
      finding.rows = at_noise.rows();
    }
  }
  finding.log_evidence += density - linear.log_density();
  return finding;
}

}  // namespace bodesmith::faults
