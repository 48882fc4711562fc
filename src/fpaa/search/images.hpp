#pragma once

#include "fpaa/search/sine_response.hpp"

namespace bodesmith::fpaa {

/// What the switches put into the band beside a sine, in closed form: all lines k fc +- f of its clocks there together, against the
/// response asked for at the sine; rms over sines spread evenly over the band's decades. 0 where every clock is above twice the band.
///
/// A stage of period T makes of a line m of its input, x the input and Tp the end of a phase,
///   int y exp(-jmt) dt = (y(Tp) + gp x(Tp)) int exp(-jmt) dt - gp int x exp(-jmt) dt      over each phase,
/// and a reader at a slower clock adds the faster one's periods up.
double image_share(const Design& design, const DesignTarget& target);

}  // namespace bodesmith::fpaa
