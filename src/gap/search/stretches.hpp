#pragma once

#include "gap/model/model.hpp"
#include "gap/records/experiment.hpp"
#include "gap/search_options.hpp"

namespace bodesmith::gap {

/// The liveliest parts of long training records, one a record, each behind a lead that is run but not scored; empty when the
/// records are not long.
Experiments stretches_of(const Experiments& train, const StretchOptions& options);

/// Leads from the record's start where the model, which starts a stretch at rest, does not come to what it does in the whole record.
void lengthen_leads(Experiments& stretches, const Experiments& train, const Model& model);

/// The same, once stretches behind which far less is left than elsewhere in their record have moved there: what acts where the
/// output is small (a slew limit at a sweep's high end) shows nowhere else.
void follow_what_is_left(Experiments& stretches, const Experiments& train, const Model& model,
                         const StretchOptions& options);

}  // namespace bodesmith::gap
