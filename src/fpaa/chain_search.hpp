#pragma once

#include <complex>
#include <cstdint>
#include <vector>

#include "base/units.hpp"

namespace bodesmith::fpaa {

/// One switched branch of a CAM, C0 + C1 (1 - z^-1), above or below the fraction line, and what it stands
/// for.
struct Branch {
  enum class Kind {
    corner,           ///< imitates 1 + s/corner; C0 and C1 from 1
    constant,         ///< imitates 1; C1 = 0
    differentiating,  ///< imitates s (in rad/s); C0 = 0
  };
  Kind kind = Kind::corner;
  RadPerSecond corner;  ///< for Kind::corner
  bool above = true;    ///< numerator
  int cam = 0;          ///< the CAM it belongs to, counted along the signal path
};

/// Find integers so that the product of all branches over the fraction line, divided by those below, imitates
///   gain * prod T_above(jw) / prod T_below(jw)
/// on jw with the least worst complex error |got/wanted - 1| over `grid`.
struct ChainProblem {
  std::vector<Branch> branches;
  Hertz clock;
  std::vector<RadPerSecond> grid;
  double log_gain = 0.0;             ///< ln of the wanted gain (of the T's above)
  std::vector<double> cam_log_gain;  ///< how the gain should be spread: wanted ln gain of each CAM
  double spread_window = 0.35;       ///< how far any node may stray from that, in nepers
  std::vector<std::complex<double>>
      others;  ///< ln(got/wanted) of CAMs that are settled already; may be empty
  int largest = 255;
};

struct BranchValue {
  int c0 = 0;
  int c1 = 0;
};

struct ChainSolution {
  std::vector<BranchValue> values;  ///< as in ChainProblem::branches
  double max_complex_error = 0.0;   ///< over the grid, gain included
  double shape_error = 0.0;         ///< the worst error if the gain were free
  double gain_error = 0.0;          ///< ln of total gain over wanted
  double spread = 0.0;              ///< farthest any node strays from the wanted spread, nepers
  bool made = false;             ///< false: no capacitors reach some corner at this clock (see `unreachable`)
  std::vector<int> unreachable;  ///< branches without any candidate
};

/// How hard to look. The same problem and effort give the same answer.
struct SearchEffort {
  int candidates = 200;   ///< per branch
  int beam = 100;         ///< partial choices kept
  int polished = 3;       ///< how many of the beam's results are polished; 0: judge the shapes only
  int polish_rounds = 8;  ///< each exhaustive over all triples of branches among `neighbours`
  int neighbours = 48;    ///< of each branch that polishing looks at
};

ChainSolution search_chain(const ChainProblem& problem, const SearchEffort& effort);

/// Whether a branch can reach its corner at this clock with capacitors up to `largest` (within half a unit).
bool is_reachable(const Branch& branch, Hertz clock, int largest);

}  // namespace bodesmith::fpaa
