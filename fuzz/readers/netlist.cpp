#include "reader.hpp"
#include "schematic/ngspice/plain_netlist.hpp"

namespace bodesmith::fuzz {
namespace {

void read_netlist_bytes(std::string_view bytes) {
  ngspice::require_plain_text(bytes, "library.sub");
  ngspice::pick_subcircuit(ngspice::list_subcircuits(std::string(bytes), "library.sub"), "", "library.sub");
}
const Registered netlist_reader{"netlist", read_netlist_bytes};

}  // namespace
}  // namespace bodesmith::fuzz
