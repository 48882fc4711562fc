#include "multiplier_layout/parts_csv.hpp"

#include "base/text.hpp"
#include "signal/csv.hpp"

namespace bodesmith::multiplier_layout {

std::string parts_csv(const Layout& layout) {
  CsvTable table({"part", "role", "series", "wanted_ohm", "realised_ohm", "wanted_f", "realised_f"});
  for (const Part& part : layout.parts) {
    const std::string wanted = number_text(part.wanted), realised = number_text(part.realised);
    if (part.kind == Part::Kind::diode) {
      table.add_row({part.name, part.role, part.series, "", "", "", ""});
    } else if (part.kind == Part::Kind::resistor) {
      table.add_row({part.name, part.role, part.series, wanted, realised, "", ""});
    } else {
      table.add_row({part.name, part.role, part.series, "", "", wanted, realised});
    }
  }
  return table.text();
}

}  // namespace bodesmith::multiplier_layout
