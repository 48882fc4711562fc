#pragma once

#include <string>
#include <vector>

#include "base/provenance.hpp"
#include "circuit/circuit.hpp"
#include "project/budget.hpp"
#include "project/limits.hpp"
#include "report/page.hpp"

/// Tables that more than one place of the reports shows.
namespace bodesmith::project {

report::Table limits_table(const std::vector<LimitCheck>& limits);
report::Table inputs_table(const Provenance& from);
/// Each stage against the one before it, and what becomes of the waveform.
report::Table budget_table(const Budget& budget);
/// Poles and zeros in rad/s.
report::Table sections_table(const Sections& sections);
report::Table parts_table(const std::vector<schematic::Part>& parts);
report::Table cams_table(const fpaa::Plan& plan);

}  // namespace bodesmith::project
