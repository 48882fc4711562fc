#include "signal/formats/format.hpp"

namespace bodesmith::formats {

BODESMITH_REGISTRY(Format, formats, "file format", spice_raw, wave_audio, matlab_file, touchstone, citi_file,
                   qucs_dataset, hantek_text, instrument_csv, block_csv, waveforms_csv, ltspice_text,
                   headed_table, plain_table)

const Format* format_of(const Source& source) {
  for (const Format* format : formats().all()) {
    if (format->recognises(source)) return format;
  }
  return nullptr;
}

}  // namespace bodesmith::formats
