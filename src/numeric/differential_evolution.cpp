#include "numeric/differential_evolution.hpp"

#include <algorithm>
#include <vector>

#include "numeric/random.hpp"

namespace bodesmith {

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
  const auto best = std::min_element(
      all.begin(), all.end(), [](const Individual& p, const Individual& q) { return p.cost < q.cost; });
  out.x = best->x;
  out.cost = best->cost;
  return out;
}

}  // namespace bodesmith
