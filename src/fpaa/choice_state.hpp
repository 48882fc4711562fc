#pragma once

#include <cstddef>
#include <vector>

#include "fpaa/candidates.hpp"

namespace bodesmith::fpaa {

/// A choice of candidates and what it leaves of the problem, kept up to date as candidates are replaced.
/// Replacing allocates nothing.
class ChoiceState {
 public:
  ChoiceState(const CandidateLists& lists, Choice choice);

  const CandidateLists& lists() const { return *lists_; }
  const Choice& choice() const { return choice_; }
  const Candidate& chosen(std::size_t branch) const { return (*lists_)[branch][choice_[branch]]; }
  void replace(std::size_t branch, std::size_t candidate);

  /// ln(got/wanted) over the grid, gain included.
  const std::vector<double>& re() const { return re_; }
  const std::vector<double>& im() const { return im_; }

  /// ln of the product of all gains.
  double total_gain() const;
  /// Worst |ln(got/wanted)|: to first order the complex error.
  double residual() const;
  /// The same when a common gain is free: the first-order optimum is the middle of the real parts.
  struct Shape {
    double error = 0.0;
    double log_gain = 0.0;  ///< by how much the gain is off that optimum, nepers
  };
  Shape shape() const;
  /// Worst |got/wanted - 1|.
  double exact_error() const;
  /// Farthest that any node strays from the wanted spread of the gain, nepers.
  double spread() const;
  /// residual(), and what a spread beyond its window costs.
  double cost() const;
  /// What is missing of the total gain after each branch in turn has made up for what it can within its own
  /// candidates (whose corners all but agree), in nepers.
  double gain_out_of_reach() const;

 private:
  void apply(std::size_t branch, std::size_t candidate, double sign);

  const CandidateLists* lists_;
  Choice choice_;
  std::vector<double> re_, im_;
  std::vector<double> cam_gain_;
};

}  // namespace bodesmith::fpaa
