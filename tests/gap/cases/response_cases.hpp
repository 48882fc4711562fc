#pragma once

#include <string>
#include <vector>

#include "gap/cases/case.hpp"

/// Frequency responses by closed forms on the jω axis, with relative noise on real and imaginary part.
namespace hidden {

/// Bases: gain, fixed_gain, resonator, sections.
const std::vector<std::string>& response_bases();
/// The linear effects.
const std::vector<std::string>& response_effects(const std::string& base);
/// white; rising (noise grows with frequency); parameters_off; two_records.
const std::vector<std::string>& response_control_kinds();
/// echo (a weak late copy); narrow_notch; lobe (a stretch of the response measured too large).
const std::vector<std::string>& response_outside_kinds();

Case make_response_case(const Specification& specification);

}  // namespace hidden
