#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace bodesmith {

/// Lower-case hexadecimal SHA-256 of the bytes.
std::string sha256_hex(std::string_view bytes);

/// A file that went into a result: its path as the user gave it, and the hash of what was read.
struct InputFile {
  std::string path;
  std::string sha256;
  /// Of a foreign format: which, what was chosen in it, what was converted. Empty for this program's own.
  std::string read_as;
};

/// What a result came from. Readers add to it while they read.
struct Provenance {
  std::vector<InputFile> inputs;
  /// Sampling rate of records without times, where the user gave one.
  std::optional<double> sample_hz;

  /// read_file(), remembered here.
  std::string read(const std::filesystem::path& path);
};

}  // namespace bodesmith
