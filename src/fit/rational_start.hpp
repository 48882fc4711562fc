#pragma once

#include <optional>
#include <vector>

#include "fit/curve_target.hpp"
#include "fit/root_model.hpp"

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

}  // namespace bodesmith
