#pragma once

#include <complex>
#include <cstddef>
#include <vector>

#include "fpaa/chain_search.hpp"

namespace bodesmith::fpaa {

/// Capacitors that a branch may take, and what they do.
struct Candidate {
  BranchValue value;
  double log_gain = 0.0;       ///< ln of its gain at low frequency, signed by the side of the fraction line
  std::vector<double> re, im;  ///< ln(branch / imitated) over the grid, signed likewise
};

/// One candidate of each branch, by index.
using Choice = std::vector<std::size_t>;

/// The candidates of every branch of a problem: those whose corner is nearest, in the order of their ratio
/// C1/C0, so that neighbours in the list have neighbouring corners.
class CandidateLists {
 public:
  /// At most `count` of each branch with a corner.
  CandidateLists(const ChainProblem& problem, std::size_t count);

  const ChainProblem& problem() const { return problem_; }
  std::size_t points() const { return problem_.grid.size(); }
  std::size_t branches() const { return lists_.size(); }
  const std::vector<Candidate>& operator[](std::size_t branch) const { return lists_[branch]; }
  /// Branches without any.
  std::vector<std::size_t> unreachable() const;
  /// The branches in order: the one that can be set most finely first.
  const std::vector<std::size_t>& finest_first() const { return finest_first_; }

  /// 1 - 1/z at a point of the grid.
  std::complex<double> one_minus_z(std::size_t point) const { return one_minus_z_[point]; }
  /// The candidate that best makes up for a gain of `missing` nepers.
  std::size_t nearest_by_gain(std::size_t branch, double missing) const;

 private:
  std::vector<BranchValue> values_of(const Branch& branch, std::size_t count) const;
  std::vector<BranchValue> near_ratio(const Branch& branch, std::size_t count) const;
  Candidate evaluate(const Branch& branch, const BranchValue& value,
                     const std::vector<std::complex<double>>& target) const;
  double multiples(const Branch& branch) const;

  const ChainProblem& problem_;
  std::vector<std::complex<double>> one_minus_z_;
  std::vector<std::vector<Candidate>> lists_;
  std::vector<std::size_t> finest_first_;
};

}  // namespace bodesmith::fpaa
