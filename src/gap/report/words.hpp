#pragma once

#include <string>
#include <vector>

#include "gap/diagnosis.hpp"

namespace bodesmith::gap {

/// A parameter's name as a person says it: "corner" of corner_hz, "weight 2" of w[2].
std::string parameter_words(const std::string& name);
/// Its value with the unit at the end of the name: 60.12 Hz.
std::string parameter_text(const std::string& name, double value);

/// A found effect in a sentence or two: what it is, where, its value when there are one or two, what it cannot be told from.
/// Banks of weights are counted; their values stand in a table.
std::string step_in_words(const DiagnosedStep& step);

/// What the rms figures of the page are of: a sentence, and the words behind a figure.
std::string rms_unit_sentence(const Diagnosis& diagnosis);
/// An rms for a card or a table: relative ones of frequency responses in percent.
std::string rms_text(const Diagnosis& diagnosis, double rms);

}  // namespace bodesmith::gap
