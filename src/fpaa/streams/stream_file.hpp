#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "fpaa/device/config_stream.hpp"

namespace bodesmith::fpaa {

/// How a stream stood in its file.
enum class FileForm { ahf, c_array, packet, raw };
std::string_view to_string(FileForm form);

/// One configuration stream of a file.
struct FoundStream {
  std::string name;  ///< for messages: the file, and the array or packet in it
  FileForm form = FileForm::ahf;
  Bytes bytes;
  ConfigStream stream;
};

/// Every stream of a file, told apart by content: AHF text, C source (each array that begins as a stream
/// does), board packets, or the raw bytes. Throws InputError with byte offset and ONE line.
std::vector<FoundStream> find_streams(std::string_view content, const std::string& file);

}  // namespace bodesmith::fpaa
