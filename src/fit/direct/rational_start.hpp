#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "fit/direct/curve_target.hpp"
#include "fit/direct/root_model.hpp"

namespace bodesmith {

/// A start for a magnitude fit that lies in the valley of the best one more often than not: |H|^2 as a quotient of two
/// polynomials in w^2, in barycentric form about support points that are picked where the error is largest (the AAA
/// algorithm: Nakatsukasa, Sète, Trefethen, SIAM J. Sci. Comput. 40 (2018) A1494), then reweighted so that the largest
/// relative error shrinks (Lawson's iteration on it: Nakatsukasa, Trefethen, SIAM J. Sci. Comput. 42 (2020) A3157). Its
/// roots in w^2 become roots in the left half plane; those on the positive axis, where |H|^2 would change its sign,
/// lightly damped pairs.
///
/// As corner frequencies of `model`, whose numbers of real roots and pairs it takes on (a real model gets the roots'
/// sizes). Nothing for fewer points than twice the free numbers, or where the quotient has no such roots.
std::optional<Eigen::VectorXd> rational_start(const RootModel& model, const CurveTarget& target,
                                              const RootLimits& limits);

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
