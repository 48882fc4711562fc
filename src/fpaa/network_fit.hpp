#pragma once

#include <complex>
#include <vector>

#include "fpaa/mismatch.hpp"
#include "fpaa/network.hpp"

namespace bodesmith::fpaa {

/// How the output changes with one capacitor: d output / d ln C on the grid.
struct CapacitorEffect {
  std::size_t stage = 0;
  std::size_t capacitor = 0;
  std::vector<std::complex<double>> values;
};
/// `only_free`: of those that the continuous fit moves.
std::vector<CapacitorEffect> capacitor_effects(const Network& network, const NetworkResponse& response,
                                               bool only_free = false);

/// Moves the free capacitors (any real values within what a capacitor may be) to the least squares of the
/// weighted errors, by Levenberg and Marquardt with exact derivatives; `passes` > 1 then leans on the points
/// where the error is largest (Lawson's weights), towards the least worst error.
void fit_network(Network& network, const NetworkResponse& response, int iterations, int passes = 1);

/// How much is kept while stages become whole one after the other.
struct RoundingWidth {
  std::size_t networks = 1;  ///< partly whole networks kept after each stage
  std::size_t choices = 1;   ///< sets of whole capacitors tried for a stage of each
};
/// Whole capacitors: stage by stage the scales that cost least, the capacitors not yet whole fitted again after
/// each; networks are compared with what is left fitted. False where some stage cannot be made (a capacitor
/// below half a unit).
bool round_network(Network& network, const NetworkResponse& response, RoundingWidth width = {});

/// Single capacitors up and down as long as the worst error that 95 % of boards keep gets smaller.
void polish_network(Network& network, const NetworkResponse& response, const MismatchModel& mismatch,
                    double mismatch_weight, int passes);

/// Pairs of capacitors of any stages, each up and down by a few units together, found with the exact first
/// derivatives and judged by the exact response: what a single capacitor spoils another one may mend.
void polish_pairs(Network& network, const NetworkResponse& response, const MismatchModel& mismatch,
                  double mismatch_weight, int rounds);

/// Standard deviation of output/wanted by mismatch, on the grid.
std::vector<double> mismatch_sigma(const Network& network, const NetworkResponse& response,
                                   const MismatchModel& mismatch);

/// The largest node (op-amps inside second-order stages too) against the larger of the signal's two ends, over
/// the grid: above 1 it is the first that clips.
double clipping_of(const Network& network, const NetworkResponse& response);
/// What that costs in a search, as a factor on the error: half of it more for each factor of two.
double clipping_cost(double clipping);

struct NetworkScore {
  double error = 0.0;    ///< largest weighted |got/wanted - 1|
  double in_band = 0.0;  ///< the same where the weight is 1
  double sigma = 0.0;    ///< largest weighted standard deviation by mismatch
  double total = 0.0;    ///< largest of |error| + mismatch_weight 1.96 sigma at one frequency, weighted
};
NetworkScore network_score(const Network& network, const NetworkResponse& response,
                           const MismatchModel& mismatch, double mismatch_weight);

}  // namespace bodesmith::fpaa
