#pragma once

#include "signal/formats/format.hpp"

/// One line a format; each stands in a file of its own name.
namespace bodesmith::formats {

const Format& block_csv();
const Format& bode100_csv();
const Format& citi_file();
const Format& headed_table();
const Format& instrument_csv();
const Format& ltspice_text();
const Format& matlab_file();
const Format& plain_table();
const Format& rew_text();
const Format& spice_raw();
const Format& touchstone();
const Format& wave_audio();
const Format& waveforms_csv();

}  // namespace bodesmith::formats
