#pragma once

#include <vector>

#include "base/json_fwd.hpp"
#include "tolerance/yield.hpp"

namespace bodesmith::yield {

/// One design's part of yield.json.
Json to_json(const Result& result, const Options& options);
/// `to_buy`: pairs of tolerances and whether they keep the limit.
Json to_json(const std::vector<Purchase>& purchases);

}  // namespace bodesmith::yield
