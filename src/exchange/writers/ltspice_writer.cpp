#include "exchange/writer.hpp"
#include "schematic/writers/ltspice_sheet.hpp"

namespace bodesmith::exchange {
namespace {

class LtspiceWriter : public Writer {
 public:
  LtspiceWriter() : Writer("ltspice", ".asc", "a circuit.json as a sheet of LTspice") {}
  Written write(const Exportable& from, const ExportOptions&) const override {
    return {schematic::ltspice_sheet(need_circuit(from, *this), from.circuit_band, from.source),
            {"parts are joined by the names of their nets",
             "op-amps are LTspice's single-pole opamp with gain and bandwidth of the type that was chosen",
             "not opened in LTspice so far"}};
  }
};

}  // namespace

BODESMITH_ENTRY(Writer, ltspice_writer, LtspiceWriter)

}  // namespace bodesmith::exchange
