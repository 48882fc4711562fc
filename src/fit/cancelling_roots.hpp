#pragma once

#include "fit/curve_target.hpp"
#include "fit/root_model.hpp"

namespace bodesmith {

/// Takes away poles and zeros that cancel without making the fit worse by more than a thousandth (or 1e-5 dB: rounding
/// of a fit that is exact with fewer). `value_db` is the fit's largest weighted error as its search knows it. Returns
/// how many poles went.
int drop_cancelling(RootModel::Roots& roots, const CurveTarget& target, double value_db);

}  // namespace bodesmith
