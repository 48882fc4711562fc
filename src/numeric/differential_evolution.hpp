#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <limits>

namespace bodesmith {

/// Self-adaptive differential evolution, jDE (Brest, Greiner, Bošković, Mernik and Žumer, IEEE Trans. Evol.
/// Comput. 10 (2006) 646): DE/rand/1/bin where every individual carries its own F in [0.1, 1] and CR in [0,
/// 1], drawn anew with probability 0.1 each and inherited when they do well. The tool-servo paper uses "a self-adaptive scheme
/// of the control parameters of DE".
struct DifferentialEvolutionOptions {
  int population = 40;
  int generations = 150;
  std::uint64_t seed = 1;
  /// Stops when the population's costs lie within this of each other, relatively.
  double spread = 1e-8;
  /// And at a cost of this or less.
  double enough = -std::numeric_limits<double>::infinity();
};
struct DifferentialEvolutionResult {
  Eigen::VectorXd x;
  double cost = 0.0;
  long evaluations = 0;
  int generations = 0;
};
DifferentialEvolutionResult differential_evolution(const std::function<double(const Eigen::VectorXd&)>& cost,
                                                   const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
                                                   const DifferentialEvolutionOptions& options);

}  // namespace bodesmith
