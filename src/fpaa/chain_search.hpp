#pragma once

#include <complex>
#include <cstddef>
#include <vector>

#include "base/units.hpp"
#include "fpaa/branch.hpp"

namespace bodesmith::fpaa {

/// Find integers so that the product of all branches over the fraction line, divided by those below, imitates
///   gain * prod T_above(jw) / prod T_below(jw)
/// on jw with the smallest worst complex error |got/wanted - 1| over `grid`.
struct ChainProblem {
  std::vector<Branch> branches;
  Hertz clock;
  std::vector<RadPerSecond> grid;
  double log_gain = 0.0;             ///< ln of the wanted gain (of the T's above)
  std::vector<double> cam_log_gain;  ///< how the gain should be spread: wanted ln gain of each CAM
  double spread_window = 0.35;       ///< how far any node may stray from that, in nepers
  /// ln(got/wanted) of CAMs that are settled already; may be empty.
  std::vector<std::complex<double>> others;
  int max_capacitor = 255;
};

struct ChainSolution {
  std::vector<BranchValue> values;       ///< as in ChainProblem::branches
  double max_complex_error = 0.0;        ///< over the grid, gain included
  double shape_error = 0.0;              ///< the worst error if the gain were free
  double gain_error = 0.0;               ///< ln of total gain over wanted
  double spread = 0.0;                   ///< farthest any node strays from the wanted spread, nepers
  std::vector<std::size_t> unreachable;  ///< branches without any candidate: no capacitors reach the corner
  bool made() const { return unreachable.empty(); }
};

/// How hard to look. The same problem and effort give the same answer.
struct SearchEffort {
  std::size_t candidates = 200;  ///< per branch
  std::size_t beam = 100;        ///< partial choices kept
  std::size_t polished = 3;      ///< how many of the beam's results are polished; 0: judge the shapes only
  int polish_rounds = 8;         ///< each exhaustive over all triples of branches among `neighbours`
  std::size_t neighbours = 48;   ///< of each branch that polishing looks at
};

/// A beam search over the branches in the sense of least squares (beam.hpp), whose best results are polished
/// (polish.hpp); a chain of one CAM is searched exhaustively.
ChainSolution search_chain(const ChainProblem& problem, const SearchEffort& effort);

}  // namespace bodesmith::fpaa
