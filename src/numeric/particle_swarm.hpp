#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>

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
  bool cuckoo = true;
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

}  // namespace bodesmith
