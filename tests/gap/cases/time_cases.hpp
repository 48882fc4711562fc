#pragma once

#include <string>
#include <vector>

#include "gap/cases/case.hpp"

/// Cases in the time domain by the formulas of stages.hpp. Base parameters, time scale, excitation, number
/// and length of the records, noise colour and the effect's parameters are all drawn from the seed.
namespace hidden {

/// Bases: gain, fixed_gain, resonator, stage (low-pass, branches, resonator), sections, curve.
const std::vector<std::string>& time_bases();
const std::vector<std::string>& time_effects(const std::string& base);
const std::vector<std::string>& control_kinds();
const std::vector<std::string>& outside_kinds();

Case make_time_case(const Specification& specification);

}  // namespace hidden
