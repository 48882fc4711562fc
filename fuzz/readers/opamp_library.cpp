#include "schematic/opamp_library.hpp"
#include "reader.hpp"

namespace bodesmith::fuzz {
namespace {

void read_opamp_bytes(std::string_view bytes) {
  Provenance from;
  const auto library = schematic::OpAmpLibrary::read(as_file(bytes, "opamps.toml"), from);
  for (const schematic::OpAmpModel& type : library.types()) {
    for (const double value : {type.dc_gain, type.slew_v_per_s, type.output_resistance_ohm, type.swing_v,
                               type.bias_current_a, type.offset_v, type.voltage_noise_v_per_rthz})
      require_finite(value);
  }
}
const Registered opamp_reader{"opamp_library", read_opamp_bytes};

}  // namespace
}  // namespace bodesmith::fuzz
