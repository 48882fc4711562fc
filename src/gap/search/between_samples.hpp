#pragma once

#include <optional>

#include "gap/search/records.hpp"

namespace bodesmith::gap {

// A record says what its input was at the samples; a model takes it as straight between them. A smooth input
// bulges out of these lines: they hold (sin x / x)^2 of a sine of f Hz, x = pi f T, and what is missing looks
// like a resonance far above the band. To the fourth order in x the block
//     1 / (1 - (f / f_0)^2),   f_0 = sqrt(12) / (2 pi T) = 0.551 / T
// gives it back. It stands in front of the chain, has no unknowns and no name: it is the record's doing.

/// The model with that block (of the first record's T), refitted, when it leaves much less of the records than without; nothing
/// otherwise.
std::optional<Model> with_smooth_input(const SearchSetting& setting, const SearchRecords& records,
                                       const Model& model);

}  // namespace bodesmith::gap
