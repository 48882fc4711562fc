#include <fmt/format.h>

#include "schematic/plain_number.hpp"
#include "synthesis/decks/dialect.hpp"

namespace bodesmith::synthesis {
namespace {

using schematic::plain_number;

/// Batch decks with a .control section: small-signal, transient, noise, and a Monte Carlo loop that alters
/// every part by an even random share (sunif) of its tolerance.
class NgspiceDialect final : public Dialect {
 public:
  std::string_view name() const override { return "ngspice"; }

  std::vector<Deck> decks(const DeckRequest& request) const override {
    return {deck_from_template("ac.cir", request), deck_from_template("transient.cir", request),
            deck_from_template("noise.cir", request),
            deck_from_template("monte_carlo_ngspice.cir", request, {{"alters", alters(request)}})};
  }

 private:
  /// ngspice names a part of a subcircuit r.xc.x1.r1_1.
  static std::vector<std::string> alters(const DeckRequest& request) {
    const schematic::Tolerances& tolerances = request.circuit.tolerances;
    std::vector<std::string> out;
    for (const schematic::Part& part : request.circuit.parts) {
      const bool resistor = part.kind == schematic::Part::Kind::resistor;
      const double percent = resistor ? tolerances.resistor_percent : tolerances.capacitor_percent;
      std::string lower_name = part.name;
      for (char& c : lower_name) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
      out.push_back(fmt::format("alter {}.xc.x{}.{} = {}*(1+{}*sunif(0))", resistor ? "r" : "c",
                                part.group + 1, lower_name, plain_number(part.realised),
                                plain_number(percent / 100.0)));
    }
    return out;
  }
};

}  // namespace

BODESMITH_ENTRY(Dialect, ngspice_dialect, NgspiceDialect)

}  // namespace bodesmith::synthesis
