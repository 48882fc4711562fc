#pragma once

#include <complex>
#include <functional>

#include "lti/sections.hpp"

namespace bodesmith {

/// Group delay -d(arg H)/dw in seconds. Of sections in closed form, sum Re 1/(jw - p) - sum Re 1/(jw - z) + delay.
double group_delay_s(const Sections& sections, RadPerSecond w);
/// Of any response by a central difference over 2e-4 of the frequency (relative error about 1e-8 where H is smooth).
double group_delay_s(const std::function<std::complex<double>(Hertz)>& response, Hertz f);

}  // namespace bodesmith
