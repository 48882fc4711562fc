#pragma once

#include <string>

#include "base/documents/json_fwd.hpp"
#include "faults/diagnosis.hpp"

namespace bodesmith::faults {

/// faults.json without the header.
Json to_json(const Diagnosis& diagnosis, const Board& board, const Spread& spread, const Priors& priors);
/// What the program prints.
std::string summary_text(const Diagnosis& diagnosis);
/// One sentence.
std::string verdict_sentence(const Diagnosis& diagnosis);
/// What to do next, a line each.
std::vector<std::string> next_steps(const Diagnosis& diagnosis);

/// report.html.
std::string report_page(const Diagnosis& diagnosis, const Board& board, const std::string& name);

}  // namespace bodesmith::faults
