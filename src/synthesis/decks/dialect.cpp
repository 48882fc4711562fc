#include "synthesis/decks/dialect.hpp"

#include <fmt/format.h>

#include <cmath>

#include "base/documents/json.hpp"
#include "base/text.hpp"
#include "base/text_template.hpp"
#include "schematic/plain_number.hpp"

namespace bodesmith::synthesis {
namespace {

/// A first line that begins so is more to ngspice than a title.
std::string plain_title(const std::string& title) {
  return title.find_first_of(".*+$#") == 0 ? "deck " + title : title;
}

}  // namespace

using schematic::plain_number;

Deck deck_from_template(const std::string& file, const DeckRequest& request,
                        const std::vector<TemplateLines>& lists) {
  const double middle_hz = std::sqrt(request.band.from.value * request.band.to.value);
  const schematic::Tolerances& tolerances = request.circuit.tolerances;
  Json data = {{"title", plain_title(request.title)},
               {"from_hz", plain_number(request.band.from.value)},
               {"to_hz", plain_number(request.band.to.value)},
               {"frequency_hz", rounded_text(middle_hz)},
               {"points", triangle_points(middle_hz)},
               {"step_s", plain_number(1.0 / (middle_hz * 1000.0))},
               {"stop_s", plain_number(2.0 / middle_hz)},
               {"resistor_percent", plain_number(tolerances.resistor_percent)},
               {"capacitor_percent", plain_number(tolerances.capacitor_percent)},
               {"resistor_tolerance", plain_number(tolerances.resistor_percent / 100.0)},
               {"capacitor_tolerance", plain_number(tolerances.capacitor_percent / 100.0)}};
  for (const TemplateLines& list : lists) {
    data[list.name] = Json::array();
    for (const std::string& line : list.lines) data[list.name].push_back({{"line", line}});
  }
  return {file, render_template("spice/" + file, data)};
}

std::string triangle_points(double frequency_hz) {
  std::string out = "0 0";
  for (int half = 1; half <= 4; ++half)
    out += fmt::format(" {:.12g} {}", half / (2.0 * frequency_hz), half % 2);
  return out;
}

// One line a dialect: the function that its own file in dialects/ defines.
BODESMITH_REGISTRY(Dialect, dialect_registry, "SPICE dialect", ngspice_dialect, ltspice_dialect, xyce_dialect)

}  // namespace bodesmith::synthesis
