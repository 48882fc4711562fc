#include "cli/rational_part.hpp"

#include <fmt/format.h>

#include "base/text.hpp"
#include "cli/command_line.hpp"
#include "lti/section_making.hpp"

namespace bodesmith::cli {

Sections rational_part(Sections sections, const std::string& file) {
  if (sections.delay_s != 0.0) {
    note(fmt::format("{}: its delay of {} is left out, poles and zeros do not make it", file,
                     engineering_text(sections.delay_s, "s")));
    sections.delay_s = 0.0;
  }
  return sections;
}

Sections read_rational_series(const std::vector<std::string>& files, Provenance& from) {
  std::vector<Sections> parts;
  for (const std::string& file : files) parts.push_back(rational_part(Sections::read(file, from), file));
  return in_series(parts);
}

}  // namespace bodesmith::cli
