#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <limits>

namespace bodesmith {

/// Particle swarm followed, every generation, by cuckoo search around each particle's best (KP paper, eq. 8-12):
///   V ← ω V + c1 r1 (p_best − X) + c2 r2 (g_best − X),  X ← X + V,  ω falling linearly        (8)-(10)
///   p_best ← p_best + α0 φ u / |v|^(1/λ) (p_best − g_best), kept when better                   (11)
///   φ = {Γ(1+λ) sin(πλ/2) / (Γ((1+λ)/2) λ 2^((λ−1)/2))}^(1/λ), λ = 1.5                         (12)
/// (the printed eq. 12 has the braces of Γ around the whole denominator; this is Mantegna's formula, which it
/// cites).
struct PsoCuckooOptions {
  int particles = 40;
  int generations = 300;
  double inertia_max = 0.9;
  double inertia_min = 0.4;
  double c1 = 2.0;
  double c2 = 2.0;
  double alpha_0 = 0.01;
  std::uint64_t seed = 1;
};
struct PsoCuckooResult {
  Eigen::VectorXd x;
  double cost = 0.0;
  long evaluations = 0;
};
PsoCuckooResult pso_cuckoo(const std::function<double(const Eigen::VectorXd&)>& cost,
                           const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
                           const PsoCuckooOptions& options);

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
