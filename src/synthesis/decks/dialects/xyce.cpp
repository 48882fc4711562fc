#include "synthesis/decks/dialect.hpp"

namespace bodesmith::synthesis {
namespace {

/// Small-signal with .print and .measure.
class XyceDialect final : public Dialect {
 public:
  std::string_view name() const override { return "xyce"; }
  std::vector<Deck> decks(const DeckRequest& request) const override {
    return {deck_from_template("xyce_ac.cir", request)};
  }
};

}  // namespace

BODESMITH_ENTRY(Dialect, xyce_dialect, XyceDialect)

}  // namespace bodesmith::synthesis
