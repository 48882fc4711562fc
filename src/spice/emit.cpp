#include "spice/emit.hpp"

#include "circuit/text.hpp"

namespace bodesmith::spice {

void add_spice_files(const circuit::Realised& realised, const std::string& title, OutputSet& out,
                     const MonteCarloOptions& monte_carlo) {
  const DeckRequest request{realised.circuit, title, realised.report.band, monte_carlo};
  out.add("compensator.sub", schematic::spice_text(compensator_library(realised.circuit, title)));
  for (const Dialect* dialect : dialect_registry().all()) {
    for (const Deck& deck : dialect->decks(request)) out.add(deck.file, deck.text);
  }
  out.add("parts.csv", circuit::parts_csv(realised.circuit));
}

}  // namespace bodesmith::spice
