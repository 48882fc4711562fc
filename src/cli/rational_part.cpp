#include "cli/rational_part.hpp"

#include <fmt/format.h>

#include "base/text.hpp"
#include "cli/command_line.hpp"

namespace bodesmith::cli {

Sections rational_part(Sections sections, const std::string& file) {
  if (sections.delay_s != 0.0) {
    note(fmt::format("{}: its delay of {} is left out, poles and zeros do not make it", file,
                     engineering_text(sections.delay_s, "s")));
    sections.delay_s = 0.0;
  }
  return sections;
}

}  // namespace bodesmith::cli
