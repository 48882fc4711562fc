#pragma once

#include <complex>
#include <functional>

#include "call.hpp"

namespace bodesmith::python {

using ResponseFunction = std::function<std::complex<double>(RadPerSecond)>;

/// Of a cascade, sections, plan (as it runs, or without holds and delays) or a model of linear blocks. InputError for
/// another document.
ResponseFunction response_function(const Node& document, bool with_delays = true);

}  // namespace bodesmith::python
