#pragma once

#include "fit/curve_target.hpp"
#include "fit/root_model.hpp"

namespace bodesmith {

/// Takes away poles and zeros that cancel without making the fit worse by more than a thousandth (or 1e-5 dB: rounding
/// of a fit that is exact with fewer). `value_db` is the fit's largest weighted error as its search knows it. Returns
/// how many poles went.
int drop_cancelling(RootModel::Roots& roots, const CurveTarget& target, double value_db);
/// Takes away zeros above the points, as far as the fit does not become worse by more than the same: a curve that falls
/// to the end needs none, and one at a thousand times its highest frequency can neither be built nor be seen in it.
/// Returns how many went.
int drop_distant_zeros(RootModel::Roots& roots, const CurveTarget& target, double value_db);

}  // namespace bodesmith
