#include "signal/formats/all_formats.hpp"

namespace bodesmith::formats {

Registry<Format>& formats() {
  static Registry<Format> all(
      "file format", {&spice_raw(), &wave_audio(), &matlab_file(), &touchstone(), &citi_file(),
                      &instrument_csv(), &block_csv(), &waveforms_csv(), &bode100_csv(), &ltspice_text(),
                      &rew_text(), &headed_table(), &plain_table()});
  return all;
}

const Format* format_of(const Source& source) {
  for (const Format* format : formats().all()) {
    if (format->recognises(source)) return format;
  }
  return nullptr;
}

}  // namespace bodesmith::formats
