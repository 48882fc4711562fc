#pragma once

#include "exchange/writer.hpp"

/// One line a format; each stands in a file of its own name.
namespace bodesmith::exchange {

const Writer& c_writer();
const Writer& ltspice_writer();
const Writer& csv_writer();
const Writer& frd_writer();
const Writer& matlab_writer();
const Writer& octave_writer();
const Writer& pwl_writer();
const Writer& python_writer();
const Writer& spice_source_writer();
const Writer& touchstone_writer();

}  // namespace bodesmith::exchange
