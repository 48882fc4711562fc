#include "spice/dialect.hpp"

namespace bodesmith::spice {
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

const Dialect& xyce_dialect() {
  static const XyceDialect dialect;
  return dialect;
}

}  // namespace bodesmith::spice
