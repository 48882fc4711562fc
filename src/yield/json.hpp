#pragma once

#include "base/json_fwd.hpp"
#include "yield/yield.hpp"

namespace bodesmith::yield {

/// One design's part of yield.json.
Json to_json(const Result& result, const Options& options);

}  // namespace bodesmith::yield
