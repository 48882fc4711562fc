#pragma once

#include <string>

#include "gap/diagnosis.hpp"
#include "report/page.hpp"

namespace bodesmith::gap {

// Parts of the report page.

/// A number for a person.
std::string figure_text(double value);

/// The gap after each step, training and held-out records. Wants at least one step.
void add_ladder_figure(report::Page& page, const Diagnosis& diagnosis);

/// One held-out record before and after: output where the base model is worst, residual, loops, spectrum; or
/// the frequency response.
void add_record_figures(report::Page& page, const Diagnosis& diagnosis, const TimeExperiment& experiment);
void add_record_figures(report::Page& page, const Diagnosis& diagnosis,
                        const FrequencyExperiment& experiment);

report::Table steps_table(const Diagnosis& diagnosis);
report::Table cells_table(const std::vector<Cell>& cells);
report::Table ranking_table(const std::vector<Ranked>& ranking, bool relative);
/// Every parameter of every step: the numbers behind the verdict's words.
report::Table parameters_table(const Diagnosis& diagnosis);

}  // namespace bodesmith::gap
