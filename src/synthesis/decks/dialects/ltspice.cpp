#include <fmt/format.h>

#include "schematic/plain_number.hpp"
#include "synthesis/decks/compensator_files.hpp"
#include "synthesis/decks/dialect.hpp"

namespace bodesmith::synthesis {
namespace {

using schematic::plain_number;

/// .step and mc(): the values of compensator_mc.sub are {mc(value,tolerance)} of the parameters
/// resistor_tolerance and capacitor_tolerance.
class LtspiceDialect final : public Dialect {
 public:
  std::string_view name() const override { return "ltspice"; }

  std::vector<Deck> decks(const DeckRequest& request) const override {
    const auto value = [this](const schematic::Part& part) { return *value_with_tolerance(part); };
    return {{"compensator_mc.sub",
             schematic::spice_text(
                 compensator_library(request.circuit, request.title + ", LTspice with tolerances"),
                 {.value = value})},
            deck_from_template("ltspice_ac.cir", request),
            deck_from_template("ltspice_monte_carlo.cir", request)};
  }

  std::optional<std::string> value_with_tolerance(const schematic::Part& part) const override {
    return fmt::format(
        "{{mc({},{})}}", plain_number(part.realised),
        part.kind == schematic::Part::Kind::resistor ? "resistor_tolerance" : "capacitor_tolerance");
  }
};

}  // namespace

BODESMITH_ENTRY(Dialect, ltspice_dialect, LtspiceDialect)

}  // namespace bodesmith::synthesis
