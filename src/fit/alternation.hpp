#pragma once

#include <cstddef>
#include <vector>

#include "fit/curve_target.hpp"
#include "fit/root_model.hpp"

namespace bodesmith {

/// What no stable H of these numbers of zeros and poles can undercut (Np, weighted, largest of all points), as this
/// fit shows.
///
/// |H(jw)|^2 is a quotient of polynomials in w^2, positive on the axis. Where the errors of one such quotient alternate
/// in sign at zeros + poles + 2 points, another one whose error is smaller at all of them would cross it zeros + poles +
/// 1 times, which two such quotients cannot (de la Vallée-Poussin). So the smallest of those errors bounds every fit of
/// the same orders, and a fit whose largest error is that bound is the best there is. 0 when the errors do not
/// alternate often enough. For magnitudes only; masks are left aside.
double alternation_bound(const RootModel& model, const CurveTarget& target, const Eigen::VectorXd& theta);

/// The same for errors in order of frequency: the largest e such that `count` of them alternate in sign and none of
/// these is below e.
double alternating_level(const std::vector<double>& errors, std::size_t count);

}  // namespace bodesmith
