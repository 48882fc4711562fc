#pragma once

#include <string>
#include <vector>

#include "gap/cases/solve.hpp"

namespace hidden {

/// Markdown for docs/gap.md: counts by size, by effect and size, pairs, false alarms, abstention, closure,
/// and which was taken for which.
std::string confusion_tables(const std::vector<Outcome>& outcomes);

}  // namespace hidden
