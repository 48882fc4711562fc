#pragma once

#include <string>

#include "multiplier_layout/layout.hpp"

namespace bodesmith::multiplier_layout {

/// parts.csv: that of the op-amp circuits, with the role in place of the section.
std::string parts_csv(const Layout& layout);

}  // namespace bodesmith::multiplier_layout
