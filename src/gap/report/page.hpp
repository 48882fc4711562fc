#pragma once

#include <string>

#include "gap/diagnosis.hpp"

namespace bodesmith::gap {

/// report.html.
std::string report_page(const Diagnosis& diagnosis, const Study& study);

}  // namespace bodesmith::gap
