#pragma once

#include <string>
#include <vector>

#include "call.hpp"
#include "signal/bode_points.hpp"
#include "signal/time_record.hpp"

namespace bodesmith::python {

/// Throws InputError that names the first value that is not a finite number.
void expect_finite(std::span<const double> values, const std::string& name);
/// frequency_hz, gain; phase_deg and weight where they were given; names end with `ending`. Sorted.
BodePoints points_of(const Call& call, const std::string& ending = "");
/// frequency_hz and response (re, im, re, im, …).
FrequencyRecord response_of(const Call& call, const std::string& ending = "");
/// u, and y where it was given; times from `about` (start_s, step_s).
TimeRecord record_of(const Call& call, const Node& about, const std::string& ending = "");
/// The records of a list of options: arrays u0, y0, u1, y1, … with `name` in front.
std::vector<TimeRecord> records_of(const Call& call, const std::string& name);

/// (re, im, re, im, …).
std::vector<double> interleaved(const std::vector<std::complex<double>>& values);

}  // namespace bodesmith::python
