#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "lti/state_space.hpp"

namespace bodesmith::tracking {

/// I - e^(A T): what a repeat of T seconds takes away of the states that it began with.
Eigen::MatrixXd forgotten(const StateSpace& system, double repeat_s);

/// A state space in steady state under an input that repeats after its last sample and is straight between samples. Exact, and
/// without the ripple that a spectrum has where a drive jumps from branch to branch (in which a stage that reads it would turn).
struct SettledPath {
  std::vector<double> states;  ///< at the first sample
  std::vector<double> output;  ///< at every one
};
SettledPath settled_path(const StateSpace& system, std::span<const double> u, double step_s);

}  // namespace bodesmith::tracking
