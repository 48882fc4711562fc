#pragma once

#include <matio.h>

namespace bodesmith::formats {

/// libmatio's functions. It brings HDF5, curl and some 30 libraries of theirs along, and finding them is a third of what a short
/// command takes: loaded with the first .mat file instead.
struct Matio {
  decltype(&Mat_Open) open;
  decltype(&Mat_CreateVer) create;
  decltype(&Mat_Close) close;
  decltype(&Mat_LogInitFunc) log;
  decltype(&Mat_VarReadNextInfo) read_next_info;
  decltype(&Mat_VarReadDataAll) read_data;
  decltype(&Mat_VarGetNumberOfFields) number_of_fields;
  decltype(&Mat_VarCreate) variable;
  decltype(&Mat_VarWrite) write;
  decltype(&Mat_VarFree) free;
};

/// InputError where it is not installed.
const Matio& matio();

}  // namespace bodesmith::formats
