#pragma once

#include "gap/model/model.hpp"
#include "gap/records/experiment.hpp"
#include "gap/search_options.hpp"

namespace bodesmith::gap {

/// Of long training records the parts of which the model leaves most (what acts where the output is small, a slew limit at a sweep's high
/// end, shows nowhere else), one a record, each behind a lead that is run but not scored: from the record's start where the model, which
/// starts a stretch at rest, does not come to what it does in the whole record. Empty when the records are not long.
Experiments stretches_of(const Experiments& train, const Model& model, std::size_t samples = kStretchSamples);

}  // namespace bodesmith::gap
