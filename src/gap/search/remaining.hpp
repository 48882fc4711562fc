#pragma once

#include <vector>

#include "gap/evidence/noise_floor.hpp"
#include "gap/search/records.hpp"
#include "gap/signs/signs.hpp"

namespace bodesmith::gap {

/// The noise floor by the first training record that tells it, under a model.
NoiseFloor floor_under(const Model& model, const SearchRecords& records);

/// Signs that what a model leaves is more than noise.
std::vector<Sign> signs_left(const Model& model, const SearchRecords& records);

/// Something is missing yet: plainly more than the floor is left, or a sign of more.
bool is_something_left(const Model& model, const SearchRecords& records);

}  // namespace bodesmith::gap
