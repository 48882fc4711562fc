#include <stdexcept>

#include "reader.hpp"
#include "schematic/ngspice/plain_netlist.hpp"
#include "schematic/ngspice/user_deck.hpp"

namespace bodesmith::fuzz {
namespace {

/// Whatever stood in it, what is handed to ngspice has no command left.
void read_user_deck_bytes(std::string_view bytes) {
  const ngspice::UserDeck deck = ngspice::read_user_deck(as_file(bytes, "deck.cir"), "");
  ngspice::require_no_commands(deck.text, "deck.cir");
  require_finite(deck.source.real() + deck.source.imag());
}
const Registered user_deck_reader{"user_deck", read_user_deck_bytes};

}  // namespace
}  // namespace bodesmith::fuzz
