#include <fmt/format.h>

#include "base/text.hpp"
#include "project/run.hpp"
#include "report/page.hpp"
#include "synthesis/generator/files.hpp"

namespace bodesmith::project {

void layout_chapter(report::Page& page, const Run& run) {
  if (!run.design.layout) return;
  page.chapter("Disturbance generator");
  const generator::DisturbanceCircuit& layout = *run.design.layout;
  page.paragraph(fmt::format(
      "{} multipliers ({}) make the powers that the branches share; {} summing op-amps; a switch driven by the slope "
      "of the reference selects the branch. Largest error of d from the preferred resistor values: {} % of range.",
      layout.generator_multipliers(), layout.multiplier.name, layout.branches.size(),
      rounded_text(layout.max_error_percent, 3)));
  page.figure(generator::layout_svg(layout), "Powers, weighted sums, branch switch.");
  for (const std::string& warning : layout.warnings) page.warning(warning);
}

}  // namespace bodesmith::project
