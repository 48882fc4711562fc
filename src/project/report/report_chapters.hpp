#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/provenance.hpp"
#include "fpaa/plan/plan.hpp"
#include "project/design/budget.hpp"
#include "project/limits.hpp"
#include "report/page.hpp"
#include "synthesis/decks/compensator_files.hpp"
#include "synthesis/realise_search.hpp"

/// What the reports of all projects show, with a plant and without.
namespace bodesmith::project {

/// "1 kHz".
std::string hertz_text(double value);
std::string span_text(const Band& band);

report::Table budget_table(const Budget& budget);
report::Table limits_table(const std::vector<LimitCheck>& limits);
/// Poles and zeros by frequency and quality; H(s) is Sections::gain times their product.
report::Table sections_table(const Sections& sections);
report::Table parts_table(const std::vector<schematic::Part>& parts);
report::Table cams_table(const fpaa::Plan& plan);
/// Error of 95 % of boards against the largest input, of plans that have not all that is wanted.
report::Plot trade_off_plot(const fpaa::Plan& plan);
void add_sections_table(report::Page& page, const Sections& sections);
/// Nothing where no board was asked for; `refused`: why there is no plan.
void add_board_chapter(report::Page& page, const std::optional<fpaa::Plan>& plan,
                       const std::string& refused = {});
/// Nothing where no circuit was asked for.
void add_circuit_chapter(report::Page& page, const std::optional<synthesis::BuildChoice>& choice,
                         const std::optional<Project::Circuit>& asked,
                         const std::optional<synthesis::CompensatorCheck>& ngspice = std::nullopt);
void add_inputs_chapter(report::Page& page, const Provenance& from);

}  // namespace bodesmith::project
