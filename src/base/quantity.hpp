#pragma once

#include <string_view>

namespace bodesmith {

/// A number as a person writes it: 47k, 4k7, 4R7, 10n, 2u2, 13.2 kHz, 220nF, 3 dB. Prefixes p n u µ m k M G, units Hz,
/// ohm (Ω), F, V, A, s, dB, deg and %, which are read over: the caller's own name says the unit. False when the text is
/// something else or not finite. Plain numbers are numbers too.
bool parse_quantity(std::string_view text, double& value);

}  // namespace bodesmith
