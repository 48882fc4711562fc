#pragma once

#include <optional>
#include <string>
#include <vector>

#include "fpaa/plan/plan.hpp"
#include "project/design/budget.hpp"
#include "project/limits.hpp"
#include "project/run.hpp"
#include "report/page.hpp"
#include "synthesis/decks/compensator_files.hpp"
#include "synthesis/realise_search.hpp"

/// What several chapters of a report, or a summary, say alike.
namespace bodesmith::project {

/// "1 kHz".
std::string hertz_text(double value);
std::string span_text(const Band& band);

report::Table budget_table(const Budget& budget);
report::Table alternatives_table(const Design& design);
report::Table tracking_table(const TrackingStudy& study);
report::Table limits_table(const std::vector<LimitCheck>& limits);
/// Poles and zeros by frequency and quality; H(s) is Sections::gain times their product.
report::Table sections_table(const Sections& sections);
report::Table parts_table(const std::vector<schematic::Part>& parts);
report::Table cams_table(const fpaa::Plan& plan);
/// Error of 95 % of boards against the largest input, of plans that have not all that is wanted.
report::Plot trade_off_plot(const fpaa::Plan& plan);
std::string sections_caption(const Sections& sections);

/// A table for a terminal: its first column, headed by `caption`, to the left, with a star at marked rows; the others to the
/// right.
std::string text_of(const std::string& caption, const report::Table& table);

}  // namespace bodesmith::project
