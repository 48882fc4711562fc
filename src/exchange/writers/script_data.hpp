#pragma once

#include <complex>
#include <functional>
#include <string>

#include "base/json_fwd.hpp"
#include "exchange/writer.hpp"

namespace bodesmith::exchange {

/// How a language writes a complex number: "1.0-2.0j", "complex(1.0,-2.0)".
using ComplexText = std::function<std::string(const std::complex<double>&)>;

/// What the scripts' templates are filled with: source, name, gain, delay_s, sections (gain, zeros, poles as lists of
/// text), and responses at a few frequencies, by which a script checks itself.
Json script_data(const Exportable& from, const Sections& sections, const ComplexText& text);

/// {source, name, blocks: [{name, order, a, b, c, d, delay_s}], checks}: matrices row by row.
Json model_script_data(const Exportable& from, const ComplexText& text);
/// {source, name, output, blocks: [{name, clock_hz, denominator, inputs: [{from, numerator}]}], checks}.
Json plan_script_data(const Exportable& from, const ComplexText& text);

}  // namespace bodesmith::exchange
