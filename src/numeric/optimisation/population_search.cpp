#include "numeric/optimisation/population_search.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "base/progress.hpp"
#include "numeric/random.hpp"

namespace bodesmith {

PsoCuckooResult pso_cuckoo(const std::function<double(const Eigen::VectorXd&)>& cost,
                           const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
                           const PsoCuckooOptions& options) {
  const Eigen::Index n = lower.size();
  Random random(options.seed);
  const Eigen::VectorXd span = upper - lower;
  const Eigen::VectorXd fastest = 0.2 * span;
  const auto count = static_cast<std::size_t>(options.particles);
  std::vector<Eigen::VectorXd> x(count), v(count), best(count);
  std::vector<double> best_cost(count);
  PsoCuckooResult out;
  out.cost = std::numeric_limits<double>::infinity();
  const auto judge = [&](const Eigen::VectorXd& at) {
    stop_if_interrupted();
    ++out.evaluations;
    return cost(at);
  };
  for (std::size_t i = 0; i < count; ++i) {
    x[i].resize(n);
    v[i].resize(n);
    for (Eigen::Index d = 0; d < n; ++d) {
      x[i](d) = lower(d) + span(d) * random.uniform();
      v[i](d) = fastest(d) * (2.0 * random.uniform() - 1.0);
    }
    best[i] = x[i];
    best_cost[i] = judge(x[i]);
    if (best_cost[i] < out.cost) {
      out.cost = best_cost[i];
      out.x = x[i];
    }
  }
  constexpr double kLambda = 1.5;
  const double phi =
      std::pow(std::tgamma(1.0 + kLambda) * std::sin(std::numbers::pi * kLambda / 2.0) /
                   (std::tgamma((1.0 + kLambda) / 2.0) * kLambda * std::pow(2.0, (kLambda - 1.0) / 2.0)),
               1.0 / kLambda);
  Eigen::VectorXd trial(n);
  for (int generation = 0; generation < options.generations; ++generation) {
    const double inertia = options.inertia_max - (options.inertia_max - options.inertia_min) * generation /
                                                     std::max(options.generations, 1);
    for (std::size_t i = 0; i < count; ++i) {
      for (Eigen::Index d = 0; d < n; ++d) {
        const double speed = inertia * v[i](d) + options.c1 * random.uniform() * (best[i](d) - x[i](d)) +
                             options.c2 * random.uniform() * (out.x(d) - x[i](d));
        v[i](d) = std::min(std::max(speed, -fastest(d)), fastest(d));
        x[i](d) = std::min(std::max(x[i](d) + v[i](d), lower(d)), upper(d));
      }
      const double here = judge(x[i]);
      if (here < best_cost[i]) {
        best_cost[i] = here;
        best[i] = x[i];
      }
      for (Eigen::Index d = 0; d < n; ++d) {
        const double flight =
            phi * random.normal() / std::pow(std::abs(random.normal()) + 1e-300, 1.0 / kLambda);
        // At the best particle itself eq. 11 gives no move; there the flight is scaled by the span.
        const double reach = best_cost[i] > out.cost ? best[i](d) - out.x(d) : 0.1 * span(d);
        trial(d) = std::min(std::max(best[i](d) + options.alpha_0 * flight * reach, lower(d)), upper(d));
      }
      const double there = judge(trial);
      if (there < best_cost[i]) {
        best_cost[i] = there;
        best[i] = trial;
      }
      if (best_cost[i] < out.cost) {
        out.cost = best_cost[i];
        out.x = best[i];
      }
    }
  }
  return out;
}

DifferentialEvolutionResult differential_evolution(const std::function<double(const Eigen::VectorXd&)>& cost,
                                                   const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
                                                   const DifferentialEvolutionOptions& options) {
  const Eigen::Index n = lower.size();
  const auto count = static_cast<std::size_t>(std::max(options.population, 5));
  Random random(options.seed);
  struct Individual {
    Eigen::VectorXd x;
    double cost = 0.0;
    double f = 0.5;
    double cr = 0.9;
  };
  std::vector<Individual> all(count);
  DifferentialEvolutionResult out;
  const auto judge = [&](const Eigen::VectorXd& x) {
    stop_if_interrupted();
    ++out.evaluations;
    const double value = cost(x);
    return value == value ? value : std::numeric_limits<double>::infinity();
  };
  for (Individual& one : all) {
    one.x.resize(n);
    for (Eigen::Index d = 0; d < n; ++d) one.x(d) = lower(d) + (upper(d) - lower(d)) * random.uniform();
    one.cost = judge(one.x);
  }
  Individual trial;
  trial.x.resize(n);
  for (out.generations = 0; out.generations < options.generations; ++out.generations) {
    for (std::size_t i = 0; i < count; ++i) {
      std::size_t a = i, b = i, c = i;
      while (a == i) a = random.below(count);
      while (b == i || b == a) b = random.below(count);
      while (c == i || c == a || c == b) c = random.below(count);
      trial.f = random.uniform() < 0.1 ? 0.1 + 0.9 * random.uniform() : all[i].f;
      trial.cr = random.uniform() < 0.1 ? random.uniform() : all[i].cr;
      const auto kept = static_cast<Eigen::Index>(random.below(static_cast<std::uint64_t>(n)));
      for (Eigen::Index d = 0; d < n; ++d) {
        if (d != kept && random.uniform() >= trial.cr) {
          trial.x(d) = all[i].x(d);
          continue;
        }
        double value = all[a].x(d) + trial.f * (all[b].x(d) - all[c].x(d));
        // Reflected at the bounds.
        if (value < lower(d)) value = std::min(2.0 * lower(d) - value, upper(d));
        if (value > upper(d)) value = std::max(2.0 * upper(d) - value, lower(d));
        trial.x(d) = value;
      }
      trial.cost = judge(trial.x);
      if (trial.cost <= all[i].cost) all[i] = trial;
    }
    const auto [best, worst] = std::minmax_element(
        all.begin(), all.end(), [](const Individual& p, const Individual& q) { return p.cost < q.cost; });
    if (worst->cost - best->cost <= options.spread * worst->cost || best->cost <= options.enough) break;
  }
  const auto best = std::ranges::min_element(all, {}, &Individual::cost);
  out.x = best->x;
  out.cost = best->cost;
  return out;
}

}  // namespace bodesmith
